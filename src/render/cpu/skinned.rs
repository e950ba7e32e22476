//! Skinned vertices, to be drawn and copied from any number of times. Never lives here: how a vertex is skinned.

use super::skin::SkinJob;
use super::{Cpu, Parallelism};
use crate::frame::Pooled;
use crate::render::{Plan, Skin};
use crate::rig::Mesh;
use std::ops::Range;

/// Every draw vertex of some skins, in model space. Its memory goes back to the renderer.
pub struct Skinned(Pooled<Vertices>);

/// Of all meshes of all skins, one after another.
#[derive(Default)]
pub(super) struct Vertices {
    pub positions: Vec<[f32; 3]>,
    pub normals: Vec<[f32; 3]>,
    /// Distinct, each with the vertices that are its own.
    skins: Vec<(Skin, Range<usize>)>,
}

impl Skinned {
    pub(super) fn vertices(&self) -> &Vertices {
        &self.0
    }
}

impl Drop for Skinned {
    fn drop(&mut self) {
        // The memory is kept; the rigs are not.
        self.0.skins.clear();
    }
}

impl Vertices {
    /// Which of them are those of a skin.
    pub(super) fn range_of(&self, skin: &Skin) -> Option<Range<usize>> {
        let mut skins = self.skins.iter();
        let found = skins.find(|(other, _)| other == skin)?;
        Some(found.1.clone())
    }
}

impl Cpu {
    /// The [skins](Plan::drawn_skins) that the picture of a plan shows. `None` where it was cancelled.
    pub fn skin(&self, plan: &Plan, parallelism: Parallelism<'_>) -> Option<Skinned> {
        let mut skinned = Skinned(self.skins.take());
        let Vertices {
            positions,
            normals,
            skins,
        } = &mut *skinned.0;
        let mut count = 0;
        for skin in plan.drawn_skins() {
            let own = count..count + skin.rig().draw_vertex_count();
            count = own.end;
            skins.push((skin.clone(), own));
        }
        positions.resize(count, [0.0; 3]);
        normals.resize(count, [0.0; 3]);
        for (skin, own) in skins {
            for (mesh, own) in meshes(skin, own.start) {
                self.skin_range(
                    &SkinJob::new(skin, mesh),
                    0,
                    &mut positions[own.clone()],
                    Some(&mut normals[own]),
                    parallelism,
                );
            }
        }
        (!parallelism.is_cancelled()).then_some(skinned)
    }
}

/// Each mesh of a skin, with which vertices are its own where those of the skin start at `first`.
pub(super) fn meshes(skin: &Skin, mut first: usize) -> impl Iterator<Item = (&Mesh, Range<usize>)> {
    skin.rig().meshes().iter().map(move |mesh| {
        let own = first..first + mesh.draw_vertex_count();
        first = own.end;
        (mesh, own)
    })
}
