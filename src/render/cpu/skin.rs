//! Stage 1, skin: in parity with `shaders/skin*.wgsl`; the rules stand in [`Plan`](crate::render::Plan)'s module. Influences are blended
//! one vertex after another, four numbers of a row at a time; what comes out is turned over to as many vertices at a time as there are lanes.

use super::lanes::{LANES, Lanes, Vectors, transposed};
use crate::pose::Palette;
use crate::rig::{Influence, Mesh};
use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch, f32x4};
use glam::Vec4;

/// Positions and unit normals in model space, of every draw vertex of `mesh` in its own order. `palette` and `morph_weights` are of its rig.
pub fn skin_mesh(
    mesh: &Mesh,
    palette: &Palette,
    morph_weights: &[f32],
) -> (Vec<[f32; 3]>, Vec<[f32; 3]>) {
    let mut positions = vec![[0.0; 3]; mesh.draw_vertex_count()];
    let mut normals = positions.clone();
    let job = SkinJob {
        mesh,
        palette,
        morph_weights,
    };
    job.run(Level::new(), 0, &mut positions, Some(&mut normals));
    (positions, normals)
}

/// What the vertices of one mesh follow.
#[derive(Clone, Copy)]
pub(super) struct SkinJob<'a> {
    pub mesh: &'a Mesh,
    pub palette: &'a Palette,
    pub morph_weights: &'a [f32],
}

impl SkinJob<'_> {
    /// As many vertices as there is room for, from the `first` on. Normals that are not asked for are not worked out.
    pub(super) fn run(
        &self,
        level: Level,
        first: usize,
        positions: &mut [[f32; 3]],
        normals: Option<&mut [[f32; 3]]>,
    ) {
        dispatch!(level, simd => match normals {
            Some(normals) => self.skin::<_, true>(simd, first, positions, normals),
            None => self.skin::<_, false>(simd, first, positions, &mut []),
        });
    }

    #[inline(always)]
    fn skin<S: Simd, const NORMALS: bool>(
        &self,
        simd: S,
        first: usize,
        positions: &mut [[f32; 3]],
        normals: &mut [[f32; 3]],
    ) {
        let end = first + positions.len();
        let mut normals = normals.chunks_mut(LANES);
        let groups = positions.chunks_mut(LANES);
        for (first, positions) in (first..end).step_by(LANES).zip(groups) {
            // Of a last group that is not full, lanes repeat its last vertex.
            let vertices = std::array::from_fn(|lane| (first + lane).min(end - 1));
            let bound = self.morphed(simd, vertices);
            let skinned = match self.palette {
                Palette::Linear(_) => linear(bound, self.blended::<S, 3, 0>(simd, vertices)),
                Palette::DualQuaternion(_) => {
                    dual_quaternion(bound, self.blended::<S, 5, 2>(simd, vertices))
                }
            };
            skinned.position.store(positions);
            if NORMALS && let Some(normals) = normals.next() {
                skinned.normal.store(normals);
            }
        }
    }

    /// In bind space, normals of unit length.
    #[inline(always)]
    fn morphed<S: Simd>(&self, simd: S, vertices: [usize; LANES]) -> Vertices<S> {
        let mesh = self.mesh;
        let modelled = vertices.map(|vertex| mesh.normals()[vertex].to_array());
        let mut positions = vertices.map(|vertex| mesh.positions()[vertex].to_array());
        if mesh.morph_displacements().is_empty() {
            return Vertices {
                position: Vectors::load(simd, &positions),
                normal: Vectors::load(simd, &modelled),
            };
        }
        let mut normals = modelled;
        for lane in 0..LANES {
            for moved in mesh.morph_displacements_of(vertices[lane]) {
                let weight = self.morph_weights[moved.morph as usize];
                for axis in 0..3 {
                    positions[lane][axis] += moved.position[axis] * weight;
                    normals[lane][axis] += moved.normal[axis] * weight;
                }
            }
        }
        let modelled = Vectors::load(simd, &modelled);
        Vertices {
            position: Vectors::load(simd, &positions),
            normal: Vectors::load(simd, &normals).unit_or(modelled),
        }
    }

    /// The mean of the palette's entries that each vertex follows, by weight: `ROWS` rows of four columns. The first `SIGNED` rows are
    /// quaternions, whose signs follow those of the first influence, the heaviest.
    #[inline(always)]
    fn blended<S: Simd, const ROWS: usize, const SIGNED: usize>(
        &self,
        simd: S,
        vertices: [usize; LANES],
    ) -> [[Lanes<S>; 4]; ROWS] {
        let rows = self.palette.rows();
        let mut of_lanes = [[f32x4::splat(simd, 0.0); LANES]; ROWS];
        for (lane, vertex) in vertices.into_iter().enumerate() {
            let influences = self.mesh.influences_of(vertex);
            // Never without: a vertex that follows nothing follows the world.
            let pivot = entry::<ROWS>(rows, &influences[0])[0];
            let mut sums = [f32x4::splat(simd, 0.0); ROWS];
            for influence in influences {
                let entry = entry::<ROWS>(rows, influence);
                let weight = influence.weight;
                // Either sign is the same rotation; of the two ways to the heaviest one's the shorter is meant.
                let is_opposite = SIGNED > 0 && pivot.dot(entry[0]) < 0.0;
                let signed = if is_opposite { -weight } else { weight };
                for row in 0..ROWS {
                    let weight = if row < SIGNED { signed } else { weight };
                    sums[row] += f32x4::load_array(simd, entry[row].to_array()) * weight;
                }
            }
            for row in 0..ROWS {
                of_lanes[row][lane] = sums[row];
            }
        }
        let mut blended = [[Lanes::splat(simd, 0.0); 4]; ROWS];
        for row in 0..ROWS {
            blended[row] = transposed(of_lanes[row]);
        }
        blended
    }
}

/// The rows of the palette that an influence points at.
#[inline(always)]
fn entry<'a, const ROWS: usize>(rows: &'a [Vec4], influence: &Influence) -> &'a [Vec4; ROWS] {
    &rows.as_chunks::<ROWS>().0[influence.binding as usize]
}

/// As many vertices as there are lanes.
#[derive(Clone, Copy)]
struct Vertices<S: Simd> {
    position: Vectors<S>,
    normal: Vectors<S>,
}

/// `rows` are those of the blended `model_from_bind`.
#[inline(always)]
fn linear<S: Simd>(bound: Vertices<S>, rows: [[Lanes<S>; 4]; 3]) -> Vertices<S> {
    let [x, y, z] = rows;
    Vertices {
        position: Vectors {
            x: first_three(x).dot(bound.position) + x[3],
            y: first_three(y).dot(bound.position) + y[3],
            z: first_three(z).dot(bound.position) + z[3],
        },
        normal: cofactor_transform(rows, bound.normal).unit_or(bound.normal),
    }
}

/// The motion's real and dual part, then the rows of the stretch before it.
#[inline(always)]
fn dual_quaternion<S: Simd>(bound: Vertices<S>, blended: [[Lanes<S>; 4]; 5]) -> Vertices<S> {
    let [real, dual, x, y, z] = blended;
    let length =
        (real[0] * real[0] + real[1] * real[1] + real[2] * real[2] + real[3] * real[3]).sqrt();
    let shrink = 1.0 / length;
    let (axis, moved) = (
        first_three(real).times(shrink),
        first_three(dual).times(shrink),
    );
    let (real_w, dual_w) = (real[3] * shrink, dual[3] * shrink);
    let translation = moved
        .times(real_w)
        .minus(axis.times(dual_w))
        .plus(axis.cross(moved));
    let stretched = Vectors {
        x: first_three(x).dot(bound.position),
        y: first_three(y).dot(bound.position),
        z: first_three(z).dot(bound.position),
    };
    let normal = cofactor_transform([x, y, z], bound.normal).unit_or(bound.normal);
    Vertices {
        position: turned(axis, real_w, stretched).plus(translation.plus(translation)),
        normal: turned(axis, real_w, normal).unit_or(bound.normal),
    }
}

/// By a unit quaternion.
#[inline(always)]
fn turned<S: Simd>(axis: Vectors<S>, w: Lanes<S>, v: Vectors<S>) -> Vectors<S> {
    let half = axis.cross(axis.cross(v).plus(v.times(w)));
    v.plus(half.plus(half))
}

#[inline(always)]
fn first_three<S: Simd>([x, y, z, _]: [Lanes<S>; 4]) -> Vectors<S> {
    Vectors { x, y, z }
}

/// By the matrix whose columns are the cross products of those of the one with these rows.
#[inline(always)]
fn cofactor_transform<S: Simd>([x, y, z]: [[Lanes<S>; 4]; 3], normal: Vectors<S>) -> Vectors<S> {
    let [a, b, c] = [
        Vectors {
            x: x[0],
            y: y[0],
            z: z[0],
        },
        Vectors {
            x: x[1],
            y: y[1],
            z: z[1],
        },
        Vectors {
            x: x[2],
            y: y[2],
            z: z[2],
        },
    ];
    let (of_x, of_y, of_z) = (b.cross(c), c.cross(a), a.cross(b));
    of_x.times(normal.x)
        .plus(of_y.times(normal.y))
        .plus(of_z.times(normal.z))
}
