//! Surfaces that are not everywhere, let through what is behind, or are seen from one side.

use super::{
    BLACK, BLUE, GREEN, Pixel, RED, assert_middle, assert_shown, at, before, blending, over, pane,
    small, srgb,
    support::quads::{Quad, draft, own, painted, plan, quad, scaled, scene, texture},
};
use crate::support::shot::Shot;
use glam::{DVec3, Vec2, Vec4};
use rigd::render::Plan;
use rigd::render::cpu::{Cores, Cpu, Parallelism};
use rigd::rig::{Encoding, Material, Opacity, TexturePlace, Wrap};
use rigd::scene::{Camera, Cull, LookAt, Near, Samples, Show};

const ON_BLUE: [f64; 4] = [0.0, 0.0, 1.0, 1.0];
const ON_NOTHING: [f64; 4] = [0.0; 4];

const FAR: [f64; 4] = [1.0, 1.0, 0.25, 0.5];
const MIDDLE: [f64; 4] = [1.0, 0.0, 0.5, 0.25];
const NEAR: [f64; 4] = [0.0, 1.0, 0.0, 0.6];

fn wall(color: [f32; 3], z: f32) -> Quad {
    let [r, g, b] = color;
    at(z, quad(painted([r, g, b, 1.0])))
}

fn with_opacity(opacity: f64, scene: Shot) -> Shot {
    let show = Show::new(
        Default::default(),
        Default::default(),
        Default::default(),
        opacity,
    );
    Shot {
        show: show.expect("an opacity"),
        ..scene
    }
}

fn from_behind(scene: Shot) -> Shot {
    let look = LookAt {
        eye: DVec3::new(0.0, 0.0, -10.0),
        target: DVec3::ZERO,
        up: DVec3::Y,
        fov_y: None,
        height: Some(2.0),
        near: Near(None),
    };
    let bounds = rigd::scene::Bounds {
        min: DVec3::NEG_ONE,
        max: DVec3::ONE,
    };
    Shot {
        camera: Camera::look_at(look, &bounds, scene.size).expect("a camera"),
        ..scene
    }
}

/// Every pixel of a picture so large.
fn all([width, height]: [usize; 2], of: impl Fn([usize; 2]) -> [u8; 4]) -> Vec<Pixel> {
    let places = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    places.map(|place| (place, of(place))).collect()
}

/// Alpha from nothing on the left to all on the right.
fn masked(least: f32) -> Quad {
    let [left, right] = [0.0, 1.0].map(|alpha| Vec4::new(1.0, 1.0, 1.0, alpha));
    let material = Material {
        opacity: Opacity::Mask(least),
        ..painted([0.0, 1.0, 0.0, 1.0])
    };
    Quad {
        colors: Some([left, right, right, left]),
        ..quad(material)
    }
}

#[test]
fn a_mask_takes_whole_pixels_by_their_centers() {
    for samples in [Samples::One, Samples::Four] {
        // Within the fourth column alpha goes from 0.43 to 0.57.
        let wanted = all([7, 7], |[x, _]| if x < 3 { BLACK } else { GREEN });
        let scene = scene([7, 7], samples);
        assert_shown(
            &format!("{samples:?}"),
            draft(&[masked(0.45)]),
            scene,
            wanted,
        );
    }
}

#[test]
fn a_mask_counts_color_texture_and_vertices_and_what_it_leaves_is_opaque() {
    for (alpha, vertex, wanted) in [
        (255, 0.5, GREEN),
        (220, 0.5, BLACK),
        (255, 0.4, BLACK),
        (110, 1.0, BLACK),
        (130, 1.0, GREEN),
    ] {
        let leaf = Material {
            texture: Some(texture(Encoding::Srgb, &[&[[255, 255, 255, alpha]]])),
            opacity: Opacity::Mask(0.4),
            ..painted([0.0, 1.0, 0.0, 0.9])
        };
        let leaf = Quad {
            colors: Some([Vec4::new(1.0, 1.0, 1.0, vertex); 4]),
            ..quad(leaf)
        };
        assert_middle(&format!("{alpha}, {vertex}"), &[leaf], small(), wanted);
    }
}

#[test]
fn what_a_mask_leaves_out_hides_nothing() {
    // So large that whole blocks of pixels are hidden at a time; both orders.
    let (near, far) = (at(0.5, masked(0.5)), wall([0.0, 0.0, 1.0], 0.0));
    for samples in [Samples::One, Samples::Four] {
        for quads in [[&near, &far], [&far, &near]] {
            let draft = draft(&quads.map(Clone::clone));
            let wanted = all([200, 200], |[x, _]| if x < 100 { BLUE } else { GREEN });
            assert_shown(
                &format!("{samples:?}"),
                draft,
                scene([200, 200], samples),
                wanted,
            );
        }
    }
}

#[test]
fn a_mask_follows_the_texture_that_is_stretched_over_it() {
    let half = texture(Encoding::Srgb, &[&[[255, 0, 0, 0], [255, 0, 0, 255]]]);
    let cut = Material {
        texture: Some(TexturePlace {
            wrap: [Wrap::Clamp; 2],
            ..half
        }),
        opacity: Opacity::Mask(0.5),
        ..painted([1.0; 4])
    };
    let quads = [at(0.5, quad(cut)), wall([0.0, 0.0, 1.0], 0.0)];
    let wanted = all([64, 64], |[x, _]| if x < 32 { BLUE } else { RED });
    assert_shown(
        "a cut",
        draft(&quads),
        scene([64, 64], Samples::Four),
        wanted,
    );
}

#[test]
fn alpha_is_that_of_color_texture_and_vertices_multiplied() {
    let pane = Material {
        texture: Some(texture(Encoding::Srgb, &[&[[255, 255, 255, 128]]])),
        ..blending([1.0, 1.0, 1.0, 0.5])
    };
    let pane = Quad {
        colors: Some([Vec4::new(1.0, 1.0, 1.0, 0.8); 4]),
        ..quad(pane)
    };
    let alpha = 0.5 * 0.8 * 128.0 / 255.0;
    let wanted = srgb([alpha, alpha, 1.0]);
    assert_middle("a pane", &[pane], before(ON_BLUE, small()), wanted);
}

#[test]
fn what_is_opaque_does_not_ask_for_alpha() {
    let wall = quad(painted([1.0, 0.0, 0.0, 0.25]));
    assert_middle("a wall", &[wall], before(ON_BLUE, small()), RED);
}

/// Named in this order, before this background: the layers that show, the farthest first.
#[test]
fn what_blends_is_laid_over_what_is_behind_it_and_hidden_by_what_is_opaque_before_it() {
    const RED_WALL: [f64; 4] = [1.0, 0.0, 0.0, 1.0];
    let orange = [1.0, 0.5, 0.0, 0.25];
    let red = |z| wall([1.0, 0.0, 0.0], z);
    let (far, middle, near) = (pane(FAR, 0.3), pane(MIDDLE, 0.5), pane(NEAR, 0.6));
    let behind = pane(FAR, -0.5);
    let blue = wall([0.0, 0.0, 1.0], 0.0);
    let two_sheets = &[ON_BLUE, FAR, NEAR][..];
    let three_sheets = &[ON_BLUE, FAR, MIDDLE, NEAR][..];
    for (what, background, quads, layers) in [
        (
            "a pane",
            ON_BLUE,
            vec![pane(orange, 0.0)],
            &[ON_BLUE, orange][..],
        ),
        (
            "a pane before nothing",
            ON_NOTHING,
            vec![pane(orange, 0.0)],
            &[orange],
        ),
        ("two", ON_BLUE, vec![far.clone(), near.clone()], two_sheets),
        (
            "two, turned",
            ON_BLUE,
            vec![near.clone(), far.clone()],
            two_sheets,
        ),
        (
            "two before nothing",
            ON_NOTHING,
            vec![near.clone(), far.clone()],
            &[FAR, NEAR],
        ),
        (
            "three before a wall",
            ON_NOTHING,
            vec![far.clone(), near.clone(), middle.clone(), blue.clone()],
            three_sheets,
        ),
        (
            "a wall last but two",
            ON_NOTHING,
            vec![middle.clone(), blue.clone(), near.clone(), far.clone()],
            three_sheets,
        ),
        (
            "a wall first",
            ON_NOTHING,
            vec![blue, near.clone(), middle, far.clone()],
            three_sheets,
        ),
        (
            "behind a wall",
            ON_BLUE,
            vec![red(0.0), behind.clone()],
            &[RED_WALL],
        ),
        (
            "behind a wall, turned",
            ON_BLUE,
            vec![behind.clone(), red(0.0)],
            &[RED_WALL],
        ),
        (
            "around a wall",
            ON_BLUE,
            vec![red(0.0), behind.clone(), near.clone()],
            &[RED_WALL, NEAR],
        ),
        (
            "around a wall, turned",
            ON_BLUE,
            vec![near.clone(), behind, red(0.0)],
            &[RED_WALL, NEAR],
        ),
        (
            "a wall between",
            ON_NOTHING,
            vec![far, near, red(0.45)],
            &[RED_WALL, NEAR],
        ),
    ] {
        assert_middle(what, &quads, before(background, small()), over(layers));
    }
}

#[test]
fn panes_show_farthest_first_whatever_their_order_in_the_file() {
    // The one with index 0 is the farthest.
    let colors = [FAR, NEAR, [1.0, 1.0, 1.0, 0.4]];
    let orders = [
        [0, 1, 2],
        [0, 2, 1],
        [1, 0, 2],
        [1, 2, 0],
        [2, 0, 1],
        [2, 1, 0],
    ];
    for (samples, order) in [Samples::One, Samples::Four]
        .into_iter()
        .flat_map(|samples| orders.map(|order| (samples, order)))
    {
        for (count, is_from_behind) in [(2, false), (2, true), (3, false), (3, true)] {
            let shown = &order[..count];
            let quads = shown
                .iter()
                .map(|&index| pane(colors[index], 0.2 * index as f32));
            let quads: Vec<Quad> = quads.collect();
            let ahead = before(ON_NOTHING, scene([5, 5], samples));
            let mut farthest_first = shown.to_vec();
            farthest_first.sort_unstable();
            let scene = if is_from_behind {
                farthest_first.reverse();
                from_behind(ahead)
            } else {
                ahead
            };
            let layers: Vec<_> = farthest_first.iter().map(|&index| colors[index]).collect();
            let what = format!("{shown:?}, {samples:?}, from behind: {is_from_behind}");
            assert_middle(&what, &quads, scene, over(&layers));
        }
    }
}

#[test]
fn what_blends_hides_nothing_where_it_is_not_there() {
    // Nothing on the left, half on the right.
    let leaf = Material {
        texture: Some(TexturePlace {
            wrap: [Wrap::Clamp; 2],
            ..texture(Encoding::Srgb, &[&[[0, 255, 0, 0], [0, 255, 0, 128]]])
        }),
        ..blending([1.0; 4])
    };
    let (leaf, far) = (at(0.6, quad(leaf)), pane(FAR, 0.3));
    let half = [0.0, 1.0, 0.0, 128.0 / 255.0];
    for quads in [[&leaf, &far], [&far, &leaf]] {
        let scene = before(ON_BLUE, scene([40, 40], Samples::Four));
        let wanted = [
            ([2, 20], over(&[ON_BLUE, FAR])),
            ([37, 20], over(&[ON_BLUE, FAR, half])),
        ];
        assert_shown("a leaf", draft(&quads.map(Clone::clone)), scene, wanted);
    }
}

#[test]
fn at_its_edge_what_blends_is_over_its_own_samples_only() {
    // Of the column in the middle two samples of each pixel are to the left of its middle, at x = 0; the wall has its lower rows.
    let left = Quad {
        reach: [Vec2::NEG_ONE, Vec2::new(0.0, 1.0)],
        ..pane(NEAR, 0.6)
    };
    let below = Quad {
        reach: [Vec2::NEG_ONE, Vec2::new(1.0, 0.0)],
        ..wall([1.0, 0.0, 0.0], 0.0)
    };
    let half_near = [NEAR[0], NEAR[1], NEAR[2], 0.5 * NEAR[3]];
    let (red, purple) = ([1.0, 0.0, 0.0, 1.0], [0.5, 0.0, 0.5, 1.0]);
    let wanted = [
        ([2, 0], over(&[ON_BLUE, half_near])),
        ([2, 4], over(&[red, half_near])),
        ([0, 2], over(&[purple, NEAR])),
        // A sample of all four.
        ([2, 2], over(&[purple, half_near])),
        ([4, 0], BLUE),
        ([4, 4], RED),
    ];
    assert_shown(
        "half a pixel",
        draft(&[left.clone(), below]),
        before(ON_BLUE, small()),
        wanted,
    );
    // Two that end together: half of the samples see both, the others none.
    let far = Quad {
        reach: left.reach,
        ..pane(FAR, 0.3)
    };
    let [r, g, b, alpha] = over(&[FAR, NEAR]);
    let halved = (f64::from(alpha) / 2.0).round() as u8;
    let wanted = [
        ([0, 2], [r, g, b, alpha]),
        ([2, 2], [r, g, b, halved]),
        ([4, 2], [0; 4]),
    ];
    assert_shown(
        "two",
        draft(&[left, far]),
        before(ON_NOTHING, small()),
        wanted,
    );
}

#[test]
fn parts_that_blend_go_by_how_far_their_centers_are() {
    // One leans through the other: where it is nearer, it is still the one behind.
    let leaning = [pane(NEAR, 0.0), pane(FAR, 0.0)];
    let turned = [pane(FAR, 0.0), pane(NEAR, 0.0)];
    for (quads, leans) in [(leaning, 1), (turned, 0)] {
        let mut draft = draft(&quads);
        for (corner, z) in [1.0, -1.2, -1.2, 1.0].into_iter().enumerate() {
            draft.meshes[leans].positions[corner].z = z;
        }
        let scene = before(ON_BLUE, scene([40, 40], Samples::Four));
        let wanted = [2, 37].map(|x| ([x, 20], over(&[ON_BLUE, FAR, NEAR])));
        assert_shown("leaning", draft, scene, wanted);
    }
}

/// Thousands of panes, each over a whole picture of many tiles, one behind the other.
fn many_panes(count: usize, size: [u32; 2]) -> Plan {
    let pane = Quad {
        // Pictures are wider than they are high.
        reach: [Vec2::splat(-2.0), Vec2::splat(2.0)],
        ..quad(blending([0.2, 0.6, 0.9, 0.01]))
    };
    let mut draft = draft(std::slice::from_ref(&pane));
    let mesh = &mut draft.meshes[0];
    mesh.triangles = mesh.triangles.repeat(count);
    mesh.parts[0].triangle_count *= count;
    plan(draft, scene(size, Samples::Four))
}

#[test]
fn thousands_that_blend_are_all_laid_over_each_other() {
    let plan = many_panes(400, [70, 40]);
    let image = own(&plan, Cores::One);
    let all = 1.0 - 0.99f64.powi(400);
    let wanted = srgb([0.2 * all, 0.6 * all, 0.9 * all]);
    for (x, y, found) in image.iter() {
        let off = found.iter().zip(wanted).map(|(a, b)| a.abs_diff(b)).max();
        assert!(off <= Some(1), "{found:?} at {x}, {y}, not {wanted:?}");
    }
    assert!(own(&plan, Cores::All) == image);
}

#[test]
fn what_blends_stops_when_it_is_no_longer_wanted() {
    use std::sync::atomic::{AtomicUsize, Ordering};
    // Drawn to its end this would take minutes: 6 * 10^10 pixels.
    let plan = many_panes(30_000, [2000, 1000]);
    for cores in [Cores::One, Cores::All] {
        let asked = AtomicUsize::new(0);
        let is_cancelled = || asked.fetch_add(1, Ordering::Relaxed) >= 100;
        let outputs = Cpu::default().render(&plan, Parallelism::cancellable(cores, &is_cancelled));
        assert!(outputs.is_none());
        // Whoever is told so asks no more.
        let asked = asked.into_inner();
        assert!((101..1000).contains(&asked), "{cores:?}: {asked}");
    }
}

#[test]
fn of_a_translucent_skin_the_nearest_surface_alone_shows() {
    // Translucent where its material is opaque, and more so where it is not.
    let (red, green) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let solid = |[r, g, b]: [f64; 3], alpha: f64| [r, g, b, alpha];
    let glass = |z| pane([0.0, 1.0, 0.0, 0.5], z);
    let wall = || wall([1.0, 0.0, 0.0], 0.5);
    for (what, quads, shown) in [
        ("a wall", vec![wall()], solid(red, 0.5)),
        ("a pane", vec![glass(0.0)], solid(green, 0.25)),
        (
            "a wall before a pane",
            vec![wall(), glass(0.0)],
            solid(red, 0.5),
        ),
        (
            "a pane before a wall",
            vec![wall(), glass(0.7)],
            solid(green, 0.25),
        ),
        (
            "a pane before a wall, turned",
            vec![glass(0.7), wall()],
            solid(green, 0.25),
        ),
        (
            "a pane before a pane",
            vec![pane(FAR, 0.0), glass(0.2)],
            solid(green, 0.25),
        ),
        (
            "a pane before a pane, turned",
            vec![glass(0.2), pane(FAR, 0.0)],
            solid(green, 0.25),
        ),
    ] {
        for (background, layers) in [(ON_BLUE, &[ON_BLUE, shown][..]), (ON_NOTHING, &[shown])] {
            let scene = with_opacity(0.5, before(background, small()));
            assert_middle(what, &quads, scene, over(layers));
        }
    }
}

#[test]
fn a_single_sided_surface_is_seen_from_its_front_unless_asked_for() {
    let single = Material {
        is_single_sided: true,
        ..painted([0.0, 1.0, 0.0, 1.0])
    };
    let mirrored = DVec3::new(-1.0, 1.0, 1.0);
    for scale in [DVec3::ONE, mirrored] {
        for (is_turned, cull, wanted) in [
            (false, Cull::Auto, GREEN),
            (true, Cull::Auto, BLACK),
            (true, Cull::Never, GREEN),
        ] {
            let wall = Quad {
                is_turned,
                ..quad(single.clone())
            };
            let scene = Shot { cull, ..small() };
            let what = format!("{scale}, turned: {is_turned}, {cull:?}");
            let draft = scaled(&[wall], scale);
            assert_shown(&what, draft, scene, [([2, 2], wanted)]);
        }
    }
    let wall = quad(single);
    let behind = from_behind(small());
    assert_middle("from behind", &[wall], behind, BLACK);
}

#[test]
fn a_single_sided_pane_shows_its_front_alone_unless_asked_for() {
    // One part, of which one square faces the camera and one, named later, does not: what is drawn later is not hidden.
    let sided = Material {
        is_single_sided: true,
        ..pane(NEAR, 0.0).material
    };
    let draft = || {
        let square = |z| at(z, quad(sided.clone()));
        let mut draft = draft(&[square(0.2), square(-0.2), pane(FAR, 0.4)]);
        let behind = draft.meshes.remove(1).positions;
        let both = &mut draft.meshes[0];
        both.positions.extend(behind);
        both.normals = None;
        both.texcoords = None;
        both.triangles = vec![[0, 1, 2], [4, 6, 5], [0, 2, 3], [4, 7, 6]];
        both.parts[0].triangle_count = 4;
        draft
    };
    for (cull, layers) in [
        (Cull::Auto, &[NEAR, FAR][..]),
        (Cull::Never, &[NEAR, NEAR, FAR]),
    ] {
        let scene = Shot {
            cull,
            ..before(ON_NOTHING, small())
        };
        assert_shown(
            &format!("{cull:?}"),
            draft(),
            scene,
            [([2, 2], over(layers))],
        );
    }
}
