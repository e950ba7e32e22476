//! A character of any size: a capsule along y, bound to a chain of joints, as files of the course's kind. Closed, and wound outward.

use rigd::formats::{File, FileRef};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::fmt::Write;

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
    /// Morph targets, each of which moves every vertex.
    pub morphs: usize,
}

/// 10,100 vertices, 20,000 triangles, 64 joints, 4 influences, no morph target.
pub const USUAL: Capsule = Capsule {
    rings: 100,
    segments: 100,
    joints: 64,
    influences: 4,
    morphs: 0,
};

/// Half the length of the part between the caps, and the radius.
const HALF: f64 = 1.0;
const RADIUS: f64 = 0.5;

impl Capsule {
    pub fn vertex_count(&self) -> usize {
        (self.rings + 1) * self.segments
    }

    /// A skeleton, a skin, and its morph targets.
    pub fn files(&self) -> Vec<FileRef> {
        let file = |name: &str, text: String| {
            FileRef::Inline(File {
                name: name.to_owned(),
                bytes: text.into_bytes().into(),
            })
        };
        let mut files = vec![
            file("capsule.skel", self.skel()),
            file("capsule.skin", self.skin()),
        ];
        files.extend(
            (0..self.morphs).map(|morph| file(&format!("m{morph}.morph"), self.morph(morph))),
        );
        files
    }

    /// The capsule a little thicker, the later ones more so.
    fn morph(&self, morph: usize) -> String {
        let radius = RADIUS * (1.01 + 1e-4 * morph as f64);
        let mut text = format!("positions {} {{", self.vertex_count());
        for ring in 0..=self.rings {
            let (out, up, middle) = profile(ring as f64 / self.rings as f64);
            for segment in 0..self.segments {
                let (sin, cos) = (TAU * segment as f64 / self.segments as f64).sin_cos();
                let [x, y, z] = [out * cos, up, out * sin].map(|part| part * radius);
                let vertex = ring * self.segments + segment;
                let _ = writeln!(text, "{vertex} {x:.4} {:.4} {z:.4}", y + middle);
            }
        }
        text + "}"
    }

    fn skel(&self) -> String {
        let mut text = String::new();
        for joint in 0..self.joints {
            let below = joint.checked_sub(1).map_or(0.0, |below| self.height(below));
            let _ = write!(
                text,
                "balljoint j{joint} {{ offset 0 {} 0 ",
                self.height(joint) - below
            );
        }
        text + &"}".repeat(self.joints)
    }

    fn skin(&self) -> String {
        let (mut positions, mut normals, mut weights) =
            (String::new(), String::new(), String::new());
        for ring in 0..=self.rings {
            let (out, up, middle) = profile(ring as f64 / self.rings as f64);
            for segment in 0..self.segments {
                let (sin, cos) = (TAU * segment as f64 / self.segments as f64).sin_cos();
                let [x, y, z] = [out * cos, up, out * sin];
                let height = y * RADIUS + middle;
                let _ = writeln!(positions, "{:.7} {height:.7} {:.7}", x * RADIUS, z * RADIUS);
                let _ = writeln!(normals, "{x:.7} {y:.7} {z:.7}");
                let _ = writeln!(weights, "{}", self.influences_at(height));
            }
        }
        let mut triangles = String::new();
        let at = |ring: usize, segment: usize| ring * self.segments + segment % self.segments;
        for ring in 0..self.rings {
            for segment in 0..self.segments {
                let (a, b) = (at(ring, segment), at(ring, segment + 1));
                let (c, d) = (at(ring + 1, segment), at(ring + 1, segment + 1));
                let _ = writeln!(triangles, "{a} {b} {c} {b} {d} {c}");
            }
        }
        let mut bindings = String::new();
        for joint in 0..self.joints {
            let height = self.height(joint);
            let _ = writeln!(bindings, "matrix {{ 1 0 0 0 1 0 0 0 1 0 {height} 0 }}");
        }
        let (vertices, faces) = (self.vertex_count(), 2 * self.rings * self.segments);
        format!(
            "positions {vertices} {{ {positions} }} normals {vertices} {{ {normals} }} skinweights {vertices} {{ {weights} }}
             triangles {faces} {{ {triangles} }} bindings {} {{ {bindings} }}",
            self.joints
        )
    }

    fn height(&self, joint: usize) -> f64 {
        LENGTH * ((joint as f64 + 0.5) / self.joints as f64 - 0.5)
    }

    /// The joints about this height, the nearer the heavier.
    fn influences_at(&self, y: f64) -> String {
        let middle = (y / LENGTH + 0.5) * self.joints as f64;
        let first = (middle - self.influences as f64 / 2.0).round().max(0.0) as usize;
        let first = first.min(self.joints - self.influences);
        let joints = first..first + self.influences;
        let weight = |joint: usize| 1.0 / (0.5 + (joint as f64 + 0.5 - middle).abs());
        let sum: f64 = joints.clone().map(weight).sum();
        let mut text = self.influences.to_string();
        for joint in joints {
            let _ = write!(text, " {joint} {:.6}", weight(joint) / sum);
        }
        text
    }
}

const LENGTH: f64 = 2.0 * (HALF + RADIUS);

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
