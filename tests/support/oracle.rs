//! Skinning done again in f64, from the text of the files and by the shortest way from its definition: what renderers are measured with.
//! It shares no code with the crate, so that a wrong reader, matrix or inverse cannot agree with itself. Never lives here: adapters and requests.

/// Rows of numbers; acts on column vectors.
pub type Matrix = [[f64; 4]; 4];
pub type Vector = [f64; 3];

#[derive(Debug, Clone)]
pub struct Joint {
    pub name: String,
    pub parent: Option<usize>,
    pub offset: Vector,
    /// As the file has them, not yet inside the limits.
    pub angles: Vector,
    pub limits: [[f64; 2]; 3],
}

/// A `.skel`, a `.skin` or both, as the files have them.
#[derive(Debug, Clone, Default)]
pub struct Rig {
    pub joints: Vec<Joint>,
    pub positions: Vec<Vector>,
    pub normals: Vec<Vector>,
    /// Of each vertex: `(binding, weight)`.
    pub weights: Vec<Vec<(usize, f64)>>,
    /// Where each joint stood when the skin was bound.
    pub bindings: Vec<Matrix>,
    pub triangles: Vec<[usize; 3]>,
}

/// A displacement of the root and three angles of each joint.
#[derive(Debug, Clone)]
pub struct Pose {
    pub displacement: Vector,
    pub angles: Vec<Vector>,
}

impl Pose {
    /// In the order that the wire has: the root's translation, then its angles and every other joint's.
    pub fn dof_values(&self) -> Vec<f64> {
        let angles = self.angles.iter().flatten();
        self.displacement.iter().chain(angles).copied().collect()
    }
}

/// What came out for each vertex. A normal is `None` where the blend has squeezed the surface so flat that rounding decides it.
#[derive(Debug, Clone)]
pub struct Skinned {
    pub positions: Vec<Vector>,
    pub normals: Vec<Option<Vector>>,
}

impl Rig {
    /// Panics at what it does not know: the files it is used with are right.
    pub fn read(skel: Option<&str>, skin: Option<&str>) -> Self {
        let mut rig = Self {
            joints: skel.map(read_skeleton).unwrap_or_default(),
            ..Self::default()
        };
        if let Some(skin) = skin {
            rig.read_skin(skin);
        }
        rig
    }

    /// The file's own pose, brought inside its limits.
    pub fn rest(&self) -> Pose {
        let clamped = |joint: &Joint| {
            [0, 1, 2].map(|axis| {
                let [min, max] = joint.limits[axis];
                joint.angles[axis].max(min).min(max)
            })
        };
        Pose {
            displacement: [0.0; 3],
            angles: self.joints.iter().map(clamped).collect(),
        }
    }

    /// Angles within ±π, limits or not, and a root within ±2 units.
    pub fn random_pose(&self, random: &mut Random) -> Pose {
        use std::f64::consts::PI;
        Pose {
            displacement: [0; 3].map(|_| random.within(2.0)),
            angles: self
                .joints
                .iter()
                .map(|_| [0; 3].map(|_| random.within(PI)))
                .collect(),
        }
    }

    /// `world = parent's world · T(offset) · Rz · Ry · Rx` of each joint.
    pub fn world_from_joint(&self, pose: &Pose) -> Vec<Matrix> {
        let mut world: Vec<Matrix> = Vec::new();
        for (joint, &[x, y, z]) in self.joints.iter().zip(&pose.angles) {
            let mut at = joint.offset;
            if joint.parent.is_none() {
                at = [0, 1, 2].map(|i| at[i] + pose.displacement[i]);
            }
            let rotation = product(&product(&turn(1, 0, z), &turn(0, 2, y)), &turn(2, 1, x));
            let local = product(&translation(at), &rotation);
            world.push(match joint.parent {
                Some(parent) => product(&world[parent], &local),
                None => local,
            });
        }
        world
    }

    /// `v' = Σ w · W · B⁻¹ · v`, weights divided by their sum; without a skeleton the skin stays as it was modelled.
    pub fn skin(&self, pose: &Pose) -> Skinned {
        let world = self.world_from_joint(pose);
        let moves: Vec<Matrix> = world
            .iter()
            .zip(&self.bindings)
            .map(|(world, binding)| product(world, &inverse(binding)))
            .collect();
        let blended = |vertex: usize| {
            if moves.is_empty() {
                return translation([0.0; 3]);
            }
            let weights = &self.weights[vertex];
            let sum: f64 = weights.iter().map(|(_, weight)| weight).sum();
            let mut blend = [[0.0; 4]; 4];
            for &(binding, weight) in weights {
                for (row, moved) in blend.iter_mut().zip(&moves[binding]) {
                    for (entry, moved) in row.iter_mut().zip(moved) {
                        *entry += weight / sum * moved;
                    }
                }
            }
            blend
        };
        let vertices = (0..self.positions.len()).map(|vertex| {
            let blend = blended(vertex);
            let [x, y, z] = self.positions[vertex];
            let position = [0, 1, 2]
                .map(|i| blend[i][0] * x + blend[i][1] * y + blend[i][2] * z + blend[i][3]);
            (position, turned_normal(&blend, self.normals[vertex]))
        });
        let (positions, normals) = vertices.unzip();
        Skinned { positions, normals }
    }

    fn read_skin(&mut self, text: &str) {
        let mut words = Words::of(text);
        while let Some(section) = words.next() {
            if section == "material" {
                while words.word() != "}" {}
                continue;
            }
            let count: usize = words.number();
            words.expect("{");
            match section.as_str() {
                "positions" => self.positions = (0..count).map(|_| words.numbers()).collect(),
                "normals" => self.normals = (0..count).map(|_| words.numbers()).collect(),
                "texcoords" => {
                    let _unused: Vec<[f64; 2]> = (0..count).map(|_| words.numbers()).collect();
                }
                "triangles" => {
                    let corner = |words: &mut Words| words.number();
                    self.triangles = (0..count)
                        .map(|_| [0; 3].map(|_| corner(&mut words)))
                        .collect();
                }
                "skinweights" => {
                    for _ in 0..count {
                        let influences: usize = words.number();
                        let of_vertex = (0..influences).map(|_| (words.number(), words.number()));
                        self.weights.push(of_vertex.collect());
                    }
                }
                "bindings" => {
                    for _ in 0..count {
                        words.expect("matrix");
                        words.expect("{");
                        let columns: [Vector; 4] = [0; 4].map(|_| words.numbers());
                        words.expect("}");
                        self.bindings.push(from_columns(columns));
                    }
                }
                other => panic!("unknown section `{other}`"),
            }
            words.expect("}");
        }
    }
}

fn read_skeleton(text: &str) -> Vec<Joint> {
    let mut words = Words::of(text);
    let mut joints: Vec<Joint> = Vec::new();
    let mut open: Vec<usize> = Vec::new();
    while let Some(word) = words.next() {
        if matches!(word.as_str(), "balljoint" | "joint") {
            let name = words.word();
            words.expect("{");
            joints.push(Joint {
                name,
                parent: open.last().copied(),
                offset: [0.0; 3],
                angles: [0.0; 3],
                limits: [[f64::NEG_INFINITY, f64::INFINITY]; 3],
            });
            open.push(joints.len() - 1);
            continue;
        }
        let &current = open.last().expect("words stand inside a joint");
        let joint = &mut joints[current];
        match word.as_str() {
            "}" => {
                open.pop();
            }
            "offset" => joint.offset = words.numbers(),
            "pose" => joint.angles = words.numbers(),
            "boxmin" | "boxmax" => {
                let _box: Vector = words.numbers();
            }
            "rotxlimit" => joint.limits[0] = words.numbers(),
            "rotylimit" => joint.limits[1] = words.numbers(),
            "rotzlimit" => joint.limits[2] = words.numbers(),
            other => panic!("unknown word `{other}`"),
        }
    }
    joints
}

/// Words and braces, wherever the lines end.
struct Words(std::vec::IntoIter<String>);

impl Words {
    fn of(text: &str) -> Self {
        let spaced = text.replace('{', " { ").replace('}', " } ");
        let words: Vec<String> = spaced.split_whitespace().map(str::to_owned).collect();
        Self(words.into_iter())
    }

    fn next(&mut self) -> Option<String> {
        self.0.next()
    }

    fn word(&mut self) -> String {
        self.next().expect("another word")
    }

    fn expect(&mut self, wanted: &str) {
        assert_eq!(self.word(), wanted);
    }

    fn number<T: std::str::FromStr>(&mut self) -> T {
        let word = self.word();
        word.parse()
            .unwrap_or_else(|_| panic!("a number, not `{word}`"))
    }

    fn numbers<const N: usize>(&mut self) -> [f64; N] {
        [0; N].map(|_| self.number())
    }
}

fn from_columns([a, b, c, d]: [Vector; 4]) -> Matrix {
    let row = |i: usize| [a[i], b[i], c[i], d[i]];
    [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]
}

fn translation([x, y, z]: Vector) -> Matrix {
    from_columns([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [x, y, z]])
}

/// A turn in the plane of two axes, from `to`'s partner toward it: `(1, 0)` is about z, `(0, 2)` about y, `(2, 1)` about x.
fn turn(to: usize, from: usize, angle: f64) -> Matrix {
    let (sin, cos) = angle.sin_cos();
    let mut matrix = translation([0.0; 3]);
    matrix[from][from] = cos;
    matrix[to][to] = cos;
    matrix[to][from] = sin;
    matrix[from][to] = -sin;
    matrix
}

pub fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let mut c = [[0.0; 4]; 4];
    for (row, row_of_a) in c.iter_mut().zip(a) {
        for (column, entry) in row.iter_mut().enumerate() {
            *entry = (0..4).map(|k| row_of_a[k] * b[k][column]).sum();
        }
    }
    c
}

/// Minors with their signs of the upper left 3×3: `cofactor · n` is the normal that `matrix` takes a surface's normal to.
fn cofactors(matrix: &Matrix) -> [Vector; 3] {
    let minor = |row: usize, column: usize| {
        let [r, s] = [(row + 1) % 3, (row + 2) % 3];
        let [c, d] = [(column + 1) % 3, (column + 2) % 3];
        matrix[r][c] * matrix[s][d] - matrix[r][d] * matrix[s][c]
    };
    [0, 1, 2].map(|row| [0, 1, 2].map(|column| minor(row, column)))
}

/// Of an affine matrix.
pub fn inverse(matrix: &Matrix) -> Matrix {
    let cofactor = cofactors(matrix);
    let determinant: f64 = (0..3).map(|k| matrix[0][k] * cofactor[0][k]).sum();
    // The adjugate is the transpose of the cofactors.
    let column = |j: usize| [0, 1, 2].map(|i| cofactor[j][i] / determinant);
    let turned = from_columns([column(0), column(1), column(2), [0.0; 3]]);
    let back = [0, 1, 2].map(|i| -matrix[i][3]);
    product(&turned, &translation(back))
}

/// How short a normal may become against the blend before rounding in f32 turns it by more than [`Worst::NORMAL`]: f32 leaves
/// 1e-7 of the blend's square, so at this share a tenth of that tolerance.
const FLATTEST: f64 = 1e-3;

fn turned_normal(blend: &Matrix, [x, y, z]: Vector) -> Option<Vector> {
    let turned = cofactors(blend).map(|row| row[0] * x + row[1] * y + row[2] * z);
    let square: f64 = blend[..3]
        .iter()
        .flat_map(|row| &row[..3])
        .map(|e| e * e)
        .sum();
    (length(turned) > FLATTEST * square * length([x, y, z])).then(|| scaled(turned))
}

fn length(v: Vector) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn scaled(v: Vector) -> Vector {
    v.map(|x| x / length(v))
}

fn difference(a: Vector, b: Vector) -> Vector {
    [0, 1, 2].map(|i| a[i] - b[i])
}

/// The worst of all vertices, not a number counting as infinite.
#[derive(Debug, Clone, Copy, Default)]
pub struct Worst {
    /// Distance between positions, as a share of the rig's size or its largest coordinate, whichever is more.
    pub position: f64,
    /// Radians between normals.
    pub normal: f64,
    /// By how much a normal is not of unit length.
    pub length: f64,
    /// Normals that were not looked at.
    pub skipped: usize,
}

impl Worst {
    /// Eighty steps of float32 at the rig's size: a sum of a few dozen products loses less.
    pub const POSITION: f64 = 1e-5;
    /// A quarter of what one step of an 8-bit color can show.
    pub const NORMAL: f64 = 1e-3;
    /// Eighty steps of float32 as well: a dot product and an inverse square root lose less.
    pub const LENGTH: f64 = 1e-5;

    pub fn is_close(&self) -> bool {
        self.position <= Self::POSITION
            && self.normal <= Self::NORMAL
            && self.length <= Self::LENGTH
    }

    pub fn and(self, other: Self) -> Self {
        Self {
            position: worse(self.position, other.position),
            normal: worse(self.normal, other.normal),
            length: worse(self.length, other.length),
            skipped: self.skipped + other.skipped,
        }
    }
}

fn worse(a: f64, b: f64) -> f64 {
    if b.is_nan() { f64::INFINITY } else { a.max(b) }
}

/// Vertices by their place in the file, position and normal.
pub type Found = Vec<[[f32; 3]; 2]>;

pub fn compare(found: &[[[f32; 3]; 2]], wanted: &Skinned) -> Worst {
    assert_eq!(found.len(), wanted.positions.len(), "number of vertices");
    let (min, max) = wanted.positions.iter().fold(
        ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]),
        |(min, max), p| {
            (
                [0, 1, 2].map(|i| p[i].min(min[i])),
                [0, 1, 2].map(|i| p[i].max(max[i])),
            )
        },
    );
    let largest = min.iter().chain(&max).fold(0.0f64, |a, x| a.max(x.abs()));
    let size = length(difference(max, min)).max(largest);
    let mut worst = Worst::default();
    for (index, &vertex) in found.iter().enumerate() {
        let [position, normal] = vertex.map(|v| v.map(f64::from));
        let off = length(difference(position, wanted.positions[index])) / size;
        worst.position = worse(worst.position, off);
        worst.length = worse(worst.length, (length(normal) - 1.0).abs());
        match wanted.normals[index] {
            Some(wanted) => worst.normal = worse(worst.normal, angle(normal, wanted)),
            None => worst.skipped += 1,
        }
    }
    worst
}

fn angle(a: Vector, b: Vector) -> f64 {
    let cross = [0, 1, 2].map(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j] * b[k] - a[k] * b[j]
    });
    let dot: f64 = (0..3).map(|i| a[i] * b[i]).sum();
    // An arc cosine could not tell angles below 1e-8 apart, nor NaN from a right angle.
    length(cross).atan2(dot)
}

/// SplitMix64: the same numbers on every machine.
pub struct Random(pub u64);

impl Random {
    /// From `-most` to `most`.
    pub fn within(&mut self, most: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        bits ^= bits >> 31;
        ((bits >> 11) as f64 / (1u64 << 52) as f64 - 1.0) * most
    }
}
