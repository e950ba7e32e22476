//! Animations as clips. Never lives here: what a pose makes of them.

use super::accessors::{Accessors, Requirement};
use super::fault::Faults;
use super::joints::is_unit;
use super::nodes::Nodes;
use super::normalize::NO_NODE;
use crate::formats::error::LoadError;
use crate::limits::Limits;
use crate::rig::{
    Axis, ChannelDraft, ChannelTarget, ClipDraft, Curve, DofKind, Extrapolation, Interpolation,
    JointDraft, Key, Warnings,
};
use glam::DQuat;
use gltf_json::Animation;
use gltf_json::accessor::ComponentType::{F32, I8, I16, U8, U16};
use gltf_json::accessor::Type;
use gltf_json::animation::{Channel, Interpolation as InFile, Property};
use gltf_json::validation::Checked;
use std::collections::HashMap;

const TIMES: Requirement = Requirement {
    types: &[Type::Scalar],
    components: &[F32],
    expected: "SCALAR of F32",
    normalizes: false,
};
const VECTORS: Requirement = Requirement {
    types: &[Type::Vec3],
    components: &[F32],
    expected: "VEC3 of F32",
    normalizes: false,
};
const ROTATIONS: Requirement = Requirement {
    types: &[Type::Vec4],
    components: &[F32, I8, U8, I16, U16],
    expected: "VEC4 of F32, or of normalized integers",
    normalizes: true,
};
const WEIGHTS: Requirement = Requirement {
    types: &[Type::Scalar],
    components: &[F32, I8, U8, I16, U16],
    expected: "SCALAR of F32, or of normalized integers",
    normalizes: true,
};

/// What animations are read with.
pub(super) struct AnimationReader<'a> {
    pub accessors: Accessors<'a>,
    pub nodes: &'a Nodes,
    pub limits: &'a Limits,
    /// By node, which morph targets its mesh has in the draft: the first, and how many.
    pub morphs_of: &'a [Option<(usize, usize)>],
    /// Of all animations so far.
    pub keys: usize,
}

/// The numbers of a channel: at each time as many as it sets, or three times that with slopes.
struct Sampled {
    /// The first time and the last one.
    range: [f64; 2],
    /// How many keys are at the time of the one before.
    jumps: usize,
    /// Each after the one before.
    times: Vec<f64>,
    values: Vec<f32>,
    width: usize,
    interpolation: Interpolation,
}

impl AnimationReader<'_> {
    pub(super) fn read(
        &mut self,
        index: usize,
        animation: &Animation,
        warnings: &mut Warnings,
    ) -> Result<ClipDraft, LoadError> {
        let faults = self.accessors.faults;
        let mut clip = ClipDraft::default();
        let mut range: Option<[f64; 2]> = None;
        // By node and what of it is moved, the channel that moves it.
        let mut taken: HashMap<(usize, u8), usize> = HashMap::new();
        for (place, channel) in animation.channels.iter().enumerate() {
            let node = channel.target.node;
            if node.value() == NO_NODE as usize {
                continue;
            }
            let path = format!("animations[{index}].channels[{place}]");
            let nodes = &self.accessors.root.nodes;
            faults.get(nodes, "nodes", node, &format!("{path}.target.node"))?;
            let Checked::Valid(property) = channel.target.path else {
                continue;
            };
            if let Some(&other) = taken.get(&(node.value(), property as u8)) {
                let same = format!("{path} has the target of channels[{other}] and is left out");
                warnings.push(|| faults.warning(&same));
                continue;
            }
            taken.insert((node.value(), property as u8), place);
            if !self.has_target(node.value(), property, &path, warnings) {
                continue;
            }
            let (sampled, targets) = self.sampled(index, animation, channel, property, &path)?;
            let [first, last] = sampled.range;
            let [start, end] = range.unwrap_or([first, last]);
            range = Some([start.min(first), end.max(last)]);
            sampled.warn(faults, &path, warnings);
            // A channel of a node that is no joint moves nothing.
            if let Some(joint) = self.nodes.joint_of[node.value()] {
                self.keys += sampled.times.len() * targets.len().max(1);
                self.limits.keys(self.keys)?;
                let channels = &mut clip.channels;
                if property == Property::Rotation {
                    let (curve, not_unit) = sampled.rotations();
                    if not_unit > 0 {
                        let sentence =
                            format!("{path} has {not_unit} rotations that are no unit quaternions");
                        warnings.push(|| faults.warning(&sentence));
                    }
                    channels.push(ChannelDraft::Rotation { joint, curve });
                } else {
                    channels.extend(sampled.channels(&targets, &self.nodes.joints[joint]));
                }
            }
        }
        let path = format!("animations[{index}]");
        clip.name = faults.name(animation.name.as_deref(), &path, warnings);
        clip.range = range.unwrap_or_default();
        Ok(clip)
    }

    /// Whether a node has what a channel moves.
    fn has_target(
        &self,
        node: usize,
        property: Property,
        path: &str,
        warnings: &mut Warnings,
    ) -> bool {
        let faults = self.accessors.faults;
        if property != Property::MorphTargetWeights {
            if self.accessors.root.nodes[node].matrix.is_some() {
                let matrix = format!(
                    "{path} moves nodes[{node}], which has a matrix; the matrix is taken apart"
                );
                warnings.push(|| faults.warning(&matrix));
            }
            return true;
        }
        let has_morphs = self.morphs_of[node].is_some_and(|(_, count)| count > 0);
        if !has_morphs && self.nodes.is_in_scene[node] {
            let nothing = format!(
                "{path} moves morph targets of nodes[{node}], which draws none, and is left out"
            );
            warnings.push(|| faults.warning(&nothing));
        }
        has_morphs
    }

    /// The keys of a channel, and the DOFs that its components set.
    fn sampled(
        &self,
        index: usize,
        animation: &Animation,
        channel: &Channel,
        property: Property,
        path: &str,
    ) -> Result<(Sampled, Vec<DofKind>), LoadError> {
        let faults = self.accessors.faults;
        let node = channel.target.node.value();
        let joint = self.nodes.joint_of[node].unwrap_or_default();
        let (requirement, targets): (_, Vec<DofKind>) = match property {
            Property::Translation => {
                let target = |axis| DofKind::Translation { joint, axis };
                (VECTORS, Axis::ALL.map(target).to_vec())
            }
            Property::Scale => {
                let target = |axis| DofKind::Scale { joint, axis };
                (VECTORS, Axis::ALL.map(target).to_vec())
            }
            Property::Rotation => (ROTATIONS, Vec::new()),
            Property::MorphTargetWeights => {
                let (first, count) = self.morphs_of[node].unwrap_or_default();
                let target = |morph| DofKind::Morph { morph };
                (WEIGHTS, (first..first + count).map(target).collect())
            }
        };
        let sampler_path = format!("animations[{index}].samplers[{}]", channel.sampler.value());
        let samplers = &animation.samplers;
        let sampler = faults.get(
            samplers,
            "samplers",
            channel.sampler,
            &format!("{path}.sampler"),
        )?;
        let interpolation = match sampler.interpolation {
            Checked::Valid(InFile::Step) => Interpolation::Step,
            Checked::Valid(InFile::Linear) | Checked::Invalid => Interpolation::Linear,
            Checked::Valid(InFile::CubicSpline) => Interpolation::Cubic,
        };
        let input = format!("{sampler_path}.input");
        self.limits
            .keys(self.keys + self.accessors.count(sampler.input, &input)?)?;
        let (times, _) = self.accessors.floats(sampler.input, &input, TIMES)?;
        if let Some(place) = times.windows(2).position(|pair| pair[0] > pair[1]) {
            let path = format!("{input}, key {}", place + 1);
            let expected = format!("a time after {}", times[place]);
            return Err(faults.load(&path, expected, times[place + 1].to_string()));
        }
        let output = format!("{sampler_path}.output");
        let (values, width) = self
            .accessors
            .floats(sampler.output, &output, requirement)?;
        let per_key = match interpolation {
            Interpolation::Cubic => 3,
            Interpolation::Linear | Interpolation::Step => 1,
        };
        let of_element = if property == Property::MorphTargetWeights {
            targets.len()
        } else {
            1
        };
        let expected = times.len() * per_key * of_element;
        let found = values.len() / width;
        if found != expected {
            let expected = format!("{expected} elements for {} keys", times.len());
            return Err(faults.load(&output, expected, found.to_string()));
        }
        let sampled = Sampled {
            range: [times[0], times[times.len() - 1]].map(f64::from),
            jumps: times.windows(2).filter(|pair| pair[0] == pair[1]).count(),
            times: apart(&times),
            values,
            width: width * of_element,
            interpolation,
        };
        Ok((sampled, targets))
    }
}

/// The times of keys, those of several at one time apart by as little as can be: the curve jumps there to the last of them. Between two
/// times of f32 there are half a thousand million of f64.
fn apart(times: &[f32]) -> Vec<f64> {
    let mut next = f64::INFINITY;
    let mut apart: Vec<f64> = times.iter().copied().map(f64::from).collect();
    for time in apart.iter_mut().rev() {
        *time = time.min(next.next_down());
        next = *time;
    }
    apart
}

/// By how much a DOF is less than the value in the file: translations are relative to rest.
fn offset_of(target: DofKind, joint: &JointDraft) -> f64 {
    match target {
        DofKind::Translation { axis, .. } => joint.offset[axis.index()],
        DofKind::Rotation { .. } | DofKind::Scale { .. } | DofKind::Morph { .. } => 0.0,
    }
}

impl Sampled {
    /// What is odd about its keys.
    fn warn(&self, faults: Faults<'_>, path: &str, warnings: &mut Warnings) {
        let mut warn =
            |sentence: &str| warnings.push(|| faults.warning(&format!("{path} {sentence}")));
        if self.range[0] < 0.0 {
            warn("has a key before 0 seconds");
        }
        if self.jumps > 0 {
            let jumps = self.jumps;
            warn(&format!("has {jumps} keys at the time of the one before"));
        }
        if self.times.len() == 1 && self.interpolation == Interpolation::Cubic {
            warn("has a spline of one key, whose value holds");
        }
    }

    /// A channel for each component.
    fn channels(
        &self,
        targets: &[DofKind],
        joint: &JointDraft,
    ) -> impl Iterator<Item = ChannelDraft> {
        let channel = |(component, &target): (usize, &DofKind)| ChannelDraft::Dof {
            target: ChannelTarget::Dof(target),
            curve: self.curve(component, offset_of(target, joint)),
        };
        targets.iter().enumerate().map(channel)
    }

    /// A component of the value at a key, and of the slopes into and out of it.
    fn at(&self, key: usize, component: usize) -> [f64; 3] {
        let number = |place: usize| f64::from(self.values[place * self.width + component]);
        match self.interpolation {
            // The file has them in this order.
            Interpolation::Cubic => {
                let [slope_in, value, slope_out] = [0, 1, 2].map(|place| number(3 * key + place));
                [value, slope_in, slope_out]
            }
            Interpolation::Linear | Interpolation::Step => [number(key), 0.0, 0.0],
        }
    }

    fn curve(&self, component: usize, offset: f64) -> Curve<f64> {
        let key = |(key, &time): (usize, &f64)| {
            let [value, slope_in, slope_out] = self.at(key, component);
            Key {
                time,
                value: value - offset,
                slope_in,
                slope_out,
            }
        };
        held(
            self.times.iter().enumerate().map(key).collect(),
            self.interpolation,
        )
    }

    /// And how many of them are not unit quaternions.
    fn rotations(&self) -> (Curve<DQuat>, usize) {
        let mut not_unit = 0;
        let key = |(key, &time): (usize, &f64)| {
            let of_components = [0, 1, 2, 3].map(|component| self.at(key, component));
            let quaternion = |of: usize| DQuat::from_array(of_components.map(|it| it[of]));
            let given = quaternion(0);
            not_unit += usize::from(!is_unit(given));
            // A slerp is one only between unit quaternions; a spline is made unit at its end.
            let value = match self.interpolation {
                _ if given.length() == 0.0 => DQuat::IDENTITY,
                Interpolation::Linear => given.normalize(),
                _ => given,
            };
            Key {
                time,
                value,
                slope_in: quaternion(1),
                slope_out: quaternion(2),
            }
        };
        let keys = self.times.iter().enumerate().map(key).collect();
        (held(keys, self.interpolation), not_unit)
    }
}

/// Before the first key and after the last one their values hold.
fn held<V>(keys: Vec<Key<V>>, interpolation: Interpolation) -> Curve<V> {
    Curve {
        keys,
        interpolation,
        before: Extrapolation::Constant,
        after: Extrapolation::Constant,
    }
}
