//! An instance of a plan as the stages read it: its numbers, its way onto the picture, and where its vertices stand.
//! Never lives here: its surfaces.

use super::project::Projection;
use crate::render::Instance;
use crate::render::instance_params::InstanceParams;
use crate::scene::Scene;
use glam::DAffine3;
use std::ops::Range;

/// Vertices are in model space.
pub(super) struct DrawnInstance {
    pub params: InstanceParams,
    pub projection: Projection,
    /// Whether the world is another space than the model's.
    is_placed: bool,
    /// Its own among the skinned vertices; none where no skin is shown.
    pub skin: Range<usize>,
    /// Where its skin starts among all that is projected.
    pub first_projected: usize,
    /// Its own among the vertices of all solids.
    pub solids: Range<usize>,
    /// Its own among the lines of all instances.
    pub lines: Range<usize>,
}

impl DrawnInstance {
    /// Without vertices yet.
    pub(super) fn of(instance: &Instance, scene: &Scene) -> Self {
        let params = InstanceParams::of(instance, &scene.camera);
        Self {
            projection: Projection::new(params.clip_from_model, scene.size),
            is_placed: instance.world_from_model() != DAffine3::IDENTITY,
            params,
            skin: 0..0,
            first_projected: 0,
            solids: 0..0,
            lines: 0..0,
        }
    }

    /// Of a position of the model.
    #[inline(always)]
    pub(super) fn position_in_world(&self, position: [f32; 3]) -> [f32; 3] {
        if self.is_placed {
            let [x, y, z] = position;
            let rows = self.params.world_from_model;
            rows.map(|row| row.x * x + row.y * y + row.z * z + row.w)
        } else {
            position
        }
    }

    /// Of a normal of the model, of any length.
    #[inline(always)]
    pub(super) fn normal_in_world(&self, normal: [f32; 3]) -> [f32; 3] {
        if self.is_placed {
            let [x, y, z] = normal;
            let rows = self.params.world_from_model_normal;
            rows.map(|row| row.x * x + row.y * y + row.z * z)
        } else {
            normal
        }
    }
}
