//! What is drawn of skin, and in which order: into the base, or into the layer of a translucent skin.

use super::coats::Coats;
use super::pipelines::{Given, Kind, Variant};
use super::shade::Drawing;
use super::skin::SkinnedRig;
use super::upload::Dressing;
use super::wear::{Stretch, Wear};
use crate::render::Instance;
use crate::render::cull::{self, Culling};
use crate::render::order::PartPlace;
use crate::scene::Samples;
use std::ops::Range;

/// Triangles of one instance that are drawn alike.
pub(super) struct Draw<'a> {
    pub variant: Variant,
    /// Where the numbers of the instance are bound.
    pub params_offset: u32,
    pub place: &'a SkinnedRig<'a>,
    pub wear: &'a Wear,
    /// Where its coat is bound, if it wears one.
    pub coat: Option<u32>,
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
struct Dressed<'a> {
    index: usize,
    instance: &'a Instance,
    samples: Samples,
    params_offset: u32,
    place: &'a SkinnedRig<'a>,
    dressing: &'a Dressing,
    given: Given,
    /// By mesh.
    cullings: Vec<Culling>,
    /// By wear.
    coats: Vec<Option<u32>>,
}

impl<'a> Draws<'a> {
    /// `params_offset` says where the numbers of an instance are bound; `order` is that of the parts that blend.
    pub fn of(
        drawing: &Drawing<'a>,
        params_offset: impl Fn(usize) -> u32,
        order: &[(f64, PartPlace)],
        coats: &mut Coats,
    ) -> Self {
        let dressed = drawing.skins.iter().map(|&(index, place)| {
            let offset = params_offset(index);
            Dressed::new(drawing, index, place, offset, coats)
        });
        let dressed: Vec<Dressed<'a>> = dressed.collect();
        let mut draws = Self::default();
        for dressed in &dressed {
            for (stretch, indices) in &dressed.dressing.stretches {
                if dressed.instance.is_translucent() {
                    // Only the nearest of it is seen, whatever it is made of.
                    add(&mut draws.layer, dressed.draw(stretch, indices));
                } else if !stretch.blends {
                    add(&mut draws.base, dressed.draw(stretch, indices));
                }
            }
        }
        for (_, part) in order {
            // Nothing is there of an instance without triangles.
            let found = dressed.binary_search_by_key(&part.instance, |dressed| dressed.index);
            let Ok(found) = found else {
                continue;
            };
            let dressed = &dressed[found];
            for (stretch, indices) in dressed.dressing.blending(part.mesh, part.part) {
                add(&mut draws.base, dressed.draw(stretch, indices));
            }
        }
        draws
    }

    pub fn iter(&self) -> impl Iterator<Item = &Draw<'a>> {
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

impl<'a> Dressed<'a> {
    fn new(
        drawing: &Drawing<'a>,
        index: usize,
        place: &'a SkinnedRig<'a>,
        params_offset: u32,
        coats: &mut Coats,
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
        let dressing = place.rig.dressing(surface.variant);
        // What other variants wear needs no coat.
        let mut of_wears = vec![None; place.rig.wears.len()];
        for (stretch, _) in &dressing.stretches {
            let of_wear = &mut of_wears[stretch.wear];
            if of_wear.is_none() {
                let coat = place.rig.wears[stretch.wear].coat(rig, surface);
                *of_wear = coat.map(|coat| coats.add(&coat));
            }
        }
        Self {
            index,
            instance,
            samples: drawing.scene.samples,
            params_offset,
            place,
            dressing,
            given: Given {
                texcoords: place.rig.texcoords.is_some(),
                colors: place.rig.colors.is_some(),
            },
            cullings: cullings.collect(),
            coats: of_wears,
        }
    }

    fn draw(&self, stretch: &Stretch, indices: &Range<u32>) -> Draw<'a> {
        let wear = &self.place.rig.wears[stretch.wear];
        let part = &self.instance.rig().meshes()[stretch.mesh].parts()[stretch.part];
        Draw {
            variant: Variant {
                kind: match wear {
                    Wear::Plain => Kind::Skin,
                    Wear::Textured(_) => Kind::TexturedSkin,
                    Wear::Coated { .. } => Kind::CoatedSkin(self.given),
                },
                samples: self.samples,
                culled: self.cullings[stretch.mesh]
                    .pieces(part)
                    .find(|piece| piece.triangles.contains(&stretch.triangles.start))
                    .and_then(|piece| piece.culled),
                blends: stretch.blends && !self.instance.is_translucent(),
            },
            params_offset: self.params_offset,
            place: self.place,
            wear,
            coat: self.coats[stretch.wear],
            indices: indices.clone(),
        }
    }
}

impl Draw<'_> {
    fn goes_on_in(&self, next: &Self) -> bool {
        self.params_offset == next.params_offset
            && std::ptr::eq(self.wear, next.wear)
            && self.variant == next.variant
            && self.indices.end == next.indices.start
    }
}
