//! The pose that a request brings: its names looked up once, worked out when its turn comes. Never lives here: what is done in it.

use super::describe;
use super::dof_row::DofRow;
use super::names::{unknown, unknown_dof, unknown_joint};
use crate::engine::{Base, ChangedPose, PoseError, RigRef};
use crate::pose::{ClipAt, LimitPolicy, PoseEdit, Posed};
use crate::protocol::pose as wire;
use crate::protocol::{FieldFault, FieldPath};
use crate::rig::{LARGEST_COORDINATE, Rig};
use bytes::Bytes;
use glam::DQuat;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A pose, worked out.
pub(super) struct EvaluatedPose {
    pub posed: Arc<Posed>,
    /// What limits changed in it.
    pub clamped: Vec<wire::Clamped>,
}

/// A pose of one rig. Faults are as seen from the pose.
#[derive(Debug, Clone)]
pub(super) struct PreparedPose {
    base: Base,
    edit: Arc<PoseEdit>,
    /// In place of the edit's own: one for each DOF.
    row: Option<DofRow>,
    /// The field that clips come from.
    clips_from: &'static str,
}

impl PreparedPose {
    /// `attached` are the raw bytes of the request.
    pub(super) fn new(
        pose: wire::Pose,
        attached: &Bytes,
        found: &RigRef,
    ) -> Result<Self, FieldFault> {
        let rig = &found.loaded.rig;
        let base = match pose.base {
            Some(wire::PoseBase::Stored) => Base::Stored,
            Some(wire::PoseBase::Rest) => Base::Rest,
            // What a digest names is the same everywhere, so a server's own pose has no part in it.
            None if found.by_digest => Base::Rest,
            None => Base::Stored,
        };
        let row = match pose.dof_values {
            None => None,
            Some(values) if pose.dofs.is_empty() => {
                let row = DofRow::new(values, attached);
                let row = row.and_then(|row| checked(row, rig));
                Some(row.map_err(|fault| fault.within("dof_values"))?)
            }
            Some(_) => {
                let problem = "expected either `dofs` or `dof_values`, but found both";
                return Err(FieldFault::new("dof_values", problem));
            }
        };
        let dofs = named_dofs(&pose.dofs, rig)?;
        let (clips, clips_from) = clips(pose.clip, &pose.clips, rig)?;
        let edit = PoseEdit {
            clips,
            rotations: rotations(&pose.rotations, rig)?,
            dofs,
            limits: limit_policy(pose.limits),
        };
        Ok(Self {
            base,
            edit: Arc::new(edit),
            row,
            clips_from,
        })
    }

    /// The same pose with every DOF set besides. A fault is as seen from the row.
    pub(super) fn with_row(&self, row: DofRow, rig: &Rig) -> Result<Self, FieldFault> {
        Ok(Self {
            row: Some(checked(row, rig)?),
            ..self.clone()
        })
    }

    /// Whether limits allow it: all that can be told without working it out.
    pub(super) fn check(&self, found: &RigRef) -> Result<(), FieldFault> {
        if self.edit.limits != LimitPolicy::Reject {
            return Ok(());
        }
        let edited = found.start(self.base).edited(&self.edit());
        let edited = edited.map_err(|error| self.located(error.into(), found));
        edited.map(drop)
    }

    /// Works it out.
    pub(super) fn evaluate(&self, found: &RigRef) -> Result<EvaluatedPose, FieldFault> {
        let posed = found.posed(self.base, &self.edit());
        let (posed, clamped) = posed.map_err(|error| self.located(error, found))?;
        Ok(EvaluatedPose {
            clamped: describe::clamped(posed.rig(), &clamped),
            posed,
        })
    }

    /// What it makes of the stored pose.
    pub(super) fn change(&self, current: &RigRef) -> Result<ChangedPose, FieldFault> {
        let changed = current.changed(self.base, &self.edit());
        changed.map_err(|error| self.located(error, current))
    }

    fn edit(&self) -> Cow<'_, PoseEdit> {
        match &self.row {
            None => Cow::Borrowed(&self.edit),
            Some(row) => Cow::Owned(PoseEdit {
                dofs: row.values().enumerate().collect(),
                ..PoseEdit::clone(&self.edit)
            }),
        }
    }

    /// A value past its limits is at fault where the pose gives it.
    fn located(&self, error: PoseError, found: &RigRef) -> FieldFault {
        let outside = match error {
            PoseError::OutsideLimits(outside) => outside,
            PoseError::OutOfRange(out) => {
                return FieldFault::new(FieldPath::default(), out.to_string());
            }
        };
        let dof = found.loaded.rig.dofs().named(&outside.dof);
        let is_given = |dof| self.edit.dofs.iter().any(|&(given, _)| given == dof);
        let path = if dof.is_some_and(is_given) {
            FieldPath::from("dofs").field(outside.dof.clone())
        } else if self.row.is_some() {
            "dof_values".into()
        } else if self.edit.rotations.is_empty() {
            self.clips_from.into()
        } else {
            "rotations".into()
        };
        FieldFault::new(path, outside.to_string())
    }
}

/// One finite value for each DOF.
fn checked(row: DofRow, rig: &Rig) -> Result<DofRow, FieldFault> {
    let (wanted, found) = (rig.dofs().all().len(), row.len());
    if wanted != found {
        let problem = format!("expected {wanted} values, one for each DOF, but found {found}");
        return Err(FieldFault::new(FieldPath::default(), problem));
    }
    if let Some(index) = row.values().position(|value| !value.is_finite()) {
        let path = FieldPath::default().index(index);
        return Err(FieldFault::new(path, "expected a finite number"));
    }
    Ok(row)
}

pub(super) fn limit_policy(limits: wire::LimitPolicy) -> LimitPolicy {
    match limits {
        wire::LimitPolicy::Clamp => LimitPolicy::Clamp,
        wire::LimitPolicy::Reject => LimitPolicy::Reject,
        wire::LimitPolicy::Ignore => LimitPolicy::Ignore,
    }
}

/// And the field that they come from.
fn clips(
    only: Option<wire::ClipAt>,
    several: &[wire::WeightedClip],
    rig: &Rig,
) -> Result<(Vec<ClipAt>, &'static str), FieldFault> {
    if let Some(wire::ClipAt { name, time }) = only {
        if !several.is_empty() {
            let problem = "expected either `clip` or `clips`, but found both";
            return Err(FieldFault::new("clips", problem));
        }
        let only = clip_at(&name, time, 1.0, rig).map_err(|fault| fault.within("clip"))?;
        return Ok((vec![only], "clip"));
    }
    let clip = |(index, clip): (usize, &wire::WeightedClip)| {
        clip_at(&clip.name, clip.time, clip.weight, rig)
            .map_err(|fault| fault.within(("clips", index)))
    };
    let clips: Result<_, _> = several.iter().enumerate().map(clip).collect();
    Ok((clips?, "clips"))
}

/// A fault is as seen from the clip.
fn clip_at(name: &str, time: f64, weight: f64, rig: &Rig) -> Result<ClipAt, FieldFault> {
    // As far as the keys of a clip can be.
    if time.abs() > LARGEST_COORDINATE {
        let problem = format!("expected a time within ±{LARGEST_COORDINATE:e}, but found {time:e}");
        return Err(FieldFault::new("time", problem));
    }
    if !(0.0..=LARGEST_COORDINATE).contains(&weight) {
        let problem =
            format!("expected a number from 0 to {LARGEST_COORDINATE:e}, but found {weight:e}");
        return Err(FieldFault::new("weight", problem));
    }
    match rig.clips().iter().position(|clip| clip.name == name) {
        Some(clip) => Ok(ClipAt { clip, time, weight }),
        None => {
            let known = rig.clips().iter().map(|clip| clip.name.as_str());
            Err(FieldFault::new("name", unknown("clip", name, known)))
        }
    }
}

fn named_dofs(dofs: &BTreeMap<String, f64>, rig: &Rig) -> Result<Vec<(usize, f64)>, FieldFault> {
    let index = |(name, &value): (&String, &f64)| match rig.dofs().named(name) {
        Some(dof) => Ok((dof, value)),
        None => Err(FieldFault::new(
            FieldPath::from("dofs").field(name.clone()),
            unknown_dof(name, rig),
        )),
    };
    dofs.iter().map(index).collect()
}

fn rotations(
    rotations: &BTreeMap<String, [f64; 4]>,
    rig: &Rig,
) -> Result<Vec<(usize, DQuat)>, FieldFault> {
    let index = |(name, &rotation): (&String, &[f64; 4])| {
        let path = || FieldPath::from("rotations").field(name.clone());
        let joint = joint_named(name, rig).map_err(|problem| FieldFault::new(path(), problem))?;
        let length = DQuat::from_array(rotation).length();
        // Off by more than float32 or a few printed decimals leave, it was not meant as a rotation.
        if (length - 1.0).abs() > 1e-2 {
            let problem = format!(
                "expected a unit quaternion [x, y, z, w], but found one of length {length}"
            );
            return Err(FieldFault::new(path(), problem));
        }
        Ok((joint, DQuat::from_array(rotation).normalize()))
    };
    rotations.iter().map(index).collect()
}

/// The joint's index, or what is wrong with its name.
pub(super) fn joint_named(name: &str, rig: &Rig) -> Result<usize, String> {
    let found = rig.skeleton().joint_named(name);
    found.ok_or_else(|| unknown_joint(name, rig))
}
