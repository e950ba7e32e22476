//! Animations: curves checked, and brought to the DOFs that they set.

use super::{finite, is_usable};
use crate::limits::Limits;
use crate::rig::{Channel, ChannelDraft, Clip, ClipDraft, Curve, Dofs, RigError, names};

pub(super) fn build(
    drafts: Vec<ClipDraft>,
    dofs: &Dofs,
    limits: &Limits,
) -> Result<Vec<Clip>, RigError> {
    limits.clips(drafts.len())?;
    let channels = drafts.iter().flat_map(|clip| &clip.channels);
    limits.keys(
        channels
            .map(|channel| channel.curve.keys.len())
            .sum::<usize>(),
    )?;
    let unique_names = names::unique("clip", drafts.iter().map(|clip| clip.name.as_str()));
    let build = |(index, (draft, name)): (usize, (ClipDraft, String))| {
        finite(is_usable(&draft.range), None, || {
            format!("the range of clip `{name}`")
        })?;
        let channel = |ChannelDraft { target, curve }: ChannelDraft| {
            check(index, &name, &curve)?;
            let dof = dofs
                .of_kind(target)
                .ok_or(RigError::NoSuchDof { clip: index })?;
            Ok(Channel { dof, curve })
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

fn check(clip: usize, name: &str, curve: &Curve) -> Result<(), RigError> {
    let numbers = |key: &crate::rig::Key| [key.time, key.value, key.slope_in, key.slope_out];
    finite(
        curve.keys.iter().all(|key| is_usable(&numbers(key))),
        None,
        || format!("a key of clip `{name}`"),
    )?;
    if curve
        .keys
        .windows(2)
        .any(|pair| pair[0].time >= pair[1].time)
    {
        return Err(RigError::KeysOutOfOrder { clip });
    }
    Ok(())
}
