//! Several clips at once. Never lives here: curves, and limits.

use super::{ClipAt, Pose};
use crate::rig::{Channel, slerp};
use glam::DQuat;
use std::collections::BTreeMap;

/// What clips come to.
pub(super) struct Blended {
    pub dofs: BTreeMap<usize, f64>,
    /// By joint, unit length.
    pub rotations: BTreeMap<usize, DQuat>,
}

/// The weighted mean of what came so far.
struct Mean<V> {
    value: V,
    weight: f64,
}

impl Blended {
    /// # Formula
    /// For each DOF, and for each joint whose rotation is set whole, over those clips that set it, in their order:
    /// `mean ← mix(mean, value, weight / Σ weights so far)`; where the sum stays below 1, `mix(pose's own, mean, sum)` at the end.
    /// `mix` is linear, of rotations a slerp by the shorter way.
    pub(super) fn of(pose: &Pose, clips: &[ClipAt]) -> Self {
        let mut dofs: BTreeMap<usize, Mean<f64>> = BTreeMap::new();
        let mut rotations: BTreeMap<usize, Mean<DQuat>> = BTreeMap::new();
        for &ClipAt { clip, time, weight } in clips.iter().filter(|clip| clip.weight > 0.0) {
            for channel in &pose.rig().clips()[clip].channels {
                match channel {
                    Channel::Dof { dof, curve } => {
                        let value = curve.at(time);
                        let mean = dofs.entry(*dof).or_insert(Mean { value, weight: 0.0 });
                        mean.add(value, weight, linear);
                    }
                    Channel::Rotation { joint, curve } => {
                        let value = unit(curve.at(time));
                        let mean = rotations.entry(*joint);
                        let mean = mean.or_insert(Mean { value, weight: 0.0 });
                        mean.add(value, weight, slerp);
                    }
                }
            }
        }
        let own = pose.rig().dofs().all();
        let dofs = dofs.into_iter();
        let rotations = rotations.into_iter();
        Self {
            dofs: dofs
                .map(|(dof, mean)| (dof, mean.over(|| pose.value(&own[dof]), linear)))
                .collect(),
            rotations: rotations
                .map(|(joint, mean)| (joint, mean.over(|| pose.local(joint).rotation, slerp)))
                .collect(),
        }
    }
}

impl<V: Copy> Mean<V> {
    fn add(&mut self, value: V, weight: f64, mix: impl FnOnce(V, V, f64) -> V) {
        self.weight += weight;
        if self.weight > weight {
            self.value = mix(self.value, value, weight / self.weight);
        }
    }

    /// With the pose that is edited making up the rest.
    fn over(self, own: impl FnOnce() -> V, mix: impl FnOnce(V, V, f64) -> V) -> V {
        if self.weight >= 1.0 {
            self.value
        } else {
            mix(own(), self.value, self.weight)
        }
    }
}

fn linear(from: f64, to: f64, share: f64) -> f64 {
    from + (to - from) * share
}

/// Of a quaternion that a cubic span left at any length.
fn unit(quaternion: DQuat) -> DQuat {
    let length = quaternion.length();
    if length > 0.0 && length.is_finite() {
        quaternion * (1.0 / length)
    } else {
        DQuat::IDENTITY
    }
}
