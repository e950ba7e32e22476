//! Where an instance stands and what its surface is, as numbers of 32 bits, which both renderers read. It mirrors `InstanceParams` in
//! `shaders/common.wgsl`; a test beside the other mirrors compares every offset. Never lives here: materials of the file.

use super::Instance;
use crate::scene::{Camera, Color, ShowNormals, Surface};
use bytemuck::{Pod, Zeroable};
use glam::{DMat3, Mat4, Vec3, Vec4};

/// Colors are linear RGB.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct InstanceParams {
    pub clip_from_model: Mat4,
    /// Rows of the affine map.
    pub world_from_model: [Vec4; 3],
    /// Rows of the map of normals, its cofactor matrix without the scale; the fourth numbers are 0.
    pub world_from_model_normal: [Vec4; 3],
    pub diffuse: Vec3,
    pub opacity: f32,
    pub specular: Vec3,
    pub shininess: f32,
    /// What textures are multiplied by.
    pub textured_diffuse: Vec3,
    /// 1: each triangle is lit by its own normal.
    pub flat_normals: u32,
    /// Smallest squared distance that an inverse-square light is divided by.
    pub least_distance_squared: f32,
    _padding: [f32; 3],
}

impl InstanceParams {
    pub(super) fn of(instance: &Instance, camera: &Camera) -> Self {
        let world_from_model = instance.world_from_model();
        let affine = world_from_model.matrix3.transpose();
        let offset = world_from_model.translation;
        let normal = cofactors(world_from_model.matrix3).transpose();
        let appearance = instance.appearance();
        let surface = &appearance.surface;
        Self {
            clip_from_model: instance.clip_from_model(camera.clip_from_world()).as_mat4(),
            world_from_model: [
                affine.x_axis.extend(offset.x).as_vec4(),
                affine.y_axis.extend(offset.y).as_vec4(),
                affine.z_axis.extend(offset.z).as_vec4(),
            ],
            world_from_model_normal: [
                normal.x_axis.extend(0.0).as_vec4(),
                normal.y_axis.extend(0.0).as_vec4(),
                normal.z_axis.extend(0.0).as_vec4(),
            ],
            diffuse: surface.diffuse.unwrap_or(Surface::DIFFUSE).rgb(),
            opacity: appearance.show.skin_opacity(),
            specular: surface.specular.unwrap_or(Surface::SPECULAR).rgb(),
            shininess: surface.shininess.unwrap_or(Surface::SHININESS),
            // A texture has the color already.
            textured_diffuse: surface.diffuse.unwrap_or(Color::WHITE).rgb(),
            flat_normals: u32::from(appearance.show.normals == ShowNormals::Flat),
            least_distance_squared: instance.least_distance_squared(),
            _padding: [0.0; 3],
        }
    }
}

/// The cofactor matrix over the square of the matrix's mean scale: of a rotation and a uniform scale it is the rotation.
fn cofactors(matrix: DMat3) -> DMat3 {
    let DMat3 {
        x_axis: x,
        y_axis: y,
        z_axis: z,
    } = matrix;
    let scale = libm::cbrt(matrix.determinant());
    DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * (1.0 / (scale * scale))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn normals_turn_with_rotations_and_over_with_mirrors() {
        let turned = DMat3::from_rotation_y(0.7);
        for scale in [1e-3, 1.0, 1e3] {
            let found = cofactors(turned * scale);
            assert!(found.abs_diff_eq(turned, 1e-12), "{found}");
        }
        let mirrored = cofactors(DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0)));
        // The cofactors of a mirror turn normals over, with the winding.
        assert_eq!(mirrored * DVec3::Y, DVec3::NEG_Y);
        assert_eq!(cofactors(DMat3::IDENTITY), DMat3::IDENTITY);
    }

    #[test]
    fn a_normal_stays_perpendicular_to_a_squeezed_surface() {
        let squeezed =
            DMat3::from_diagonal(DVec3::new(2.0, 0.25, 1.0)) * DMat3::from_rotation_z(0.4);
        let (along, normal) = (DVec3::new(1.0, 1.0, 0.0), DVec3::new(1.0, -1.0, 0.0));
        let dot = (squeezed * along).dot(cofactors(squeezed) * normal);
        assert!(dot.abs() < 1e-12, "{dot}");
    }
}
