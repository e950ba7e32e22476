//! Stage 1 in f32, the twin of `shaders/skin*.wgsl`; the rules stand in [`Plan`](crate::render::Plan)'s module.

use crate::pose::{Palette, SkinDualQuaternion, SkinMatrix};
use crate::rig::{Influence, Mesh};
use glam::{Vec3, Vec4};

/// A vertex in world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SkinnedVertex {
    pub position: Vec3,
    /// Unit length.
    pub normal: Vec3,
}

/// Every vertex of `mesh`, in its own order. `palette` and `morph_weights` are of the mesh's rig.
pub fn skin_mesh<'a>(
    mesh: &'a Mesh,
    palette: &'a Palette,
    morph_weights: &'a [f32],
) -> impl Iterator<Item = SkinnedVertex> + 'a {
    (0..mesh.vertex_count()).map(move |vertex| {
        let bound = morphed(mesh, vertex, morph_weights);
        let influences = mesh.influences_of(vertex);
        match palette {
            Palette::Linear(matrices) => linear(bound, influences, matrices),
            Palette::DualQuaternion(entries) => dual_quaternion(bound, influences, entries),
        }
    })
}

/// In bind space, the normal brought back to unit length.
fn morphed(mesh: &Mesh, vertex: usize, weights: &[f32]) -> SkinnedVertex {
    let (position, normal) = (mesh.positions()[vertex], mesh.normals()[vertex]);
    let displacements = mesh.morph_displacements_of(vertex);
    if displacements.is_empty() {
        return SkinnedVertex { position, normal };
    }
    let sums = (position, normal);
    let (position, turned) = displacements
        .iter()
        .fold(sums, |(position, turned), moved| {
            let weight = weights[moved.morph as usize];
            (
                position + moved.position * weight,
                turned + moved.normal * weight,
            )
        });
    SkinnedVertex {
        position,
        normal: turned.normalize_or(normal),
    }
}

fn linear(bound: SkinnedVertex, influences: &[Influence], palette: &[SkinMatrix]) -> SkinnedVertex {
    let rows = influences.iter().fold([Vec4::ZERO; 3], |sums, influence| {
        let SkinMatrix { rows } = palette[influence.binding as usize];
        blended(sums, rows, influence.weight)
    });
    let position = bound.position.extend(1.0);
    SkinnedVertex {
        position: rows.map(|row| row.dot(position)).into(),
        normal: cofactor_transform(rows, bound.normal).normalize_or(bound.normal),
    }
}

fn dual_quaternion(
    bound: SkinnedVertex,
    influences: &[Influence],
    palette: &[SkinDualQuaternion],
) -> SkinnedVertex {
    let of = |influence: &Influence| palette[influence.binding as usize];
    let pivot = influences
        .first()
        .map_or(Vec4::W, |heaviest| of(heaviest).real);
    let (mut real, mut dual, mut stretch) = (Vec4::ZERO, Vec4::ZERO, [Vec4::ZERO; 3]);
    for influence in influences {
        let entry = of(influence);
        let weight = influence.weight;
        // Either sign is the same rotation; of the two ways to the heaviest one's the shorter is meant.
        let signed = if pivot.dot(entry.real) < 0.0 {
            -weight
        } else {
            weight
        };
        real += entry.real * signed;
        dual += entry.dual * signed;
        stretch = blended(stretch, entry.stretch, weight);
    }
    let length = real.length();
    let (real, dual) = (real / length, dual / length);
    let (axis, moved) = (real.truncate(), dual.truncate());
    let turned = |v: Vec3| v + 2.0 * axis.cross(axis.cross(v) + real.w * v);
    let translation = 2.0 * (real.w * moved - dual.w * axis + axis.cross(moved));
    let stretched = stretch.map(|row| row.truncate().dot(bound.position));
    let normal = cofactor_transform(stretch, bound.normal).normalize_or(bound.normal);
    SkinnedVertex {
        position: turned(stretched.into()) + translation,
        normal: turned(normal).normalize_or(bound.normal),
    }
}

fn blended(sums: [Vec4; 3], rows: [Vec4; 3], weight: f32) -> [Vec4; 3] {
    [0, 1, 2].map(|i| sums[i] + rows[i] * weight)
}

/// By the matrix whose columns are the cross products of those of the one with these rows.
fn cofactor_transform([x, y, z]: [Vec4; 3], normal: Vec3) -> Vec3 {
    let [a, b, c] = [0, 1, 2].map(|i| Vec3::new(x[i], y[i], z[i]));
    b.cross(c) * normal.x + c.cross(a) * normal.y + a.cross(b) * normal.z
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_stay_perpendicular_under_non_uniform_scale() {
        let rows = [Vec4::X * 3.0, Vec4::Y * 0.5, Vec4::Z];
        // A plane with normal (1, 1, 0) holds the tangent (1, -1, 0), which the matrix takes to (3, -0.5, 0).
        let normal = cofactor_transform(rows, Vec3::new(1.0, 1.0, 0.0));
        assert!(normal.dot(Vec3::new(3.0, -0.5, 0.0)).abs() < 1e-6);
        assert!(normal.dot(Vec3::new(1.0, 1.0, 0.0)) > 0.0);
    }
}
