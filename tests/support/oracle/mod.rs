//! Skinning done again in f64, from the text of the files and by the shortest way from its definition: what renderers are measured with.
//! It shares no code with the crate, so that a wrong reader, matrix or inverse cannot agree with itself. Never lives here: adapters and requests.

pub mod clip;
pub mod compare;
pub mod dual_quaternion;
pub mod matrix;
mod read_cse169;
mod read_mit;
pub mod smooth;
mod words;

pub use dual_quaternion::Signs;
pub use matrix::Vector;

use super::random::Random;
use clip::Clip;
use dual_quaternion::{Blend, Parts};
use matrix::{
    Matrix, Square, add_share, along, cofactors, difference, inverse, length, linear_part, moved,
    product, scaled, sum_of_squares, times, translation, turn,
};

#[derive(Debug, Clone)]
pub struct Joint {
    pub name: String,
    pub parent: Option<usize>,
    pub offset: Vector,
    /// As the file has them, not yet inside the limits.
    pub angles: Vector,
    pub limits: [[f64; 2]; 3],
}

impl Default for Joint {
    /// Unlimited, on its parent.
    fn default() -> Self {
        Self {
            name: String::new(),
            parent: None,
            offset: [0.0; 3],
            angles: [0.0; 3],
            limits: [[f64::NEG_INFINITY, f64::INFINITY]; 3],
        }
    }
}

/// Where some vertices stand at weight 1, and their unit normals.
#[derive(Debug, Clone)]
pub struct Morph {
    pub name: String,
    pub positions: Vec<(usize, Vector)>,
    pub normals: Vec<(usize, Vector)>,
}

/// Which axis is turned about first.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum AngleOrder {
    /// `Rz · Ry · Rx`: CSE 169.
    #[default]
    XFirst,
    /// `Rx · Ry · Rz`: MIT.
    ZFirst,
}

/// What some files say together, as they have it.
#[derive(Debug, Clone, Default)]
pub struct Rig {
    pub joints: Vec<Joint>,
    pub angle_order: AngleOrder,
    pub positions: Vec<Vector>,
    /// Of unit length. `None` where nothing says which.
    pub normals: Vec<Option<Vector>>,
    /// Of each vertex: `(binding, weight)`.
    pub weights: Vec<Vec<(usize, f64)>>,
    /// Where each joint stood when the skin was bound.
    pub bindings: Vec<Matrix>,
    pub triangles: Vec<[usize; 3]>,
    pub morphs: Vec<Morph>,
    pub clips: Vec<Clip>,
}

/// A displacement of the root, three angles of each joint and a weight for each morph.
#[derive(Debug, Clone)]
pub struct Pose {
    pub displacement: Vector,
    pub angles: Vec<Vector>,
    pub morphs: Vec<f64>,
}

impl Pose {
    /// In the order that the wire has: the root's translation, then its angles and every other joint's, then morphs.
    pub fn dof_values(&self) -> Vec<f64> {
        let displacement = self.displacement.iter().filter(|_| !self.angles.is_empty());
        let angles = self.angles.iter().flatten();
        let dofs = displacement.chain(angles).chain(&self.morphs);
        dofs.copied().collect()
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Skinning {
    Linear,
    DualQuaternion(Signs),
}

/// What came out for each vertex. `None` where rounding decides it: a normal where the blend has squeezed the surface flat, a position where a
/// dual quaternion stands at a right angle to the one whose side it is to take.
#[derive(Debug, Clone)]
pub struct Skinned {
    pub positions: Vec<Option<Vector>>,
    pub normals: Vec<Option<Vector>>,
}

impl Rig {
    /// Of `(file name, text)`. Panics at what it does not know: the files it is used with are right.
    pub fn read<'a>(files: impl IntoIterator<Item = (&'a str, &'a str)>) -> Self {
        let mut rig = Self::default();
        for (name, text) in files {
            let (stem, ending) = name.rsplit_once('.').expect("an ending");
            match ending {
                // Words begin one dialect, numbers the other.
                "skel" if text.trim_start().starts_with(char::is_alphabetic) => {
                    rig.joints = read_cse169::skeleton(text);
                }
                "skel" => {
                    rig.joints = read_mit::skeleton(text);
                    rig.angle_order = AngleOrder::ZFirst;
                    rig.bindings = rig.world_from_joint(&rig.rest());
                }
                "skin" => read_cse169::skin(text, &mut rig),
                "obj" => read_mit::mesh(text, &mut rig),
                "attach" => rig.weights = read_mit::attachment(text),
                "morph" => rig.morphs.push(read_cse169::morph(stem, text)),
                "anim" => rig.clips.push(read_cse169::animation(stem, text)),
                // It names the others, which are given anyway.
                "rig" => {}
                other => panic!("unknown ending `{other}`"),
            }
        }
        if rig.normals.is_empty() {
            rig.normals = smooth::normals(&rig.positions, &rig.triangles);
        }
        rig
    }

    /// The file's own pose, brought inside its limits.
    pub fn rest(&self) -> Pose {
        self.clamped(Pose {
            displacement: [0.0; 3],
            angles: self.joints.iter().map(|joint| joint.angles).collect(),
            morphs: vec![0.0; self.morphs.len()],
        })
    }

    /// Angles within ±π, limits or not, a root within ±2 units, and morphs from half their way back to half past their end.
    pub fn random_pose(&self, random: &mut Random) -> Pose {
        use std::f64::consts::PI;
        let displacement = [0; 3].map(|_| random.within(2.0));
        let angles = self.joints.iter();
        let angles = angles
            .map(|_| [0; 3].map(|_| random.within(PI)))
            .collect::<Vec<_>>();
        let morphs = self.morphs.iter().map(|_| 0.5 + random.within(1.0));
        Pose {
            displacement,
            angles,
            morphs: morphs.collect(),
        }
    }

    /// Channels are the root's displacement and every joint's angles; those that a clip does not have stay at rest, those that the rig does not
    /// have go nowhere.
    pub fn sampled(&self, clip: &Clip, time: f64) -> Pose {
        let mut pose = self.rest();
        let angles = pose.angles.iter_mut().flatten();
        let dofs = pose.displacement.iter_mut().chain(angles);
        for (dof, channel) in dofs.zip(&clip.channels) {
            *dof = channel.at(time);
        }
        self.clamped(pose)
    }

    fn clamped(&self, mut pose: Pose) -> Pose {
        for (angles, joint) in pose.angles.iter_mut().zip(&self.joints) {
            for (angle, [min, max]) in angles.iter_mut().zip(joint.limits) {
                *angle = angle.max(min).min(max);
            }
        }
        pose
    }

    /// `world = parent's world · T(offset) · rotation` of each joint.
    pub fn world_from_joint(&self, pose: &Pose) -> Vec<Matrix> {
        let mut world: Vec<Matrix> = Vec::new();
        for (joint, angles) in self.joints.iter().zip(&pose.angles) {
            let mut at = joint.offset;
            if joint.parent.is_none() {
                at = along(at, 1.0, pose.displacement);
            }
            let [x, y, z] = [0, 1, 2].map(|axis| turn(axis, angles[axis]));
            let rotation = match self.angle_order {
                AngleOrder::XFirst => product(&product(&z, &y), &x),
                AngleOrder::ZFirst => product(&product(&x, &y), &z),
            };
            let local = product(&translation(at), &rotation);
            world.push(match joint.parent {
                Some(parent) => product(&world[parent], &local),
                None => local,
            });
        }
        world
    }

    /// Vertices as morphs leave them, where joints take them; without a skeleton they stay as they were modelled.
    pub fn skin(&self, pose: &Pose, skinning: Skinning) -> Skinned {
        let (positions, normals) = self.morphed(&pose.morphs);
        let world = self.world_from_joint(pose);
        let moves: Vec<Matrix> = world
            .iter()
            .zip(&self.bindings)
            .map(|(world, binding)| product(world, &inverse(binding)))
            .collect();
        if moves.is_empty() {
            let positions = positions.into_iter().map(Some).collect();
            return Skinned { positions, normals };
        }
        let parts: Vec<Parts> = moves.iter().map(Parts::of).collect();
        let blend = |vertex: usize| {
            let influences = self.normalized_weights(vertex);
            match skinning {
                Skinning::Linear => Some(linear_blend(&influences, &moves)),
                Skinning::DualQuaternion(signs) => Blend::of(&influences, &parts, signs)
                    .map(|blend| (blend.matrix(), blend.normal_matrix())),
            }
        };
        let vertices = (0..self.positions.len()).map(|vertex| {
            let Some((blend, normal_blend)) = blend(vertex) else {
                return (None, None);
            };
            let squeeze = sum_of_squares(&linear_part(&blend));
            let normal = normals[vertex].and_then(|normal| {
                let turned = times(&normal_blend, normal);
                (length(turned) > FLATTEST * squeeze).then(|| scaled(turned))
            });
            (Some(moved(&blend, positions[vertex])), normal)
        });
        let (positions, normals) = vertices.unzip();
        Skinned { positions, normals }
    }

    /// `v = v₀ + Σ φ (vᵢ − v₀)`, normals likewise.
    fn morphed(&self, weights: &[f64]) -> (Vec<Vector>, Vec<Option<Vector>>) {
        let mut positions = self.positions.clone();
        let mut normals = self.normals.clone();
        // How large what is added to each normal is, before it cancels.
        let mut sizes = vec![1.0; normals.len()];
        for (morph, &weight) in self.morphs.iter().zip(weights) {
            for &(vertex, target) in &morph.positions {
                let step = difference(target, self.positions[vertex]);
                positions[vertex] = along(positions[vertex], weight, step);
            }
            for &(vertex, target) in &morph.normals {
                let (Some(base), Some(sum)) = (self.normals[vertex], normals[vertex]) else {
                    continue;
                };
                let step = difference(target, base);
                normals[vertex] = Some(along(sum, weight, step));
                sizes[vertex] += (weight * length(step)).abs();
            }
        }
        let normals = normals.into_iter().zip(sizes).map(|(normal, size)| {
            let normal = normal.filter(|sum| length(*sum) > FLATTEST * size);
            normal.map(scaled)
        });
        (positions, normals.collect())
    }

    /// Divided by their sum.
    fn normalized_weights(&self, vertex: usize) -> Vec<(usize, f64)> {
        let weights = &self.weights[vertex];
        let sum: f64 = weights.iter().map(|(_, weight)| weight).sum();
        let share = |&(binding, weight): &(usize, f64)| (binding, weight / sum);
        weights.iter().map(share).collect()
    }
}

/// What takes positions and what takes normals where they belong: `Σ w · M`, and its cofactors.
fn linear_blend(influences: &[(usize, f64)], moves: &[Matrix]) -> (Matrix, Square) {
    let mut blend = [[0.0; 4]; 4];
    for &(binding, weight) in influences {
        add_share(&mut blend, weight, &moves[binding]);
    }
    (blend, cofactors(&linear_part(&blend)))
}

/// How short a normal may become against the blend before rounding in f32 turns it by more than [`compare::Worst::NORMAL`]: f32 leaves
/// 1e-7 of the blend's square, so at this share a tenth of that tolerance.
const FLATTEST: f64 = 1e-3;
