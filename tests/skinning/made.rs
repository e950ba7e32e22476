//! Rigs of the tests' own making, each with what real files rarely have. Never lives here: what is asked of them.

use crate::support::oracle;
use crate::support::oracle::matrix::{Vector, length, scaled};
use crate::support::random::Random;
use std::fmt::Write;

/// Files by name and text, together a rig.
pub struct Made {
    pub name: String,
    pub files: Vec<(String, String)>,
}

impl Made {
    /// Files are given by their endings.
    pub fn new<const N: usize>(name: &str, files: [(&str, String); N]) -> Self {
        let named = files.map(|(ending, text)| (format!("{name}.{ending}"), text));
        Self {
            name: name.to_owned(),
            files: named.into(),
        }
    }

    /// With one more file, that has a name of its own.
    pub fn and(mut self, file: &str, text: String) -> Self {
        self.files.push((file.to_owned(), text));
        self
    }

    pub fn oracle(&self) -> oracle::Rig {
        let files = self.files.iter();
        oracle::Rig::read(files.map(|(name, text)| (name.as_str(), text.as_str())))
    }
}

/// A skeleton given as a tree of nested joints.
pub fn skel(parents: &[(Option<usize>, Vector)]) -> String {
    fn joint(parents: &[(Option<usize>, Vector)], index: usize, text: &mut String) {
        let [x, y, z] = parents[index].1;
        let _ = writeln!(text, "balljoint j{index} {{ offset {x} {y} {z}");
        for (child, _) in parents
            .iter()
            .enumerate()
            .filter(|(_, it)| it.0 == Some(index))
        {
            joint(parents, child, text);
        }
        text.push_str("}\n");
    }
    let mut text = String::new();
    joint(parents, 0, &mut text);
    text
}

pub struct SkinText {
    pub positions: Vec<Vector>,
    pub normals: Vec<Vector>,
    pub weights: Vec<Vec<(usize, f64)>>,
    pub triangles: Vec<[usize; 3]>,
    /// Columns a, b, c and d.
    pub bindings: Vec<[Vector; 4]>,
}

impl SkinText {
    /// Random vertices within a unit, each following the joints that `weights` gives it.
    pub fn random(
        count: usize,
        bindings: Vec<[Vector; 4]>,
        weights: impl FnMut(usize) -> Vec<(usize, f64)>,
    ) -> Self {
        let mut random = Random(count as u64);
        let mut vectors = |most| -> Vec<Vector> {
            (0..count)
                .map(|_| [0; 3].map(|_| random.within(most)))
                .collect()
        };
        Self {
            positions: vectors(1.0),
            normals: vectors(2.0),
            weights: (0..count).map(weights).collect(),
            triangles: vec![[0, 1, 2]],
            bindings,
        }
    }

    pub fn text(&self) -> String {
        let count = self.positions.len();
        let weights = self.weights.iter().map(|of_vertex| {
            let list = of_vertex
                .iter()
                .map(|(joint, weight)| format!(" {joint} {weight:?}"));
            format!("{}{}\n", of_vertex.len(), list.collect::<String>())
        });
        let triangle = |[a, b, c]: &[usize; 3]| format!("{a} {b} {c}\n");
        let bindings = self
            .bindings
            .iter()
            .map(|columns| format!("matrix {{\n{}}}\n", rows(columns)));
        format!(
            "positions {count} {{\n{}}}\nnormals {count} {{\n{}}}\nskinweights {count} {{\n{}}}\n\
             triangles {} {{\n{}}}\nbindings {} {{\n{}}}\n",
            rows(&self.positions),
            rows(&self.normals),
            weights.collect::<String>(),
            self.triangles.len(),
            self.triangles.iter().map(triangle).collect::<String>(),
            self.bindings.len(),
            bindings.collect::<String>(),
        )
    }
}

/// Without exponents, which no real file has.
fn rows(rows: &[Vector]) -> String {
    let row = |[x, y, z]: &Vector| format!("{x} {y} {z}\n");
    rows.iter().map(row).collect()
}

/// Where joints stand that nobody has turned.
pub fn unturned(at: Vector) -> [Vector; 4] {
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], at]
}

/// Two joints, bound turned about an axis off every coordinate axis, so that columns read as rows turn the other way.
pub fn bound_turned() -> Made {
    let columns = |x: f64, z: f64| {
        let matrix = glam::DMat3::from_rotation_z(z) * glam::DMat3::from_rotation_x(x);
        let [a, b, c] =
            [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|column| column.to_array());
        [a, b, c, [0.3, -0.2, x]]
    };
    let skel = skel(&[(None, [0.0, 0.5, 0.0]), (Some(0), [0.1, 1.0, 0.2])]);
    let weights = |vertex| vec![(0, 0.1 + vertex as f64), (1, 1.0)];
    let bindings = vec![columns(0.7, 0.4), columns(-0.2, 1.9)];
    let skin = SkinText::random(50, bindings, weights);
    Made::new("bound turned", [("skel", skel), ("skin", skin.text())])
}

/// Two joints, bound while they were stretched.
pub fn bound_stretched() -> Made {
    let stretched = |[x, y, z]: Vector, at| [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z], at];
    let bindings = vec![
        stretched([3.0, 0.5, 1.0], [0.0; 3]),
        stretched([0.4, 0.9, 2.5], [0.0, 1.0, 0.0]),
    ];
    let skel = skel(&[(None, [0.0; 3]), (Some(0), [0.0, 1.0, 0.0])]);
    let weights = |vertex| vec![(0, 1.0), (1, vertex as f64 / 10.0)];
    let skin = SkinText::random(50, bindings, weights);
    Made::new("bound stretched", [("skel", skel), ("skin", skin.text())])
}

/// Three joints, bound while they were turned, stretched and sheared at once: no two columns are as long or at right angles.
pub fn bound_sheared() -> Made {
    let bindings = vec![
        [
            [0.9, 0.7, -0.2],
            [-0.5, 1.2, 0.3],
            [0.4, -0.1, 0.6],
            [0.1, 0.0, 0.2],
        ],
        [
            [0.1, -0.8, 0.5],
            [1.6, 0.4, 0.2],
            [0.3, 0.2, 1.1],
            [0.0, 1.0, 0.0],
        ],
        [
            [0.5, 0.1, 0.9],
            [0.3, 0.7, -0.6],
            [-1.4, 0.2, 0.8],
            [0.2, 0.4, -0.7],
        ],
    ];
    let skel = skel(&[
        (None, [0.0, 0.2, 0.0]),
        (Some(0), [0.0, 1.0, 0.0]),
        (Some(0), [0.3, 0.5, -0.4]),
    ]);
    let weights = |vertex| vec![(2, 1.0), (0, vertex as f64 / 20.0), (1, 0.7)];
    let skin = SkinText::random(60, bindings, weights);
    Made::new("bound sheared", [("skel", skel), ("skin", skin.text())])
}

/// Forty joints beside each other, all of which every vertex follows.
pub fn forty() -> Made {
    let mut random = Random(40);
    let joints: Vec<_> = (0..40).map(|index| (index > 0).then_some(0)).collect();
    let joints: Vec<_> = joints
        .into_iter()
        .map(|parent| (parent, [0; 3].map(|_| random.within(1.0))))
        .collect();
    let bindings = joints.iter().map(|(_, at)| unturned(*at)).collect();
    // Off from a sum of 1, and each vertex by other weights.
    let mut weight = || 1.1 + random.within(1.0);
    let skin = SkinText::random(20, bindings, |_| {
        (0..40).map(|joint| (joint, weight())).collect()
    });
    Made::new("forty", [("skel", skel(&joints)), ("skin", skin.text())])
}

pub fn three_hundred() -> Made {
    let joints: Vec<_> = (0..300)
        .map(|index: usize| (index.checked_sub(1), [0.0, 0.1, 0.0]))
        .collect();
    let bindings = (1..=300)
        .map(|index| unturned([0.0, 0.1 * f64::from(index), 0.0]))
        .collect();
    let skin = SkinText::random(300, bindings, |vertex| {
        vec![(vertex, 0.75), (299 - vertex, 0.25)]
    });
    Made::new(
        "three hundred",
        [("skel", skel(&joints)), ("skin", skin.text())],
    )
}

/// Joints that vertices follow in equal parts, listed from the last to the first.
pub fn equals() -> Made {
    let joints = [
        (None, [0.0; 3]),
        (Some(0), [0.0, 0.5, 0.0]),
        (Some(0), [0.4, 0.0, 0.1]),
        (Some(0), [-0.2, 0.1, 0.3]),
    ];
    let bindings = joints.iter().map(|(_, at)| unturned(*at)).collect();
    let weights = |_| (0..4).rev().map(|joint| (joint, 0.25)).collect();
    let skin = SkinText::random(30, bindings, weights);
    Made::new("equals", [("skel", skel(&joints)), ("skin", skin.text())])
}

/// Some vertices elsewhere: those whose index is divisible. Normals are not of unit length, as in some real files.
fn morph(count: usize, divisor: usize) -> String {
    let mut random = Random(divisor as u64);
    let vertices: Vec<usize> = (0..count).step_by(divisor).collect();
    let mut block = |name: &str| {
        let entry = |vertex: &usize| {
            let [x, y, z] = [0; 3].map(|_| random.within(1.0));
            format!("{vertex} {x:?} {y:?} {z:?}\n")
        };
        let entries: String = vertices.iter().map(entry).collect();
        format!("{name} {} {{\n{entries}}}\n", vertices.len())
    };
    block("positions") + &block("normals")
}

/// Two morphs, both of which move every sixth vertex.
pub fn morphing() -> Made {
    let joints = [(None, [0.0, 0.3, 0.0]), (Some(0), [0.1, 1.0, 0.2])];
    let bindings = vec![unturned([0.0, 0.3, 0.0]), unturned([0.1, 1.3, 0.2])];
    let weights = |vertex| vec![(0, 1.0), (1, vertex as f64 / 15.0)];
    let skin = SkinText::random(60, bindings, weights);
    Made::new("morphing", [("skel", skel(&joints)), ("skin", skin.text())])
        .and("smile.morph", morph(60, 2))
        .and("frown.morph", morph(60, 3))
}

/// The same two without joints, which is no skeleton at all.
pub fn morphing_alone() -> Made {
    let mut made = morphing();
    made.files.remove(0);
    made.name = "morphing alone".to_owned();
    made
}

/// A channel for each pair of what goes on before and after, with every kind of tangent at its first, its last and its inner keys.
pub fn animation(channels: usize) -> String {
    const MODES: [&str; 5] = ["constant", "linear", "cycle", "cycle_offset", "bounce"];
    const TANGENTS: [&str; 4] = ["smooth", "linear", "flat", "-0.75"];
    let mut random = Random(7);
    let mut text = format!("animation {{ range 0.0 2.0 numchannels {channels}\n");
    for channel in 0..channels {
        let (before, after) = (MODES[channel / 5 % 5], MODES[channel % 5]);
        // Channels without keys and of one key are channels too.
        let keys = [5, 3, 2, 4, 1, 0][channel % 6];
        let _ = write!(
            text,
            "channel {channel} {{ extrapolate {before} {after} keys {keys} {{"
        );
        let mut time = random.within(1.0);
        for key in 0..keys {
            let value = random.within(1.5);
            let arriving = TANGENTS[(channel + key) % 4];
            let leaving = TANGENTS[(channel / 4 + key) % 4];
            let _ = write!(text, "\n{time:?} {value:?} {arriving} {leaving}");
            time += 0.6 + random.within(0.5);
        }
        text.push_str("}}\n");
    }
    text + "}\n"
}

/// Eight joints, some of them limited, and three clips: one with a channel for each DOF, one with fewer and one with more.
pub fn moving() -> Made {
    let chain = [
        "offset 0 0.5 0 pose 0.1 0.2 0.3",
        "offset 0 1 0.2 rotxlimit -0.3 0.4 rotylimit -0.2 0.6 rotzlimit 0 0",
        "offset 0.3 1 0",
        "offset 0 1 0 pose 2 0 0 rotxlimit -1 1",
        "offset 0 1 0.1 rotzlimit 0.2 0.7",
        "offset 0.1 1 0 pose 0 0.5 0",
        "offset 0 1 0",
        "offset 0 1 0",
    ];
    let opened = chain.iter().enumerate();
    let opened = opened.map(|(index, items)| format!("balljoint j{index} {{ {items}\n"));
    let skel = opened.collect::<String>() + &"}".repeat(chain.len());
    let bindings = (0..8).map(|index| unturned([0.0, 0.5 + f64::from(index), 0.0]));
    let weights = |vertex| vec![(vertex % 8, 0.6), ((vertex + 1) % 8, 0.4)];
    let skin = SkinText::random(40, bindings.collect(), weights);
    Made::new("moving", [("skel", skel), ("skin", skin.text())])
        .and("whole.anim", animation(27))
        .and("short.anim", animation(10))
        .and("long.anim", animation(40))
}

/// A closed tube about the y axis from -4 to 4, of radius 1: rings from the bottom up, then the middles of its ends.
pub struct Tube {
    pub positions: Vec<Vector>,
    pub triangles: Vec<[usize; 3]>,
}

pub const RINGS: usize = 64;
pub const SIDES: usize = 32;
const HALF: f64 = 4.0;

/// How far from its middle the tube follows both of its joints: twice its radius, so that a sharp bend does not fold it into itself.
const RAMP: f64 = 2.0;

impl Tube {
    pub fn new() -> Self {
        let vertex = |index: usize| {
            let (ring, side) = (index / SIDES, index % SIDES);
            let around = std::f64::consts::TAU * side as f64 / SIDES as f64;
            let y = HALF * (2.0 * ring as f64 / (RINGS - 1) as f64 - 1.0);
            [around.cos(), y, around.sin()]
        };
        let mut positions: Vec<Vector> = (0..RINGS * SIDES).map(vertex).collect();
        positions.extend([[0.0, -HALF, 0.0], [0.0, HALF, 0.0]]);
        let at = |ring: usize, side: usize| ring * SIDES + side % SIDES;
        let [bottom, top] = [RINGS * SIDES, RINGS * SIDES + 1];
        let mut triangles = Vec::new();
        for side in 0..SIDES {
            for ring in 0..RINGS - 1 {
                let [a, b] = [at(ring, side), at(ring, side + 1)];
                let [c, d] = [at(ring + 1, side), at(ring + 1, side + 1)];
                triangles.extend([[a, c, b], [b, c, d]]);
            }
            triangles.push([bottom, at(0, side), at(0, side + 1)]);
            triangles.push([top, at(RINGS - 1, side + 1), at(RINGS - 1, side)]);
        }
        Self {
            positions,
            triangles,
        }
    }

    /// How much of a vertex follows the upper joint: without a corner where the ramp begins or ends.
    fn upper_weight([_, y, _]: Vector) -> f64 {
        let share = ((y + RAMP) / (2.0 * RAMP)).clamp(0.0, 1.0);
        share * share * (3.0 - 2.0 * share)
    }

    /// A joint at the lower end and one in the middle.
    pub fn rig(&self) -> Made {
        let radial = |&[x, y, z]: &Vector| {
            let is_middle = length([x, 0.0, z]) == 0.0;
            if is_middle {
                [0.0, y, 0.0]
            } else {
                [x, 0.0, z]
            }
        };
        let weights = |&position: &Vector| {
            let upper = Self::upper_weight(position);
            vec![(0, 1.0 - upper), (1, upper)]
        };
        let skin = SkinText {
            positions: self.positions.clone(),
            normals: self.positions.iter().map(radial).map(scaled).collect(),
            weights: self.positions.iter().map(weights).collect(),
            triangles: self.triangles.clone(),
            bindings: vec![unturned([0.0, -HALF, 0.0]), unturned([0.0; 3])],
        };
        let skel = skel(&[(None, [0.0, -HALF, 0.0]), (Some(0), [0.0, HALF, 0.0])]);
        Made::new("pipe", [("skel", skel), ("skin", skin.text())])
    }

    /// As MIT has it: a third joint on top of the second, no normals, and weights that nearly sum to 1. The root moves nothing of its own.
    pub fn mit_rig(&self) -> Made {
        let skel = "0.1 -4 0.2 -1\n0 0 0 0\n-.1 4 -.2 1\n0 2.5 0 2";
        let vertices = rows(&self.positions);
        let vertices: String = vertices.lines().map(|line| format!("v {line}\n")).collect();
        let face = |triangle: &[usize; 3]| {
            let [a, b, c] = triangle.map(|corner| corner + 1);
            format!("f {a} {b} {c}\n")
        };
        let faces: String = self.triangles.iter().map(face).collect();
        let weights = |&[x, y, z]: &Vector| {
            let upper = Self::upper_weight([x, y, z]);
            let top = Self::upper_weight([x, y - 2.5, z]) * upper;
            format!("{:.4} {:.4} {top:.4} \n", 1.0 - upper, upper - top)
        };
        let attach: String = self.positions.iter().map(weights).collect();
        let (skel, mesh) = (skel.to_owned(), vertices + &faces);
        Made::new(
            "mit pipe",
            [("skel", skel), ("obj", mesh), ("attach", attach)],
        )
    }
}
