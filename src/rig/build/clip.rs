//! Animations: curves checked, and brought to the DOFs that they set.

use super::{finite, is_usable};
use crate::limits::Limits;
use crate::rig::{
    Axis, Channel, ChannelDraft, ChannelTarget, Clip, ClipDraft, Curve, DofKind, Dofs, Key,
    RigError, RigProblem, Warnings, names,
};
use glam::DQuat;

pub(super) fn build(
    drafts: Vec<ClipDraft>,
    dofs: &Dofs,
    limits: &Limits,
    warnings: &mut Warnings,
) -> Result<Vec<Clip>, RigError> {
    limits.clips(drafts.len())?;
    let channels = drafts.iter().flat_map(|clip| &clip.channels);
    limits.keys(channels.map(ChannelDraft::key_count).sum::<usize>())?;
    let unique_names = names::unique("clip", drafts.iter().map(|clip| clip.name.as_str()));
    let mut clips = Vec::with_capacity(drafts.len());
    for (index, (draft, name)) in drafts.into_iter().zip(unique_names).enumerate() {
        let file = draft.file.clone();
        let built = build_clip(index, draft, name, dofs, warnings);
        clips.push(built.map_err(|problem| problem.of(file.as_ref()))?);
    }
    Ok(clips)
}

fn build_clip(
    index: usize,
    draft: ClipDraft,
    name: String,
    dofs: &Dofs,
    warnings: &mut Warnings,
) -> Result<Clip, RigProblem> {
    finite(is_usable(&draft.range), || {
        format!("the range of clip `{name}`")
    })?;
    let no_such_dof = RigProblem::NoSuchDof { clip: index };
    let mut channels = Vec::with_capacity(draft.channels.len());
    for channel in draft.channels {
        channels.push(match channel {
            ChannelDraft::Dof { target, curve } => {
                check(index, &name, &curve)?;
                let dof = match target {
                    ChannelTarget::Dof(kind) => dofs.of_kind(kind).ok_or(no_such_dof.clone())?,
                    ChannelTarget::Named(dof_name) => match dofs.named(&dof_name) {
                        Some(dof) => dof,
                        None => {
                            warnings.push(|| {
                                format!(
                                    "clip `{name}` moves `{dof_name}`, which the rig does not have; the channel is left out"
                                )
                            });
                            continue;
                        }
                    },
                };
                Channel::Dof { dof, curve }
            }
            ChannelDraft::Rotation { joint, curve } => {
                check(index, &name, &curve)?;
                // Every joint turns.
                let axis = Axis::X;
                let rotation = dofs.of_kind(DofKind::Rotation { joint, axis });
                rotation.ok_or(no_such_dof.clone())?;
                Channel::Rotation { joint, curve }
            }
        });
    }
    Ok(Clip {
        name,
        range: draft.range,
        channels,
    })
}

fn check<V: KeyValue>(clip: usize, name: &str, curve: &Curve<V>) -> Result<(), RigProblem> {
    let is_finite = |key: &Key<V>| {
        let numbers = [key.value, key.slope_in, key.slope_out];
        is_usable(&[key.time]) && numbers.iter().all(|number| number.is_usable())
    };
    finite(curve.keys.iter().all(is_finite), || {
        format!("a key of clip `{name}`")
    })?;
    if curve
        .keys
        .windows(2)
        .any(|pair| pair[0].time >= pair[1].time)
    {
        return Err(RigProblem::KeysOutOfOrder { clip });
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

#[cfg(test)]
mod tests {
    use crate::limits::Limits;
    use crate::rig::{
        Channel, ChannelDraft, ChannelTarget, ClipDraft, Curve, Draft, Extrapolation,
        Interpolation, JointDraft, Key, RigProblem,
    };

    fn channel(dof: &str, times: &[f64]) -> ChannelDraft {
        let key = |&time: &f64| Key {
            time,
            value: 1.0,
            slope_in: 0.0,
            slope_out: 0.0,
        };
        ChannelDraft::Dof {
            target: ChannelTarget::Named(dof.to_owned()),
            curve: Curve {
                keys: times.iter().map(key).collect(),
                interpolation: Interpolation::Linear,
                before: Extrapolation::Constant,
                after: Extrapolation::Constant,
            },
        }
    }

    fn draft(channels: Vec<ChannelDraft>) -> Draft {
        let joint = |name: &str, parent| JointDraft {
            name: name.to_owned(),
            parent,
            ..JointDraft::default()
        };
        Draft {
            file: Some("a.skel".into()),
            joints: vec![joint("hip", None), joint("knee", Some(0))],
            clips: vec![ClipDraft {
                file: Some("walk.anim".into()),
                name: "walk".to_owned(),
                channels,
                ..ClipDraft::default()
            }],
            ..Draft::default()
        }
    }

    #[test]
    fn channels_find_dofs_by_name() {
        let channels = vec![
            channel("knee.ry", &[0.0]),
            channel("elbow.rx", &[0.0]),
            channel("hip.rz", &[0.0]),
        ];
        let rig = draft(channels).build(&Limits::default());
        let rig = rig.expect("what is missing is left out");
        let name_of = |channel: &Channel| match channel {
            Channel::Dof { dof, .. } => rig.dofs().all()[*dof].name.clone(),
            Channel::Rotation { .. } => panic!("every channel sets a DOF"),
        };
        let moved: Vec<_> = rig.clips()[0].channels.iter().map(name_of).collect();
        assert_eq!(moved, ["knee.ry", "hip.rz"]);
        let wanted =
            "clip `walk` moves `elbow.rx`, which the rig does not have; the channel is left out";
        assert_eq!(rig.warnings(), [wanted]);
    }

    #[test]
    fn an_error_names_the_file_of_the_clip() {
        let error = draft(vec![channel("hip.rx", &[1.0, 0.0])]).build(&Limits::default());
        let error = error.map(drop).expect_err("its keys are out of order");
        assert_eq!(error.file.as_deref(), Some("walk.anim"));
        assert_eq!(error.problem, RigProblem::KeysOutOfOrder { clip: 0 });
    }

    #[test]
    fn an_error_of_a_part_without_a_file_names_that_of_the_draft() {
        let mut draft = draft(Vec::new());
        draft.joints[0].parent = Some(1);
        let error = draft.build(&Limits::default()).map(drop);
        let error = error.expect_err("a parent comes after its child");
        assert_eq!(error.file.as_deref(), Some("a.skel"));
    }
}
