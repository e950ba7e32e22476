//! From samples to fragments: what each pixel of a block shows, once for each triangle, ready to be shaded.
//! Never lives here: light.

use super::context::PictureContext;
use super::geometry::Paint;
use super::interpolate::Planes;
use super::material::{MaterialTriangle, Texcoords};
use super::samples::{BLOCK, EIGHTHS, NONE};
use super::shade::{Fragment, Fragments, MaterialSample};
use super::texture;
use super::triangle::side;
use crate::render::cull::Side;
use crate::rig::Texture;
use fearless_simd::prelude::*;

/// From samples to fragments.
pub(super) struct Gather<'a> {
    pub picture: &'a PictureContext<'a>,
    /// The picture's pixel at the block's upper left corner.
    pub at: [u32; 2],
    drawn: &'a mut [Drawn],
    setup: &'a mut Vec<TriangleSetup>,
    material_triangles: &'a mut Vec<MaterialTriangle>,
    pub fragments: &'a mut Fragments,
}

/// Triangles of a tile, and what was found out about them.
#[derive(Default)]
pub(super) struct Triangles {
    /// By the numbers that samples keep.
    pub drawn: Vec<Drawn>,
    setup: Vec<TriangleSetup>,
    /// Of those that are looked up, the ones with materials of their own.
    material_triangles: Vec<MaterialTriangle>,
}

impl Triangles {
    pub(super) fn clear(&mut self) {
        self.drawn.clear();
        self.setup.clear();
        self.material_triangles.clear();
    }

    /// For the block with the picture's pixel `at` at its upper left corner.
    #[inline(always)]
    pub(super) fn gather<'a>(
        &'a mut self,
        picture: &'a PictureContext<'a>,
        at: [u32; 2],
        fragments: &'a mut Fragments,
    ) -> Gather<'a> {
        fragments.count = 0;
        Gather {
            picture,
            at,
            drawn: &mut self.drawn,
            setup: &mut self.setup,
            material_triangles: &mut self.material_triangles,
            fragments,
        }
    }
}

/// A triangle that reaches the tile.
#[derive(Clone, Copy)]
pub(super) struct Drawn {
    pub triangle: u32,
    /// Of a triangle that was cut, which of its pieces.
    pub piece: u32,
    /// Index into what was looked up, or [`NONE`] where it has not been seen yet.
    pub setup: u32,
}

/// A triangle that is seen.
struct TriangleSetup {
    planes: Planes,
    /// Index of its instance.
    instance: u32,
    color: BaseColor,
}

/// What a triangle scatters.
#[derive(Clone, Copy)]
enum BaseColor {
    Uniform([f32; 4]),
    /// The texture of the surface of this number.
    Texture(u32),
    /// What the triangle of this number does whose material is its own.
    Material(u32),
}

impl Gather<'_> {
    /// What the samples of a block show. `HAS_MATERIALS`: surfaces among it may have materials of their own.
    #[inline(always)]
    pub(super) fn block<S: Simd, const SAMPLES: usize, const HAS_MATERIALS: bool>(
        &mut self,
        simd: S,
        shown: &[u32],
    ) {
        let positions = self.picture.pattern.positions();
        for (pixel, samples) in shown.as_chunks::<SAMPLES>().0.iter().enumerate() {
            let first = samples[0];
            if *samples == [first; SAMPLES] {
                if first != NONE {
                    let middle = [EIGHTHS / 2; 2];
                    self.fragment::<S, HAS_MATERIALS>(simd, pixel, first, SAMPLES, middle);
                }
                continue;
            }
            for (sample, &number) in samples.iter().enumerate() {
                if number != NONE && !samples[..sample].contains(&number) {
                    let count = samples.iter().filter(|other| **other == number).count();
                    // Shaded where the triangle is for certain: at the first of its samples.
                    let place = positions[sample];
                    self.fragment::<S, HAS_MATERIALS>(simd, pixel, number, count, place);
                }
            }
        }
    }

    /// `place` is where in the pixel it is shaded, in eighths.
    #[inline(always)]
    pub(super) fn fragment<S: Simd, const HAS_MATERIALS: bool>(
        &mut self,
        simd: S,
        pixel: usize,
        number: u32,
        samples: usize,
        place: [i32; 2],
    ) {
        let setup = self.set_up(simd, number);
        let TriangleSetup {
            planes,
            instance,
            color,
        } = &self.setup[setup];
        let params = &self.picture.geometry.instances[*instance as usize].params;
        let pixel_at = [
            (self.at[0] + pixel as u32 % BLOCK) as f32,
            (self.at[1] + pixel as u32 / BLOCK) as f32,
        ];
        let eighth = 1.0 / EIGHTHS as f32;
        let from_origin = [
            pixel_at[0] + place[0] as f32 * eighth - planes.origin[0],
            pixel_at[1] + place[1] as f32 * eighth - planes.origin[1],
        ];
        let diffuse = match *color {
            BaseColor::Material(triangle) if HAS_MATERIALS => {
                let triangle = &self.material_triangles[triangle as usize];
                let of = &self.picture.geometry.materials[triangle.material as usize];
                let shown = triangle.shown(simd, of, planes, from_origin, pixel_at, params);
                return self.fragments.add_with_material(pixel, samples, shown);
            }
            BaseColor::Material(_) => {
                unreachable!("only pictures with materials have such triangles")
            }
            BaseColor::Uniform(color) => color,
            BaseColor::Texture(surface) => {
                let Paint::Textured(texture, _) =
                    self.picture.geometry.surfaces[surface as usize].paint
                else {
                    unreachable!("only textured surfaces are looked up as such");
                };
                let [r, g, b, _] = textured(simd, texture, planes, pixel_at);
                let by = params.textured_diffuse;
                [r * by.x, g * by.y, b * by.z, 1.0]
            }
        };
        let fragment = Fragment {
            normal: planes.normal.at(simd, from_origin).to_array(),
            position: planes.position.at(simd, from_origin).to_array(),
            diffuse,
        };
        if HAS_MATERIALS {
            let material = MaterialSample::plain(params);
            self.fragments
                .add_with_material(pixel, samples, (fragment, material));
        } else {
            self.fragments.add(pixel, samples, fragment);
        }
    }

    /// What is interpolated over a triangle is worked out when it is first seen.
    #[inline(always)]
    fn set_up<S: Simd>(&mut self, simd: S, number: u32) -> usize {
        let Drawn {
            triangle,
            piece,
            setup,
        } = self.drawn[number as usize];
        if setup != NONE {
            return setup as usize;
        }
        let geometry = &self.picture.geometry;
        let place = geometry.place(triangle);
        let corners = geometry.corners(place, piece);
        let params = &geometry.instance_of(place).params;
        let is_bare = params.flat_normals == 1;
        let is_flat = match place.surface.paint {
            Paint::Plain | Paint::Textured(..) => is_bare,
            Paint::Material(material) => {
                is_bare || geometry.materials[material as usize].params.is_flat == 1
            }
            Paint::Lines(_) | Paint::Solids(_) => false,
        };
        // It has samples, so it is no line.
        let side = side(corners.map(|corner| corner.projected)).unwrap_or(Side::Front);
        let color = match place.surface.paint {
            Paint::Lines(segments) => {
                BaseColor::Uniform(segments[place.triangle / 2].color.extend(0.0).to_array())
            }
            Paint::Solids(vertices) => {
                let first = place.surface.triangles[place.triangle][0];
                BaseColor::Uniform(vertices[first as usize].color.extend(1.0).to_array())
            }
            Paint::Plain => BaseColor::Uniform(params.diffuse.extend(1.0).to_array()),
            Paint::Textured(..) => {
                let surfaces = geometry.surfaces;
                let index =
                    surfaces.partition_point(|it| it.first_triangle < place.surface.first_triangle);
                BaseColor::Texture(index as u32)
            }
            Paint::Material(material) => {
                let of = &geometry.materials[material as usize];
                let triangle = MaterialTriangle::of(simd, material, of, &corners, is_bare);
                self.material_triangles.push(triangle);
                BaseColor::Material(self.material_triangles.len() as u32 - 1)
            }
        };
        let planes = Planes::of(simd, corners, side, is_flat);
        let index = self.setup.len();
        self.setup.push(TriangleSetup {
            planes,
            instance: place.surface.instance,
            color,
        });
        self.drawn[number as usize].setup = index as u32;
        index
    }
}

/// The texture at the middle of a pixel, as far apart as the middles of the pixels of its square of four.
#[inline(always)]
fn textured<S: Simd>(simd: S, texture: &Texture, planes: &Planes, pixel: [f32; 2]) -> [f32; 4] {
    let around = Texcoords::around(simd, &planes.texcoord, planes.origin, pixel);
    let Texcoords {
        here,
        beside,
        below,
        ..
    } = around;
    let by_x = [beside[0] - here[0], beside[1] - here[1]];
    let by_y = [below[0] - here[0], below[1] - here[1]];
    texture::sample(simd, texture, here, by_x, by_y)
}
