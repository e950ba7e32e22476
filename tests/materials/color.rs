//! Color, light and highlight of surfaces.

use super::{
    WHITE, assert_middle, assert_shown, dull, scene, small, srgb,
    support::pictures::linear,
    support::quads::{Quad, draft, lit, painted, quad, texture},
};
use crate::support::shot::Shot;
use glam::{DVec2, DVec3, Vec2, Vec3, Vec4};
use rigd::rig::{Encoding, Highlight, Material};
use rigd::scene::{Bounds, Camera, Color, LookAt, Near, Samples, Surface};

#[test]
fn color_texture_and_vertex_color_multiply() {
    let plain = Material {
        texture: Some(texture(Encoding::Srgb, &[&[[188, 99, 255, 255]]])),
        ..painted([0.9, 0.8, 0.25, 1.0])
    };
    // What is more than 1 counts as 1.
    for (vertex, counted) in [
        ([0.5, 1.0, 0.75], [0.5, 1.0, 0.75]),
        ([3.0, 0.5, 1.0], [1.0, 0.5, 1.0]),
    ] {
        let quad = Quad {
            colors: Some([Vec3::from_array(vertex).extend(1.0); 4]),
            ..quad(plain.clone())
        };
        let [r, g, b] = counted.map(f64::from);
        let wanted = srgb([0.9 * linear(188) * r, 0.8 * linear(99) * g, 0.25 * b]);
        assert_middle("all three", &[quad], small(), wanted);
    }
}

#[test]
fn colors_of_vertices_are_mixed_in_perspective_and_clamped() {
    // From black on the left to twice white on the right, seen from beside.
    let [left, right] = [0.0, 2.0].map(|light: f32| Vec4::new(light, light, light, 1.0));
    let ramp = Quad {
        colors: Some([left, right, right, left]),
        ..quad(painted([1.0; 4]))
    };
    let mut scene = scene([101, 101], Samples::One);
    let look = LookAt {
        eye: DVec3::new(2.0, 0.0, 2.0),
        target: DVec3::ZERO,
        up: DVec3::Y,
        fov_y: Some(0.7),
        height: None,
        near: Near(None),
    };
    let bounds = Bounds {
        min: DVec3::NEG_ONE,
        max: DVec3::ONE,
    };
    scene.camera = Camera::look_at(look, &bounds, scene.size).expect("a camera");
    let camera = scene.camera;
    let wanted = [(50, 50), (30, 50), (65, 50)].map(|(x, y)| {
        let ray = camera.ray(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
        let ray = ray.expect("a ray");
        let hit = ray.origin + ray.direction * (-ray.origin.z / ray.direction.z);
        ([x, y], srgb([(hit.x + 1.0).min(1.0); 3]))
    });
    assert_eq!(wanted[2].1, WHITE);
    assert_shown("a ramp", draft(&[ramp]), scene, wanted);
}

#[test]
fn vertex_colors_need_no_material_and_squares_beside_them_stay_white() {
    let of_vertices = [[1.0, 0.0], [0.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    let white = Quad {
        reach: [Vec2::NEG_ONE, Vec2::new(0.0, 1.0)],
        ..quad(painted([1.0; 4]))
    };
    let colored = Quad {
        reach: [Vec2::new(0.0, -1.0), Vec2::ONE],
        colors: Some(of_vertices.map(|[r, g]| Vec4::new(r, g, 0.0, 1.0))),
        ..white.clone()
    };
    let mut draft = draft(&[white, colored]);
    draft.meshes[1].parts.clear();
    let mut scene = scene([64, 64], Samples::One);
    let surface = Surface::new(Some(Color::WHITE), None, None);
    scene.surface = surface.expect("a surface");
    // A quarter of the way across, three quarters of the way up.
    let mixed = srgb([1.0 - 7.5 / 32.0, 1.0 - 16.5 / 64.0, 0.0]);
    assert_shown("both", draft, scene, [([16, 32], WHITE), ([39, 16], mixed)]);
}

#[test]
fn every_shade_is_rounded_to_the_nearest_of_srgb() {
    for step in 0..64 {
        let shade = step as f32 / 63.0;
        let square = quad(painted([shade, shade * shade, 0.5, 1.0]));
        let shade = f64::from(shade);
        let wanted = srgb([shade, shade * shade, 0.5]);
        assert_middle("a shade", &[square], small(), wanted);
    }
}

#[test]
fn what_is_not_lit_is_its_color_and_emits_nothing() {
    let unlit = Material {
        is_unlit: true,
        emissive: Vec3::ONE,
        ..painted([0.2, 0.4, 0.6, 1.0])
    };
    let from_behind = lit(small(), DVec3::new(1.0, 0.0, 1.0));
    assert_middle("unlit", &[quad(unlit)], from_behind, srgb([0.2, 0.4, 0.6]));
}

#[test]
fn what_is_emitted_is_added_through_its_texture_and_needs_no_light() {
    let emissive = |color: [f32; 4], emissive: [f32; 3], texel: Option<[u8; 4]>| {
        quad(Material {
            emissive: Vec3::from_array(emissive),
            emissive_texture: texel.map(|texel| texture(Encoding::Srgb, &[&[texel]])),
            ..dull(painted(color))
        })
    };
    let texel = Some([255, 188, 0, 255]);
    let dark = Shot {
        ambient: Color::constant(0.0, 0.0, 0.0),
        ..small()
    };
    for (what, square, scene, wanted) in [
        (
            "textured",
            emissive([0.25, 0.0, 0.1, 1.0], [0.5, 1.0, 0.25], texel),
            small(),
            srgb([0.75, linear(188), 0.1]),
        ),
        (
            "clamped to white",
            emissive([0.75, 0.5, 0.0, 1.0], [0.5, 1.0, 0.25], None),
            small(),
            srgb([1.0, 1.0, 0.25]),
        ),
        (
            "in the dark",
            emissive([1.0; 4], [1.0, 0.5, 0.0], Some([188, 188, 188, 255])),
            dark,
            srgb([0.5, 0.25, 0.0]),
        ),
    ] {
        assert_middle(what, &[square], scene, wanted);
    }
}

#[test]
fn what_the_request_says_of_the_surface_wins() {
    let shiny = Material {
        highlight: Some(Highlight {
            specular: Vec3::new(0.0, 0.0, 0.5),
            shininess: 1.0,
        }),
        ..painted([0.25, 0.0, 0.0, 1.0])
    };
    // Light and eye half a right angle apart, the normal between them: n·l and n·h are known.
    let n_dot_l = 0.5f64.sqrt();
    let n_dot_h = (std::f64::consts::PI / 8.0).cos();
    let green = Color::constant(0.0, 0.5, 0.0);
    for (what, surface, wanted) in [
        (
            "its own",
            Surface::new(None, None, None),
            [0.25 * n_dot_l, 0.0, 0.5 * n_dot_h],
        ),
        (
            "diffuse",
            Surface::new(Some(green), None, None),
            [0.0, 0.5 * n_dot_l, 0.5 * n_dot_h],
        ),
        (
            "specular",
            Surface::new(None, Some(green), None),
            [0.25 * n_dot_l, 0.5 * n_dot_h, 0.0],
        ),
        (
            "shininess",
            Surface::new(None, None, Some(10.0)),
            [0.25 * n_dot_l, 0.0, 0.5 * n_dot_h.powi(10)],
        ),
    ] {
        let mut scene = lit(small(), DVec3::new(0.0, -1.0, -1.0));
        scene.surface = surface.expect("a surface");
        assert_middle(what, &[quad(shiny.clone())], scene, srgb(wanted));
    }
}

#[test]
fn a_flat_part_is_lit_by_its_own_normals() {
    for (is_flat, wanted) in [(false, srgb([0.8; 3])), (true, WHITE)] {
        let leaning = Quad {
            normal: Vec3::new(0.6, 0.0, 0.8),
            is_flat,
            ..quad(dull(painted([1.0; 4])))
        };
        let scene = lit(small(), DVec3::NEG_Z);
        assert_middle(&format!("flat: {is_flat}"), &[leaning], scene, wanted);
    }
}
