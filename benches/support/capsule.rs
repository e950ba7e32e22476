//! A character of any size: a capsule along y, bound to a chain of joints. Closed, and wound outward.

use glam::{DAffine3, DVec3};
use rigd::limits::Limits;
use rigd::rig::{BindingDraft, Draft, JointDraft, Limit, MeshDraft, Rig, RotationOrder};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

/// How much of everything there is.
#[derive(Clone, Copy)]
pub struct Capsule {
    /// From pole to pole; rings of vertices are one more.
    pub rings: usize,
    /// Around.
    pub segments: usize,
    pub joints: usize,
    /// Of each vertex.
    pub influences: usize,
}

/// 10,100 vertices, 20,000 triangles, 64 joints, 4 influences.
pub const USUAL: Capsule = Capsule {
    rings: 100,
    segments: 100,
    joints: 64,
    influences: 4,
};

/// Half the length of the part between the caps, and the radius.
const HALF: f64 = 1.0;
const RADIUS: f64 = 0.5;

impl Capsule {
    pub fn rig(&self) -> Arc<Rig> {
        let mut positions = Vec::new();
        let mut normals = Vec::new();
        let mut influences = Vec::new();
        for ring in 0..=self.rings {
            let (out, up, middle) = profile(ring as f64 / self.rings as f64);
            for segment in 0..self.segments {
                let (sin, cos) = (TAU * segment as f64 / self.segments as f64).sin_cos();
                let normal = DVec3::new(out * cos, up, out * sin);
                let position = normal * RADIUS + DVec3::Y * middle;
                positions.push(position.as_vec3());
                normals.push(normal.as_vec3());
                influences.extend(self.influences_at(position.y));
            }
        }
        let mut triangles = Vec::new();
        let at =
            |ring: usize, segment: usize| (ring * self.segments + segment % self.segments) as u32;
        for ring in 0..self.rings {
            for segment in 0..self.segments {
                let (a, b) = (at(ring, segment), at(ring, segment + 1));
                let (c, d) = (at(ring + 1, segment), at(ring + 1, segment + 1));
                triangles.extend([[a, c, b], [b, c, d]]);
            }
        }
        let vertices = positions.len();
        let draft = Draft {
            joints: (0..self.joints).map(|joint| self.joint(joint)).collect(),
            bindings: (0..self.joints)
                .map(|joint| BindingDraft {
                    joint: Some(joint),
                    bind_from_joint: DAffine3::from_translation(DVec3::Y * self.height(joint)),
                })
                .collect(),
            meshes: vec![MeshDraft {
                name: "capsule".to_owned(),
                positions,
                normals: Some(normals),
                influence_counts: vec![self.influences as u32; vertices],
                influences,
                triangles,
                ..MeshDraft::default()
            }],
            ..Draft::default()
        };
        Arc::new(draft.build(&Limits::default()).expect("a valid draft"))
    }

    fn height(&self, joint: usize) -> f64 {
        let length = 2.0 * (HALF + RADIUS);
        length * ((joint as f64 + 0.5) / self.joints as f64 - 0.5)
    }

    fn joint(&self, joint: usize) -> JointDraft {
        let below = joint.checked_sub(1).map_or(0.0, |below| self.height(below));
        JointDraft {
            name: String::new(),
            parent: joint.checked_sub(1),
            offset: DVec3::Y * (self.height(joint) - below),
            rotation_order: RotationOrder::Zyx,
            rest_angles: DVec3::ZERO,
            rotation_limits: [Limit::NONE; 3],
            translates: joint == 0,
            bounding_box: None,
        }
    }

    /// The joints about this height, the nearer the heavier.
    fn influences_at(&self, y: f64) -> Vec<(u32, f64)> {
        let length = 2.0 * (HALF + RADIUS);
        let middle = (y / length + 0.5) * self.joints as f64;
        let first = (middle - self.influences as f64 / 2.0).round().max(0.0) as usize;
        let first = first.min(self.joints - self.influences);
        let weight = |joint: usize| 1.0 / (0.5 + (joint as f64 + 0.5 - middle).abs());
        (first..first + self.influences)
            .map(|joint| (joint as u32, weight(joint)))
            .collect()
    }
}

/// Outward and upward part of the normal, and the middle of the ring's sphere, from the top pole to the bottom one.
fn profile(share: f64) -> (f64, f64, f64) {
    let cap = RADIUS * FRAC_PI_2;
    let along = share * (2.0 * cap + 2.0 * HALF);
    let (angle, middle) = if along < cap {
        (along / RADIUS, HALF)
    } else if along > cap + 2.0 * HALF {
        ((along - 2.0 * HALF) / RADIUS, -HALF)
    } else {
        (FRAC_PI_2, HALF - (along - cap))
    };
    // Exactly at the pole, so that its vertices fall into one.
    let out = if share == 0.0 || share == 1.0 {
        0.0
    } else {
        angle.sin()
    };
    (out, angle.cos(), middle)
}
