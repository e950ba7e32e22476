//! Animations: curves checked, and brought to the DOFs that they set.

use super::{finite, is_usable};
use crate::limits::Limits;
use crate::rig::{
    Axis, Channel, ChannelDraft, Clip, ClipDraft, Curve, DofKind, Dofs, Key, RigError, names,
};
use glam::DQuat;

pub(super) fn build(
    drafts: Vec<ClipDraft>,
    dofs: &Dofs,
    limits: &Limits,
) -> Result<Vec<Clip>, RigError> {
    limits.clips(drafts.len())?;
    let channels = drafts.iter().flat_map(|clip| &clip.channels);
    limits.keys(channels.map(ChannelDraft::key_count).sum::<usize>())?;
    let unique_names = names::unique("clip", drafts.iter().map(|clip| clip.name.as_str()));
    let build = |(index, (draft, name)): (usize, (ClipDraft, String))| {
        finite(is_usable(&draft.range), None, || {
            format!("the range of clip `{name}`")
        })?;
        let channel = |draft: ChannelDraft| match draft {
            ChannelDraft::Dof { target, curve } => {
                check(index, &name, &curve)?;
                let dof = dofs
                    .of_kind(target)
                    .ok_or(RigError::NoSuchDof { clip: index })?;
                Ok(Channel::Dof { dof, curve })
            }
            ChannelDraft::Rotation { joint, curve } => {
                check(index, &name, &curve)?;
                // Every joint turns.
                let axis = Axis::X;
                match dofs.of_kind(DofKind::Rotation { joint, axis }) {
                    Some(_) => Ok(Channel::Rotation { joint, curve }),
                    None => Err(RigError::NoSuchDof { clip: index }),
                }
            }
        };
        let channels = draft
            .channels
            .into_iter()
            .map(channel)
            .collect::<Result<_, RigError>>()?;
        Ok(Clip {
            name,
            range: draft.range,
            channels,
        })
    };
    drafts
        .into_iter()
        .zip(unique_names)
        .enumerate()
        .map(build)
        .collect()
}

fn check<V: KeyValue>(clip: usize, name: &str, curve: &Curve<V>) -> Result<(), RigError> {
    let is_finite = |key: &Key<V>| {
        let numbers = [key.value, key.slope_in, key.slope_out];
        is_usable(&[key.time]) && numbers.iter().all(|number| number.is_usable())
    };
    finite(curve.keys.iter().all(is_finite), None, || {
        format!("a key of clip `{name}`")
    })?;
    if curve
        .keys
        .windows(2)
        .any(|pair| pair[0].time >= pair[1].time)
    {
        return Err(RigError::KeysOutOfOrder { clip });
    }
    Ok(())
}

trait KeyValue: Copy {
    fn is_usable(self) -> bool;
}

impl KeyValue for f64 {
    fn is_usable(self) -> bool {
        is_usable(&[self])
    }
}

impl KeyValue for DQuat {
    fn is_usable(self) -> bool {
        is_usable(&self.to_array())
    }
}
