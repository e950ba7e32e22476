//! Does either renderer show what materials say, as the contract in `render/plan.rs` has it? Squares of which every number is known.
//! Where there is no software adapter, rigd's own renderer is tested alone.

#[path = "materials/alpha.rs"]
mod alpha;
#[path = "materials/color.rs"]
mod color;
#[path = "materials/many_meshes.rs"]
mod many_meshes;
#[path = "materials/normals.rs"]
mod normals;
#[path = "materials/still_life.rs"]
mod still_life;
mod support;
#[path = "materials/textures.rs"]
mod textures;

use rigd::render::Plan;
use rigd::render::cpu::Cores;
use rigd::render::gpu::Gpu;
use rigd::rig::{Draft, Highlight, Material, Opacity};
use rigd::scene::{Background, Samples};
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};
use support::pictures::{Image, encoded};
use support::quads::{Quad, by_gpu, draft, own, painted, plan, quad, scene};
use support::shot::Shot;

static GPU: LazyLock<Option<Mutex<Gpu>>> =
    LazyLock::new(|| support::adapters::gpu_on(&support::adapters::wgpu_adapter()).map(Mutex::new));

fn gpu() -> Option<MutexGuard<'static, Gpu>> {
    let gpu = GPU.as_ref()?;
    Some(gpu.lock().unwrap_or_else(PoisonError::into_inner))
}

/// By each renderer that is there, with its name.
fn drawn(plan: &Plan) -> Vec<(&'static str, Image)> {
    let by_wgpu = gpu().map(|mut gpu| ("wgpu", by_gpu(&mut gpu, plan)));
    let own = ("cpu", own(plan, Cores::One));
    std::iter::once(own).chain(by_wgpu).collect()
}

/// A column and a row of a picture, and the color there.
type Pixel = ([usize; 2], [u8; 4]);

/// Either renderer shows these pixels. Rounding may fall either way, but not where a channel is nothing or all.
#[track_caller]
fn assert_shown(what: &str, draft: Draft, scene: Shot, wanted: impl IntoIterator<Item = Pixel>) {
    let images = drawn(&plan(draft, scene));
    for ([x, y], wanted) in wanted {
        for (renderer, image) in &images {
            let found = image.at(x, y);
            let is_near = found.iter().zip(wanted).all(|(found, wanted)| {
                let is_extreme = wanted == 0 || wanted == 255;
                found.abs_diff(wanted) <= u8::from(!is_extreme)
            });
            assert!(
                is_near,
                "{what}, {renderer}: {found:?} at {x}, {y}, not {wanted:?}"
            );
        }
    }
}

/// Either renderer shows this in the middle of a picture of these squares.
#[track_caller]
fn assert_middle(what: &str, quads: &[Quad], scene: Shot, wanted: [u8; 4]) {
    let middle = [scene.size.width, scene.size.height].map(|side| side as usize / 2);
    assert_shown(what, draft(quads), scene, [(middle, wanted)]);
}

const RED: [u8; 4] = [255, 0, 0, 255];
const GREEN: [u8; 4] = [0, 255, 0, 255];
const BLUE: [u8; 4] = [0, 0, 255, 255];
const WHITE: [u8; 4] = [255; 4];
const BLACK: [u8; 4] = [0, 0, 0, 255];

/// The linear color as eight bits of sRGB have it; opaque.
fn srgb(color: [f64; 3]) -> [u8; 4] {
    let [r, g, b] = color.map(|channel| encoded(channel).round() as u8);
    [r, g, b, 255]
}

/// Linear colors, each with its alpha, laid over each other, the farthest first.
fn over(layers: &[[f64; 4]]) -> [u8; 4] {
    let (mut light, mut alpha) = ([0.0; 3], 0.0);
    for [r, g, b, own] in layers {
        let through = 1.0 - own;
        let channels = [r, g, b].into_iter().zip(&mut light);
        channels.for_each(|(channel, light)| *light = *light * through + channel * own);
        alpha = alpha * through + own;
    }
    let [r, g, b, _] = srgb(light.map(|light| light / alpha));
    [r, g, b, (255.0 * alpha).round() as u8]
}

/// In even white light before black, five pixels to a side.
fn small() -> Shot {
    scene([5, 5], Samples::Four)
}

fn before(background: [f64; 4], scene: Shot) -> Shot {
    Shot {
        background: Background::new(background).expect("a color"),
        ..scene
    }
}

fn dull(material: Material) -> Material {
    Material {
        highlight: Some(Highlight {
            specular: glam::Vec3::ZERO,
            shininess: 1.0,
        }),
        ..material
    }
}

fn blending(color: [f32; 4]) -> Material {
    Material {
        opacity: Opacity::Blend,
        ..painted(color)
    }
}

/// Before what is drawn, or behind it.
fn at(z: f32, quad: Quad) -> Quad {
    Quad { z, ..quad }
}

/// Of a color that blends.
fn pane(color: [f64; 4], z: f32) -> Quad {
    at(z, quad(blending(color.map(|channel| channel as f32))))
}
