//! `frame.batch`. Never lives here: how one picture is drawn, and the order of many.

use super::batch::{Batch, Items};
use super::call::Call;
use super::frame::{PackedFrame, bytes_of_picture};
use super::pose::of_pose;
use super::prepared_frame::PreparedFrame;
use super::prepared_pose::PreparedPose;
use super::response::Responder;
use crate::engine::{JobContext, RigRef};
use crate::protocol::batch::{FrameBatch, FrameBatchParams, FrameChange, FrameReady};
use crate::protocol::frame as wire;
use crate::protocol::pose::Pose;
use crate::protocol::{Attachments, Fault, FieldFault, Id};
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

impl Call {
    pub(super) fn render_batch(
        &self,
        mut params: FrameBatchParams,
    ) -> Result<impl FnOnce(Responder) + use<>, Fault> {
        self.engine().limits().batch_items(params.frames.len())?;
        let frames = std::mem::take(&mut params.frames);
        let items = FrameItems {
            rigs: self.rigs(&params.rig, &frames)?,
            pose: std::mem::take(&mut params.pose),
            call: self.clone(),
            common: params,
        };
        if frames.is_empty() {
            items.laid_over(FrameChange::default())?;
        }
        let batch = Batch {
            item_bytes: items.bytes_of_largest(&frames),
            request_bytes: self.attached.len() as u64,
            streams: items.common.stream,
            given: frames,
            items,
        };
        batch.prepare(self)
    }

    /// Those of a batch as they are now, whatever is loaded or set while it is drawn; by the names that the request uses.
    fn rigs(
        &self,
        common: &str,
        frames: &[FrameChange],
    ) -> Result<BTreeMap<String, BatchRig>, Fault> {
        let mut rigs = BTreeMap::new();
        rigs.insert(common.to_owned(), self.engine().rig(common)?.into());
        for (index, frame) in frames.iter().enumerate() {
            if let Some(name) = frame.rig.as_ref().filter(|name| !rigs.contains_key(*name)) {
                let found = self.engine().rig(name);
                let found = found.map_err(|error| Fault::from(error).within(("frames", index)))?;
                rigs.insert(name.clone(), found.into());
            }
        }
        Ok(rigs)
    }
}

struct BatchRig {
    found: Arc<RigRef>,
    /// The common pose, for this rig: prepared once, by the first picture that has no other.
    common_pose: OnceLock<Result<Arc<PreparedPose>, FieldFault>>,
}

impl From<RigRef> for BatchRig {
    fn from(found: RigRef) -> Self {
        Self {
            found: Arc::new(found),
            common_pose: OnceLock::new(),
        }
    }
}

/// The pictures of a batch.
struct FrameItems {
    call: Call,
    /// Without the frames and the pose.
    common: FrameBatchParams,
    /// Of the common part.
    pose: Pose,
    rigs: BTreeMap<String, BatchRig>,
}

impl FrameItems {
    fn bytes_of_largest(&self, frames: &[FrameChange]) -> u64 {
        let pixels = |frame: &FrameChange| {
            let [width, height] = frame.size.unwrap_or(self.common.size);
            u64::from(width) * u64::from(height)
        };
        let most = frames.iter().map(pixels).max().unwrap_or(0);
        // One that is larger is refused once it is looked at.
        bytes_of_picture(most.min(self.call.engine().limits().pixels))
    }

    /// The picture that a change makes of the common part.
    fn laid_over(&self, mut change: FrameChange) -> Result<PreparedFrame, Fault> {
        let own_pose = change.pose.take();
        let params: wire::FrameParams = change.over(&self.common);
        let rig = &self.rigs[&params.rig];
        self.call
            .prepare_frame_in(&params, &rig.found, || match own_pose {
                Some(pose) => self.checked(*pose, &rig.found),
                None => {
                    let checked = || self.checked(self.pose.clone(), &rig.found);
                    rig.common_pose.get_or_init(checked).clone()
                }
            })
    }

    fn checked(&self, pose: Pose, found: &RigRef) -> Result<Arc<PreparedPose>, FieldFault> {
        let pose = self.call.prepare_pose(pose, found)?;
        pose.check(found).map_err(of_pose)?;
        Ok(Arc::new(pose))
    }

    /// A fault that the common part has by itself is its own; else it is told by the picture.
    fn located(&self, index: usize, fault: Fault) -> Fault {
        match self.laid_over(FrameChange::default()) {
            Err(of_common) if of_common == fault => fault,
            _ => fault.within(("frames", index)),
        }
    }
}

impl Items for FrameItems {
    type Given = FrameChange;
    type Prepared = PreparedFrame;
    type Done = PackedFrame;
    type Sent = wire::Frame;
    const READY: &'static str = "frame.ready";

    fn prepare(&self, index: usize, given: FrameChange) -> Result<PreparedFrame, Fault> {
        let prepared = self.laid_over(given);
        prepared.map_err(|fault| self.located(index, fault))
    }

    fn least_bytes(&self, prepared: &PreparedFrame) -> u64 {
        prepared.least_bytes()
    }

    fn start(
        &self,
        index: usize,
        prepared: PreparedFrame,
        context: JobContext,
        done: impl FnOnce(Result<PackedFrame, Fault>) + Send + 'static,
    ) {
        let PreparedFrame { rig, packing, .. } = &prepared;
        match prepared.evaluate() {
            Ok(subject) => self.call.draw(rig, subject, *packing, context, done),
            Err(fault) => done(Err(of_pose(fault).within(("frames", index)).into())),
        }
    }

    fn written_bytes(done: &PackedFrame) -> u64 {
        done.written_bytes()
    }

    fn sent(done: PackedFrame, attachments: &mut Attachments) -> wire::Frame {
        done.sent(attachments)
    }

    fn ready(request: &Id, index: u64, frame: wire::Frame) -> impl Serialize {
        FrameReady {
            request: request.clone(),
            index,
            frame,
        }
    }

    fn result(frame_count: u64, frames: Option<Vec<wire::Frame>>) -> impl Serialize {
        FrameBatch {
            frame_count,
            frames,
        }
    }
}
