//! What is drawn of skin, and in which order: into the base, or into the layer of a translucent skin.

use super::draw_list::{DrawRange, MaterialBinding};
use super::material_buffer::MaterialBuffer;
use super::pipelines::{Given, Kind, Variant};
use super::skin::SkinnedRig;
use super::upload::VariantDraws;
use crate::render::cull::{self, Culling};
use crate::render::order::PartPlace;
use crate::render::{Instance, Plan};
use crate::scene::{Samples, Scene};
use std::ops::Range;

/// The picture of `plan`, and the skin in it.
pub(super) struct Drawing<'a> {
    pub plan: &'a Plan,
    pub scene: &'a Scene,
    /// Of the instances that have skin to be drawn, by their index in the plan.
    pub skins: Vec<(usize, &'a SkinnedRig<'a>)>,
}

/// Triangles of one instance that are drawn alike.
pub(super) struct Draw<'a> {
    pub variant: Variant,
    /// Where the numbers of the instance are bound.
    pub params_offset: u32,
    pub place: &'a SkinnedRig<'a>,
    pub binding: &'a MaterialBinding,
    /// Where the parameters of its material are bound, if it has any.
    pub material_offset: Option<u32>,
    pub indices: Range<u32>,
}

/// Those of one picture.
#[derive(Default)]
pub(super) struct Draws<'a> {
    /// What takes the place of what is behind, then what blends.
    pub base: Vec<Draw<'a>>,
    pub layer: Vec<Draw<'a>>,
}

/// An instance as a picture shows it.
struct InstanceDraws<'a> {
    index: usize,
    instance: &'a Instance,
    samples: Samples,
    params_offset: u32,
    place: &'a SkinnedRig<'a>,
    variant: &'a VariantDraws,
    given: Given,
    /// By mesh.
    cullings: Vec<Culling>,
    /// By binding.
    material_offsets: Vec<Option<u32>>,
}

impl<'a> Draws<'a> {
    /// `params_offset` says where the numbers of an instance are bound; `order` is that of the parts that blend.
    pub(super) fn of(
        drawing: &Drawing<'a>,
        params_offset: impl Fn(usize) -> u32,
        order: &[(f64, PartPlace)],
        materials: &mut MaterialBuffer,
    ) -> Self {
        let instances = drawing.skins.iter().map(|&(index, place)| {
            let offset = params_offset(index);
            InstanceDraws::new(drawing, index, place, offset, materials)
        });
        let instances: Vec<InstanceDraws<'a>> = instances.collect();
        let mut draws = Self::default();
        for drawn in &instances {
            for (range, indices) in &drawn.variant.ranges {
                if drawn.instance.is_translucent() {
                    // Only the nearest of it is seen, whatever it is made of.
                    add(&mut draws.layer, drawn.draw(range, indices));
                } else if !range.blends {
                    add(&mut draws.base, drawn.draw(range, indices));
                }
            }
        }
        for (_, part) in order {
            // An instance without triangles has no draws.
            let found = instances.binary_search_by_key(&part.instance, |drawn| drawn.index);
            let Ok(found) = found else {
                continue;
            };
            let drawn = &instances[found];
            for (range, indices) in drawn.variant.blending(part.mesh, part.part) {
                add(&mut draws.base, drawn.draw(range, indices));
            }
        }
        draws
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Draw<'a>> {
        self.base.iter().chain(&self.layer)
    }
}

/// Neighbours in the rig's own order that are drawn alike, one after the other, become one.
fn add<'a>(draws: &mut Vec<Draw<'a>>, draw: Draw<'a>) {
    match draws.last_mut() {
        Some(last) if last.goes_on_in(&draw) => last.indices.end = draw.indices.end,
        _ => draws.push(draw),
    }
}

impl<'a> InstanceDraws<'a> {
    fn new(
        drawing: &Drawing<'a>,
        index: usize,
        place: &'a SkinnedRig<'a>,
        params_offset: u32,
        materials: &mut MaterialBuffer,
    ) -> Self {
        // Indices count from the rig's first vertex.
        debug_assert_eq!(place.first_vertex, 0, "pictures skin all of a rig");
        let instance = &drawing.plan.instances[index];
        let rig = instance.rig();
        let cullings = rig.meshes().iter().map(|mesh| {
            let reach = cull::reach(instance.skin(), mesh);
            Culling::of(instance, mesh, &drawing.scene.camera, reach)
        });
        let surface = &instance.appearance().surface;
        let variant = place.rig.variant(surface.variant);
        // Materials of other variants are left out.
        let mut material_offsets = vec![None; place.rig.bindings.len()];
        for (range, _) in &variant.ranges {
            let offset = &mut material_offsets[range.binding];
            if offset.is_none() {
                let params = place.rig.bindings[range.binding].params(rig, surface);
                *offset = params.map(|params| materials.add(&params));
            }
        }
        Self {
            index,
            instance,
            samples: drawing.scene.samples,
            params_offset,
            place,
            variant,
            given: Given {
                texcoords: place.rig.texcoords.is_some(),
                colors: place.rig.colors.is_some(),
            },
            cullings: cullings.collect(),
            material_offsets,
        }
    }

    fn draw(&self, range: &DrawRange, indices: &Range<u32>) -> Draw<'a> {
        let binding = &self.place.rig.bindings[range.binding];
        let part = &self.instance.rig().meshes()[range.mesh].parts()[range.part];
        Draw {
            variant: Variant {
                kind: match binding {
                    MaterialBinding::Plain => Kind::Skin,
                    MaterialBinding::Textured(_) => Kind::TexturedSkin,
                    MaterialBinding::Full { .. } => Kind::MaterialSkin(self.given),
                },
                samples: self.samples,
                culled: self.cullings[range.mesh]
                    .pieces(part)
                    .find(|piece| piece.triangles.contains(&range.triangles.start))
                    .and_then(|piece| piece.culled),
                blends: range.blends && !self.instance.is_translucent(),
            },
            params_offset: self.params_offset,
            place: self.place,
            binding,
            material_offset: self.material_offsets[range.binding],
            indices: indices.clone(),
        }
    }
}

impl Draw<'_> {
    fn goes_on_in(&self, next: &Self) -> bool {
        self.params_offset == next.params_offset
            && std::ptr::eq(self.binding, next.binding)
            && self.variant == next.variant
            && self.indices.end == next.indices.start
    }
}
