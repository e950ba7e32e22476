//! Where a texture lies on a surface, and what is beyond its edges.

use super::{
    BLUE, GREEN, RED, WHITE, assert_middle, assert_shown, small, srgb,
    support::quads::{Quad, draft, painted, plan, quad, scene, texture},
};
use glam::Vec2;
use rigd::render::Plan;
use rigd::rig::{Encoding, Material, TexturePlace, TextureTransform, Wrap};
use rigd::scene::Samples;

const WRAPS: [Wrap; 3] = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];

fn textured(texture: TexturePlace) -> Quad {
    quad(Material {
        texture: Some(texture),
        ..painted([1.0; 4])
    })
}

#[test]
fn beyond_its_edges_a_texture_is_repeated_mirrored_or_clamped() {
    let row = [RED, GREEN, BLUE, WHITE];
    let rows = row.map(|texel| [texel]);
    let across = texture(Encoding::Srgb, &[&row]);
    let down = texture(Encoding::Srgb, &[&rows[0], &rows[1], &rows[2], &rows[3]]);
    let (red_and_white, blue_and_green) = (srgb([1.0, 0.5, 0.5]), srgb([0.0, 0.5, 0.5]));
    let red_and_green = srgb([0.5, 0.5, 0.0]);
    for (place, wanted) in [
        // The middle of the sixth of texels that go on and on, and of the second before the first.
        (1.375, [GREEN, BLUE, WHITE]),
        (-0.375, [BLUE, GREEN, RED]),
        // Half way between two texels: beyond the edge there is the other one or the same.
        (1.25, [red_and_green, srgb([0.5, 0.5, 1.0]), WHITE]),
        (1.0, [red_and_white, WHITE, WHITE]),
        (-0.5, [blue_and_green, blue_and_green, RED]),
    ] {
        for (wrap, wanted) in WRAPS.into_iter().zip(wanted) {
            for (picture, wraps, texcoord) in [
                (&across, [wrap, Wrap::Repeat], Vec2::new(place, 0.5)),
                (&down, [Wrap::Repeat, wrap], Vec2::new(0.5, 1.0 - place)),
            ] {
                let square = Quad {
                    texcoords: Some([texcoord; 4]),
                    ..textured(TexturePlace {
                        wrap: wraps,
                        ..picture.clone()
                    })
                };
                assert_middle(&format!("{wraps:?} at {place}"), &[square], small(), wanted);
            }
        }
    }
}

#[test]
fn each_axis_of_a_texture_is_wrapped_by_itself() {
    let yellow = [255, 255, 0, 255];
    let corners = texture(Encoding::Srgb, &[&[yellow, GREEN], &[RED, [0, 0, 0, 255]]]);
    // Three times across and three times down, the middle one the picture itself.
    let thrice = TextureTransform {
        columns: [3.0 * Vec2::X, 3.0 * Vec2::Y],
        offset: Vec2::NEG_ONE,
    };
    // Whether the left, or upper, half of the picture is there, from a middle of a half to the next.
    let halves = |wrap: Wrap| match wrap {
        Wrap::Repeat => [true, false, true, false, true, false],
        Wrap::Mirror => [false, true, true, false, false, true],
        Wrap::Clamp => [true, true, true, false, false, false],
    };
    for (u, v) in WRAPS.into_iter().flat_map(|u| WRAPS.map(|v| (u, v))) {
        let square = textured(TexturePlace {
            wrap: [u, v],
            picture_from_texcoord: thrice,
            ..corners.clone()
        });
        // Of six by six pixels, whose centers are those of halves.
        let wanted = (0..36).map(|index| {
            let [x, y] = [index % 6, index / 6];
            let light = |is: bool| if is { 255 } else { 0 };
            ([x, y], [light(halves(u)[x]), light(halves(v)[y]), 0, 255])
        });
        let what = format!("{u:?}, {v:?}");
        assert_shown(&what, draft(&[square]), scene([6, 6], Samples::One), wanted);
    }
}

#[test]
fn a_texture_lies_where_its_transform_puts_it() {
    let picture = texture(Encoding::Srgb, &[&[RED, GREEN], &[BLUE, WHITE]]);
    let upright = [Vec2::X, Vec2::Y];
    // (x, y) is at (y, 1 − x): a quarter turn.
    let turned = [Vec2::NEG_Y, Vec2::X];
    // Twice as often: each pixel is the mean of all.
    let doubled = [2.0 * Vec2::X, 2.0 * Vec2::Y];
    let mean = srgb([0.5; 3]);
    for (what, columns, offset, wanted) in [
        ("as it is", upright, Vec2::ZERO, [RED, GREEN, BLUE, WHITE]),
        (
            "to the left",
            upright,
            Vec2::new(0.5, 0.0),
            [GREEN, RED, WHITE, BLUE],
        ),
        (
            "up",
            upright,
            Vec2::new(0.0, 0.5),
            [BLUE, WHITE, RED, GREEN],
        ),
        ("turned", turned, Vec2::Y, [BLUE, RED, WHITE, GREEN]),
        ("doubled", doubled, Vec2::ZERO, [mean; 4]),
    ] {
        let square = textured(TexturePlace {
            picture_from_texcoord: TextureTransform { columns, offset },
            ..picture.clone()
        });
        // Of two by two pixels, whose centers are those of texels: rows from the top.
        let wanted = [[0, 0], [1, 0], [0, 1], [1, 1]].into_iter().zip(wanted);
        assert_shown(what, draft(&[square]), scene([2, 2], Samples::One), wanted);
    }
    // Half of the picture to each side, from its middle.
    let square = textured(TexturePlace {
        picture_from_texcoord: TextureTransform {
            columns: [0.5 * Vec2::X, 0.5 * Vec2::Y],
            offset: Vec2::splat(0.375),
        },
        ..picture
    });
    let scene = scene([2, 2], Samples::One);
    assert_shown("halved", draft(&[square]), scene, [([0, 0], mean)]);
}

#[test]
fn a_texture_of_two_materials_takes_the_memory_of_a_device_once() {
    // A device of its own, as others draw on the shared one meanwhile.
    let adapter = super::support::adapters::wgpu_adapter();
    let Some(mut gpu) = super::support::adapters::gpu_on(&adapter) else {
        return;
    };
    let row: Vec<[u8; 4]> = (0..=255).map(|x| [x, 0, 0, 255]).collect();
    let large = || texture(Encoding::Srgb, &[&row[..]; 256]);
    let two = |textures: [TexturePlace; 2]| -> Plan {
        let squares = textures.map(textured);
        let mut draft = draft(&squares);
        draft.materials[0].color = Some(glam::Vec4::splat(0.5));
        plan(draft, small())
    };
    let mut grown_by = |plan: Plan| {
        let before = gpu.memory_bytes();
        let in_flight = gpu.submit(&[&plan]).expect("room");
        gpu.finish(in_flight).expect("a picture");
        let grown = gpu.memory_bytes() - before;
        drop(plan);
        gpu.sweep();
        grown
    };
    // The first picture makes what the others find.
    grown_by(two([large(), large()]));
    let apart = grown_by(two([large(), large()]));
    let same = large();
    let bytes = same.texture.memory_bytes() as u64;
    let shared = grown_by(two([same.clone(), same]));
    assert_eq!(apart - shared, bytes);
}
