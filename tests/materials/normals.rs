//! Normal maps: which way a texel leans the normal.

use super::{
    drawn, dull,
    support::pictures::encoded,
    support::quads::{Quad, draft, lit, painted, plan, quad, scene, texture},
};
use glam::{DVec3, Vec2, Vec3};
use rigd::rig::{Encoding, Material, NormalMap, TextureTransform};
use rigd::scene::{Bounds, Camera, LookAt, Near, Samples};

/// A white square that does not gleam, all of it with this texel of a normal map.
fn mapped(texel: [u8; 3], scale: f32, picture_from_texcoord: TextureTransform) -> Quad {
    let [r, g, b] = texel;
    let mut place = texture(Encoding::Linear, &[&[[r, g, b, 255]; 4][..]; 4]);
    place.picture_from_texcoord = picture_from_texcoord;
    quad(dull(Material {
        normal_map: Some(NormalMap { place, scale }),
        ..painted([1.0; 4])
    }))
}

/// How much of the light from each of these directions either renderer shows in each of a few places.
#[track_caller]
fn assert_leans(what: &str, square: &Quad, from: DVec3, wanted: f64) {
    let lit = lit(scene([64, 64], Samples::Four), -from);
    for (renderer, image) in drawn(&plan(draft(std::slice::from_ref(square)), lit)) {
        for (x, y) in [(32, 32), (3, 60), (50, 9)] {
            let found = f64::from(image.at(x, y)[0]);
            // 128 is not quite the middle: in the dark that shows most.
            let most = if wanted == 0.0 { 16.0 } else { 4.0 };
            assert!(
                (found - encoded(wanted)).abs() <= most,
                "{what}, {renderer}: {found}, not {wanted}"
            );
        }
    }
}

const STRAIGHT: TextureTransform = TextureTransform::IDENTITY;
const RIGHT: [u8; 3] = [255, 128, 128];
const UP: [u8; 3] = [128, 255, 128];

#[test]
fn red_leans_to_the_right_and_green_up_on_the_picture() {
    let mirrored = TextureTransform {
        columns: [-Vec2::X, Vec2::Y],
        offset: Vec2::X,
    };
    // The picture's right is the square's up.
    let turned = TextureTransform {
        columns: [Vec2::Y, -Vec2::X],
        offset: Vec2::ZERO,
    };
    let root = std::f64::consts::FRAC_1_SQRT_2;
    let (right, left, up, down) = (DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y);
    let (ahead, slanted) = (DVec3::Z, [255, 128, 255]);
    for (what, texel, scale, transform, from, wanted) in [
        ("right", RIGHT, 1.0, STRAIGHT, right, 1.0),
        ("right, lit from the left", RIGHT, 1.0, STRAIGHT, left, 0.0),
        ("right, lit from above", RIGHT, 1.0, STRAIGHT, up, 0.0),
        ("right, lit from below", RIGHT, 1.0, STRAIGHT, down, 0.0),
        ("up", UP, 1.0, STRAIGHT, up, 1.0),
        ("up, lit from the right", UP, 1.0, STRAIGHT, right, 0.0),
        ("up, lit from below", UP, 1.0, STRAIGHT, down, 0.0),
        ("left", [0, 128, 255], 1.0, STRAIGHT, left + ahead, 1.0),
        ("down", [128, 0, 255], 1.0, STRAIGHT, up + ahead, 0.0),
        (
            "straight",
            [128, 128, 255],
            1.0,
            STRAIGHT,
            right + ahead,
            root,
        ),
        // Half way out of the plane: one over the root of two; with half the scale, one over the root of five.
        ("half way", slanted, 1.0, STRAIGHT, right, root),
        ("a quarter", slanted, 0.5, STRAIGHT, right, 0.2f64.sqrt()),
        ("mirrored", slanted, 1.0, mirrored, left + ahead, 1.0),
        (
            "mirrored, up",
            [128, 255, 255],
            1.0,
            mirrored,
            up + ahead,
            1.0,
        ),
        ("turned", slanted, 1.0, turned, up + ahead, 1.0),
    ] {
        assert_leans(what, &mapped(texel, scale, transform), from, wanted);
    }
}

#[test]
fn texture_coordinates_say_where_the_picture_s_right_and_up_are() {
    let mirrored = [Vec2::X, Vec2::ZERO, Vec2::Y, Vec2::ONE];
    let turned = [Vec2::Y, Vec2::ZERO, Vec2::X, Vec2::ONE];
    let of = |texel, texcoords| Quad {
        texcoords: Some(texcoords),
        ..mapped(texel, 1.0, STRAIGHT)
    };
    let upright = mapped(RIGHT, 1.0, STRAIGHT);
    let (right, left, up) = (DVec3::X, DVec3::NEG_X, DVec3::Y);
    let from_behind = Quad {
        normal: Vec3::NEG_Z,
        is_turned: true,
        ..upright.clone()
    };
    // Normals that a file leaves to the triangles are mapped as well.
    let flat = Quad {
        is_flat: true,
        ..upright
    };
    for (what, square, lit_from, dark_from) in [
        ("mirrored", of(RIGHT, mirrored), left, right),
        ("mirrored, up", of(UP, mirrored), up, right),
        ("turned", of(RIGHT, turned), up, right),
        ("from behind", from_behind, right, left),
        ("flat", flat, right, left),
    ] {
        assert_leans(what, &square, lit_from, 1.0);
        assert_leans(what, &square, dark_from, 0.0);
    }
}

#[test]
fn where_the_place_on_the_map_does_not_move_normals_stay() {
    let look = LookAt {
        eye: DVec3::new(2.0, 1.0, 2.5),
        target: DVec3::ZERO,
        up: DVec3::Y,
        fov_y: Some(0.9),
        height: None,
        near: Near(None),
    };
    let bounds = Bounds {
        min: DVec3::NEG_ONE,
        max: DVec3::ONE,
    };
    let mut slanting = lit(scene([64, 64], Samples::One), DVec3::NEG_ONE);
    slanting.camera = Camera::look_at(look, &bounds, slanting.size).expect("a camera");
    let of = |texcoord: fn(Vec2) -> Vec2, is_mapped: bool| {
        let mut square = mapped([255, 128, 200], 1.0, STRAIGHT);
        square.texcoords = square.texcoords.map(|it| it.map(texcoord));
        if !is_mapped {
            square.material.normal_map = None;
        }
        drawn(&plan(draft(&[square]), slanting.clone()))
    };
    let (bare, moving) = (of(|it| it, false), of(|it| it, true));
    for ((renderer, bare), (_, moving)) in bare.iter().zip(&moving) {
        assert!(moving.worst_difference(bare) > 20, "{renderer}");
    }
    for (what, texcoord) in [
        ("a point", (|_| Vec2::new(0.37, 0.61)) as fn(Vec2) -> Vec2),
        ("a far point", |_| Vec2::new(-70.3, 33.1)),
        ("a line", |it| Vec2::new(it.x, 0.3)),
    ] {
        for ((renderer, bare), (_, image)) in bare.iter().zip(of(texcoord, true)) {
            assert!(image.worst_difference(bare) <= 1, "{what}, {renderer}");
        }
    }
}
