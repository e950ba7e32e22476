//! What one picture needs until it is drawn, and where the vertices of each instance stand in it. Never lives here: projecting and drawing.

use super::bin::Chunk;
use super::instance::DrawnInstance;
use super::lines;
use super::project::Projected;
use super::skinned::Vertices;
use crate::render::order::PartPlace;
use crate::render::{Plan, SkeletonView};
use crate::scene::Scene;

/// What there is to draw.
#[derive(Clone, Copy)]
pub(super) struct Subject<'a> {
    pub plan: &'a Plan,
    pub scene: &'a Scene,
    /// The vertices of those instances whose skin is shown.
    pub skin: &'a Vertices,
}

/// Of the solids of all instances, in model space.
#[derive(Default)]
pub(super) struct SolidVertices {
    pub positions: Vec<[f32; 3]>,
    pub normals: Vec<[f32; 3]>,
}

/// What one picture needs until it is drawn.
#[derive(Default)]
pub(super) struct PictureScratch {
    pub instances: Vec<DrawnInstance>,
    pub solids: SolidVertices,
    pub projected: Vec<Projected>,
    pub line_corners: Vec<[f32; 4]>,
    pub line_triangles: Vec<[u32; 3]>,
    pub chunks: Vec<Chunk>,
    /// Parts that blend, in their order.
    pub blending: Vec<(f64, PartPlace)>,
}

impl PictureScratch {
    /// Says where the vertices of each instance stand, and lays out those of skeletons.
    pub(super) fn lay_out(&mut self, subject: Subject<'_>) {
        let Subject { plan, scene, skin } = subject;
        let Self {
            instances,
            solids: SolidVertices { positions, normals },
            projected,
            line_corners,
            line_triangles,
            ..
        } = self;
        instances.clear();
        positions.clear();
        normals.clear();
        line_corners.clear();
        line_triangles.clear();
        let mut skin_vertices = 0;
        for instance in &plan.instances {
            let mut drawn = DrawnInstance::of(instance, scene);
            if instance.shows_skin() {
                drawn.skin = skin.range_of(instance.skin()).unwrap_or_default();
            }
            drawn.first_projected = skin_vertices;
            skin_vertices += drawn.skin.len();
            let SkeletonView { lines, solids } = instance.skeleton();
            let (first_line, first_solid) = (line_corners.len() / lines::CORNERS, positions.len());
            lines::add(lines, &drawn.projection, line_corners, line_triangles);
            let of_solids = solids.vertices.iter();
            positions.extend(of_solids.clone().map(|vertex| vertex.position.to_array()));
            normals.extend(of_solids.map(|vertex| vertex.normal.to_array()));
            drawn.lines = first_line..first_line + lines.len();
            drawn.solids = first_solid..positions.len();
            instances.push(drawn);
        }
        let all = skin_vertices + positions.len() + line_corners.len();
        projected.resize(all, Projected::default());
    }
}
