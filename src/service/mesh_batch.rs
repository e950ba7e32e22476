//! `mesh.batch`.

use super::answer::Answer;
use super::batch::{Course, Items};
use super::mesh::{Done, Wanted, of_state, queries};
use super::pose::of_pose;
use super::scene::of_skinning;
use super::{Call, describe};
use crate::engine::{RigRef, Terms};
use crate::protocol::batch::{BatchAttribute, MeshBatch, MeshBatchParams, MeshItem, MeshReady};
use crate::protocol::pose::{DofValues, Pose};
use crate::protocol::{Attachments, Fault, FieldFault, FieldPath, Id, Segment};
use crate::rig::Rig;
use serde::Serialize;
use std::sync::Arc;

impl Call {
    pub(super) fn vertices_batch(
        &self,
        mut params: MeshBatchParams,
        answer: &mut Option<Answer>,
    ) -> Result<(), Fault> {
        let found = self.engine().rig(&params.rig)?;
        let rig = Arc::clone(&found.loaded.rig);
        let poses = self.poses(&mut params, &rig)?;
        let wants = |attribute| params.attributes.contains(&attribute);
        let (positions, normals) = (
            wants(BatchAttribute::Positions),
            wants(BatchAttribute::Normals),
        );
        let of_skin = queries(params.mesh.as_deref(), params.range, normals, &rig)?;
        let wanted = Wanted {
            queries: if positions || normals {
                of_skin
            } else {
                Vec::new()
            },
            positions,
            joints: wants(BatchAttribute::Joints),
            skinning: of_skinning(params.skinning),
            shape: of_state(params.state),
            transport: params.transport,
        };
        let course = Course {
            streams: params.stream,
            item_bytes: wanted.bytes(&rig),
            least_bytes: poses.count() as u64 * wanted.written_bytes(&rig),
            request_bytes: poses.bytes() + self.attached.len() as u64,
        };
        let items = MeshItems {
            call: self.clone(),
            found,
            poses,
            wanted: Arc::new(wanted),
        };
        for index in 0..items.count() {
            self.urgency.check()?;
            let checked = self.check_pose(&items.poses.at(index), &items.found);
            checked.map_err(|fault| items.poses.located(index, fault))?;
        }
        self.run_batch(items, &course, answer)
    }

    /// Those of the items of a batch.
    fn poses(&self, params: &mut MeshBatchParams, rig: &Rig) -> Result<Poses, Fault> {
        let limits = self.engine().limits();
        let dof_count = rig.dofs().all().len();
        match (params.poses.take(), params.dof_values.take()) {
            (Some(_), None) if params.pose.is_some() => {
                let problem = "expected no `pose` beside `poses`: each of them is a whole pose";
                Err(Fault::invalid_params("pose", problem))
            }
            (Some(poses), None) => {
                limits.batch_items(poses.len())?;
                Ok(Poses::Each(poses))
            }
            (None, Some(values)) => {
                let values = match values {
                    DofValues::List(values) => values,
                    DofValues::Attached { .. } => self
                        .numbers(&values)
                        .map_err(|fault| fault.within("dof_values"))?,
                };
                if dof_count == 0 || values.len() % dof_count != 0 {
                    let found = values.len();
                    let problem = format!(
                        "expected rows of {dof_count} values, one for each DOF, but found {found} values"
                    );
                    return Err(Fault::invalid_params("dof_values", problem));
                }
                limits.batch_items(values.len() / dof_count)?;
                Ok(Poses::Rows {
                    common: params.pose.take().unwrap_or_default(),
                    values,
                    dof_count,
                })
            }
            (None, None) | (Some(_), Some(_)) => {
                let problem = "expected either `poses` or `dof_values`";
                Err(Fault::invalid_params("poses", problem))
            }
        }
    }
}

/// The poses of a batch.
enum Poses {
    Each(Vec<Pose>),
    /// Rows of values laid over one pose.
    Rows {
        common: Pose,
        values: Vec<f64>,
        dof_count: usize,
    },
}

impl Poses {
    fn count(&self) -> usize {
        match self {
            Self::Each(poses) => poses.len(),
            Self::Rows {
                values, dof_count, ..
            } => values.len() / dof_count,
        }
    }

    fn at(&self, index: usize) -> Pose {
        match self {
            Self::Each(poses) => poses[index].clone(),
            Self::Rows {
                common,
                values,
                dof_count,
            } => Pose {
                dof_values: Some(DofValues::List(
                    values[index * dof_count..][..*dof_count].to_vec(),
                )),
                ..common.clone()
            },
        }
    }

    fn bytes(&self) -> u64 {
        let bytes = match self {
            Self::Each(poses) => size_of_val(poses.as_slice()),
            Self::Rows { values, .. } => size_of_val(values.as_slice()),
        };
        bytes as u64
    }

    /// The fault of a pose, as seen from the request.
    fn located(&self, index: usize, fault: FieldFault) -> FieldFault {
        let is_of_values = |path: &FieldPath| match path.segments() {
            [] => true,
            [first, ..] => *first == Segment::Name("dof_values".into()),
        };
        match self {
            Self::Each(_) => fault.within(("poses", index)),
            Self::Rows { .. } if is_of_values(&fault.path) => {
                FieldFault::new("dof_values", format!("row {index}: {}", fault.message))
            }
            Self::Rows { .. } => of_pose(fault),
        }
    }
}

/// The poses of a batch, to be worked out.
struct MeshItems {
    call: Call,
    found: RigRef,
    poses: Poses,
    wanted: Arc<Wanted>,
}

impl Items for MeshItems {
    type Done = Done;
    type Sent = MeshItem;
    const READY: &'static str = "mesh.ready";

    fn count(&self) -> usize {
        self.poses.count()
    }

    fn begin(
        &self,
        index: usize,
        terms: Terms,
        done: impl FnOnce(Result<Done, Fault>) + Send + 'static,
    ) {
        match self.call.posed(&self.poses.at(index), &self.found) {
            Ok((posed, clamped)) => {
                let clamped = describe::clamped(posed.rig(), &clamped);
                self.call.skin(&self.wanted, posed, clamped, terms, done);
            }
            Err(fault) => done(Err(self.poses.located(index, fault).into())),
        }
    }

    fn bytes(done: &Done) -> u64 {
        done.wanted.written_bytes(&done.rig)
    }

    fn sent(done: Done, attachments: &mut Attachments) -> MeshItem {
        done.sent(attachments)
    }

    fn ready(request: &Id, index: usize, item: MeshItem) -> impl Serialize {
        MeshReady {
            request: request.clone(),
            index: index as u64,
            item,
        }
    }

    fn result(&self, items: Option<Vec<MeshItem>>) -> impl Serialize {
        MeshBatch {
            item_count: self.count() as u64,
            items,
        }
    }
}
