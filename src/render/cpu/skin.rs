//! Stage 1 in f32, the twin of `shaders/skin.wgsl`; the rules stand in [`Plan`](crate::render::Plan)'s module.

use crate::pose::{Palette, SkinMatrix};
use crate::rig::{Influence, Mesh};
use glam::{Vec3, Vec4};

/// A vertex in world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SkinnedVertex {
    pub position: Vec3,
    /// Unit length.
    pub normal: Vec3,
}

/// Every vertex of `mesh`, in its own order. `palette` is of the mesh's rig.
pub fn skin_mesh<'a>(
    mesh: &'a Mesh,
    palette: &'a Palette,
) -> impl Iterator<Item = SkinnedVertex> + 'a {
    (0..mesh.vertex_count()).map(|vertex| {
        let [x, y, z] = blend(mesh.influences_of(vertex), palette.matrices());
        let position = mesh.positions()[vertex].extend(1.0);
        let bind_normal = mesh.normals()[vertex];
        let columns = [0, 1, 2].map(|i| Vec3::new(x[i], y[i], z[i]));
        SkinnedVertex {
            position: Vec3::new(x.dot(position), y.dot(position), z.dot(position)),
            normal: cofactor_transform(columns, bind_normal).normalize_or(bind_normal),
        }
    })
}

/// The rows of the blended matrix.
fn blend(influences: &[Influence], palette: &[SkinMatrix]) -> [Vec4; 3] {
    influences
        .iter()
        .fold([Vec4::ZERO; 3], |[x, y, z], influence| {
            let SkinMatrix { rows } = palette[influence.binding as usize];
            let weight = influence.weight;
            [
                x + rows[0] * weight,
                y + rows[1] * weight,
                z + rows[2] * weight,
            ]
        })
}

fn cofactor_transform([a, b, c]: [Vec3; 3], normal: Vec3) -> Vec3 {
    b.cross(c) * normal.x + c.cross(a) * normal.y + a.cross(b) * normal.z
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_stay_perpendicular_under_non_uniform_scale() {
        let columns = [Vec3::X * 3.0, Vec3::Y * 0.5, Vec3::Z];
        // A plane with normal (1, 1, 0) holds the tangent (1, -1, 0), which the matrix takes to (3, -0.5, 0).
        let normal = cofactor_transform(columns, Vec3::new(1.0, 1.0, 0.0));
        assert!(normal.dot(Vec3::new(3.0, -0.5, 0.0)).abs() < 1e-6);
        assert!(normal.dot(Vec3::new(1.0, 1.0, 0.0)) > 0.0);
    }
}
