//! Everything at once, from all sides: the renderers against each other.

use super::{
    at, dull, gpu,
    support::alike::{self, share_of_all},
    support::quads::{Quad, by_gpu, draft, own, painted, plan, quad, scene, texture},
};
use crate::support::shot::Shot;
use glam::{DVec3, Vec2, Vec3, Vec4};
use rigd::render::Plan;
use rigd::render::cpu::Cores;
use rigd::rig::{
    Encoding, Highlight, Material, NormalMap, Opacity, TexturePlace, TextureTransform, Wrap,
};
use rigd::scene::{
    Background, Bounds, Camera, Color, Cull, Light, LookAt, Near, Samples, Show, Surface,
};

/// A picture of everything at once, from beside.
fn still_life(
    size: [u32; 2],
    samples: Samples,
    eye: DVec3,
    change: impl FnOnce(&mut Shot),
) -> Plan {
    let texel = |x: u32, y: u32| {
        let [r, g] = [x, y].map(|at| (16 * at) as u8);
        [
            r,
            g,
            if (x / 4 + y / 4).is_multiple_of(2) {
                220
            } else {
                60
            },
            40 + 13 * x as u8,
        ]
    };
    let rows: Vec<Vec<[u8; 4]>> = (0..16)
        .map(|y| (0..16).map(|x| texel(x, y)).collect())
        .collect();
    let rows: Vec<&[[u8; 4]]> = rows.iter().map(Vec::as_slice).collect();
    let picture = texture(Encoding::Srgb, &rows);
    let bumps: Vec<Vec<[u8; 4]>> = (0..16)
        .map(|y| {
            let row = (0..16).map(|x| {
                let lean = |at: u32| [128, 190, 128, 66][(at % 4) as usize];
                [lean(x), lean(y), 230, 255]
            });
            row.collect()
        })
        .collect();
    let bumps: Vec<&[[u8; 4]]> = bumps.iter().map(Vec::as_slice).collect();
    let normals = NormalMap {
        place: TexturePlace {
            wrap: [Wrap::Mirror, Wrap::Clamp],
            ..texture(Encoding::Linear, &bumps)
        },
        scale: 0.8,
    };
    let ramp = [
        Vec4::new(1.0, 0.3, 0.3, 0.1),
        Vec4::new(0.3, 1.0, 0.3, 1.0),
        Vec4::new(1.0, 1.0, 1.0, 0.6),
        Vec4::new(0.3, 0.3, 1.0, 0.9),
    ];
    let reach = |x: f32, y: f32| [Vec2::new(x, y), Vec2::new(x + 0.9, y + 0.9)];
    let twice = [
        Vec2::new(-0.5, -0.4),
        Vec2::new(1.7, 0.0),
        Vec2::new(1.6, 1.5),
        Vec2::new(-0.2, 1.8),
    ];
    let highlight = Highlight {
        specular: Vec3::new(0.3, 0.4, 0.5),
        shininess: 12.0,
    };
    let wall = |material: Material, x: f32, y: f32| Quad {
        reach: reach(x, y),
        ..quad(material)
    };
    // What has no normals of its own is mapped all the same.
    let relief = Material {
        normal_map: Some(normals.clone()),
        ..dull(painted([0.5, 0.6, 0.2, 1.0]))
    };
    let bumpy = Material {
        texture: Some(TexturePlace {
            picture_from_texcoord: TextureTransform {
                columns: [Vec2::new(1.2, 0.5), Vec2::new(-0.5, 1.2)],
                offset: Vec2::new(0.1, 0.7),
            },
            wrap: [Wrap::Clamp, Wrap::Mirror],
            ..picture.clone()
        }),
        normal_map: Some(normals),
        highlight: Some(highlight),
        emissive: Vec3::new(0.0, 0.05, 0.1),
        emissive_texture: Some(picture.clone()),
        ..painted([0.8, 0.7, 0.6, 1.0])
    };
    let mask = Material {
        texture: Some(picture.clone()),
        opacity: Opacity::Mask(0.5),
        ..Material::named(String::new())
    };
    let pane = Material {
        texture: Some(picture.clone()),
        highlight: Some(highlight),
        opacity: Opacity::Blend,
        ..painted([1.0, 0.9, 0.8, 0.9])
    };
    let sign = Material {
        is_unlit: true,
        is_single_sided: true,
        ..painted([0.9, 0.5, 0.1, 1.0])
    };
    let quads = [
        Quad {
            texcoords: Some(twice),
            ..wall(bumpy, -1.0, -1.0)
        },
        Quad {
            colors: Some(ramp),
            ..wall(painted([1.0; 4]), 0.05, -1.0)
        },
        at(
            0.2,
            Quad {
                colors: Some(ramp),
                texcoords: Some(twice),
                ..wall(mask, -0.4, -0.5)
            },
        ),
        Quad {
            normal: Vec3::new(0.3, 0.5, 0.8),
            is_flat: true,
            ..wall(relief, -1.0, 0.05)
        },
        wall(sign, 0.05, 0.05),
        // Not in one plane with the others: which of two is nearer where both are is a matter of rounding.
        at(-0.2, wall(Material::named(String::new()), -0.5, 0.6)),
        at(
            0.4,
            Quad {
                colors: Some(ramp),
                ..wall(pane.clone(), -0.1, -0.2)
            },
        ),
        at(0.6, wall(pane, -0.7, -0.3)),
    ];
    let mut scene = scene(size, samples);
    let look = LookAt {
        eye,
        target: DVec3::ZERO,
        up: DVec3::Y,
        fov_y: Some(0.8),
        height: None,
        near: Near(None),
    };
    let bounds = Bounds {
        min: DVec3::NEG_ONE,
        max: DVec3::ONE,
    };
    scene.camera = Camera::look_at(look, &bounds, scene.size).expect("a camera");
    scene.ambient = Color::constant(0.1, 0.1, 0.12);
    scene.lights = Light::default_pair();
    scene.background = Background::new([0.2, 0.2, 0.25, 0.5]).expect("a color");
    change(&mut scene);
    plan(draft(&quads), scene)
}

fn still_lives() -> Vec<(String, bool, Plan)> {
    let mut plans = Vec::new();
    for (name, eye) in [
        ("before", DVec3::new(0.2, 0.3, 3.0)),
        ("beside", DVec3::new(2.0, 0.8, 1.2)),
        ("behind", DVec3::new(-0.6, 0.4, -2.5)),
        ("in the midst", DVec3::new(0.3, -0.2, 0.5)),
    ] {
        for samples in [Samples::One, Samples::Four] {
            let has_one = samples == Samples::One;
            let size = [150, 130];
            let plain = still_life(size, samples, eye, |_| {});
            plans.push((format!("{name}, {samples:?}"), has_one, plain));
            let translucent = still_life(size, samples, eye, |shot| {
                let show = Show::new(
                    Default::default(),
                    Default::default(),
                    Default::default(),
                    0.6,
                );
                shot.show = show.expect("an opacity");
            });
            plans.push((
                format!("{name}, {samples:?}, translucent"),
                has_one,
                translucent,
            ));
            let overruled = still_life(size, samples, eye, |shot| {
                shot.cull = Cull::Never;
                let diffuse = Some(Color::constant(0.7, 0.6, 0.9));
                shot.surface = Surface::new(diffuse, None, Some(3.0)).expect("a surface");
            });
            plans.push((
                format!("{name}, {samples:?}, overruled"),
                has_one,
                overruled,
            ));
        }
    }
    plans
}

#[test]
fn one_core_and_all_draw_the_same_bytes() {
    for (name, _, plan) in still_lives() {
        assert!(own(&plan, Cores::One) == own(&plan, Cores::All), "{name}");
    }
}

#[test]
fn both_renderers_agree() {
    let Some(mut gpu) = gpu() else { return };
    let (mut off, mut all) = (0, 0);
    for (name, has_one_sample, plan) in still_lives() {
        let images = [own(&plan, Cores::One), by_gpu(&mut gpu, &plan)];
        let (of_picture, channels) =
            alike::compare(&format!("materials, {name}"), &images, has_one_sample);
        println!("{name}: {of_picture} of {channels} channels differ by more than 1");
        (off, all) = (off + of_picture, all + channels);
    }
    assert!(off as f64 <= share_of_all() * all as f64, "{off} of {all}");
}
