//! Skinned vertices, to be drawn from any number of times. Never lives here: how a vertex is skinned.

use super::room::Lent;
use super::skin::SkinJob;
use super::{Cpu, Spread};
use crate::render::Instance;
use crate::rig::Mesh;
use std::ops::Range;

/// Every vertex of some instances. Its memory goes back to the renderer.
pub struct Skinned(Lent<Vertices>);

/// Of all meshes of all instances, one after another.
#[derive(Default)]
pub(super) struct Vertices {
    pub positions: Vec<[f32; 3]>,
    pub normals: Vec<[f32; 3]>,
}

impl Skinned {
    pub(super) fn vertices(&self) -> &Vertices {
        &self.0
    }
}

impl Cpu {
    /// `None` where it was no longer wanted.
    pub fn skin(&self, instances: &[Instance], spread: Spread<'_>) -> Option<Skinned> {
        let mut vertices = self.skins.take();
        let all = meshes(instances)
            .map(|(_, _, mesh)| mesh.draw_vertex_count())
            .sum();
        let Vertices { positions, normals } = &mut *vertices;
        positions.resize(all, [0.0; 3]);
        normals.resize(all, [0.0; 3]);
        for (_, instance, mesh, own) in in_order(instances) {
            self.skin_range(
                &SkinJob::new(instance, mesh),
                0,
                &mut positions[own.clone()],
                Some(&mut normals[own]),
                spread,
            );
        }
        spread.is_wanted().then_some(Skinned(vertices))
    }
}

/// Each with the indices of both.
fn meshes(instances: &[Instance]) -> impl Iterator<Item = ([usize; 2], &Instance, &Mesh)> {
    let instances = instances.iter().enumerate();
    instances.flat_map(|(instance, of_plan)| {
        let meshes = of_plan.rig().meshes().iter().enumerate();
        meshes.map(move |(mesh, of_rig)| ([instance, mesh], of_plan, of_rig))
    })
}

/// Each mesh of each instance, with the indices of both, and which of the vertices are its own.
pub(super) fn in_order(
    instances: &[Instance],
) -> impl Iterator<Item = ([usize; 2], &Instance, &Mesh, Range<usize>)> {
    let mut first = 0;
    meshes(instances).map(move |(at, instance, mesh)| {
        let own = first..first + mesh.draw_vertex_count();
        first = own.end;
        (at, instance, mesh, own)
    })
}
