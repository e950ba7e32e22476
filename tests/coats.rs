//! Is a material drawn as the contract in `render/plan.rs` has it? Squares of which every number is known, and both renderers against each
//! other.

mod support;

use glam::{DVec3, Vec2, Vec3, Vec4};
use rigd::render::Plan;
use rigd::render::cpu::Cores;
use rigd::rig::{
    Draft, Encoding, Highlight, Material, NormalMap, Opacity, TexturePlace, TextureTransform, Wrap,
};
use rigd::scene::{
    Background, Bounds, Camera, Color, Cull, Light, LookAt, Near, Samples, Scene, Show,
    ShowNormals, ShowSkeleton, ShowSkin, Surface,
};
use support::alike::{self, share_of_all};
use support::pictures::{Image, encoded, linear};
use support::quads::{Quad, by_gpu, draft, lit, own, painted, plan, quad, scaled, scene, texture};

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

fn drawn(draft: Draft, scene: Scene) -> Image {
    own(&plan(draft, scene), Cores::One)
}

/// The middle of a picture of these squares in even white light before black.
fn middle(quads: &[Quad]) -> [u8; 4] {
    drawn(draft(quads), scene([5, 5], Samples::Four)).center()
}

/// Rounding may fall either way.
fn assert_near(found: [u8; 4], wanted: [u8; 4], what: &str) {
    let is_near = (0..4).all(|channel| found[channel].abs_diff(wanted[channel]) <= 1);
    assert!(is_near, "{what}: {found:?}, not {wanted:?}");
}

fn dull(material: Material) -> Material {
    Material {
        highlight: Some(Highlight {
            specular: Vec3::ZERO,
            shininess: 1.0,
        }),
        ..material
    }
}

/// Before what is drawn, or behind it.
fn at(z: f32, quad: Quad) -> Quad {
    Quad { z, ..quad }
}

fn blending(color: [f32; 4]) -> Material {
    Material {
        opacity: Opacity::Blend,
        ..painted(color)
    }
}

fn show(opacity: f64) -> Show {
    Show::new(
        ShowSkin::Posed,
        ShowSkeleton::None,
        ShowNormals::Smooth,
        opacity,
    )
    .expect("a number")
}

#[test]
fn color_texture_and_vertex_color_multiply() {
    let plain = Material {
        texture: Some(texture(Encoding::Srgb, &[&[[188, 99, 255, 255]]])),
        ..painted([0.9, 0.8, 0.25, 1.0])
    };
    let vertex = Vec4::new(0.5, 1.0, 0.75, 1.0);
    let found = middle(&[Quad {
        colors: Some([vertex; 4]),
        ..quad(plain)
    }]);
    let wanted = [0.9 * linear(188) * 0.5, 0.8 * linear(99), 0.25 * 0.75];
    assert_near(found, srgb(wanted), "all three");
}

#[test]
fn colors_of_vertices_are_mixed_in_perspective_and_held() {
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
    let image = drawn(draft(&[ramp]), scene);
    for (x, y) in [(50, 50), (30, 50), (65, 50)] {
        let ray = camera.ray(glam::DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
        let ray = ray.expect("a ray");
        let hit = ray.origin + ray.direction * (-ray.origin.z / ray.direction.z);
        let wanted = (hit.x + 1.0).min(1.0);
        assert_near(image.at(x, y), srgb([wanted; 3]), &format!("at {x}, {y}"));
    }
    assert_eq!(image.at(65, 50), WHITE);
}

#[test]
fn every_shade_is_rounded_to_the_nearest_of_srgb() {
    let shades: Vec<f32> = (0..64).map(|step| step as f32 / 63.0).collect();
    for shade in shades {
        let found = middle(&[quad(painted([shade, shade * shade, 0.5, 1.0]))]);
        let shade = f64::from(shade);
        assert_near(found, srgb([shade, shade * shade, 0.5]), "a shade");
    }
}

#[test]
fn what_is_not_lit_is_its_color_and_gives_off_nothing() {
    let unlit = Material {
        is_unlit: true,
        emissive: Vec3::ONE,
        ..painted([0.2, 0.4, 0.6, 1.0])
    };
    let image = drawn(
        draft(&[quad(unlit)]),
        lit(scene([5, 5], Samples::Four), DVec3::new(1.0, 0.0, 1.0)),
    );
    assert_near(image.center(), srgb([0.2, 0.4, 0.6]), "unlit");
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
fn a_mask_takes_whole_pixels_by_their_middles() {
    for samples in [Samples::One, Samples::Four] {
        let image = drawn(draft(&[masked(0.45)]), scene([7, 7], samples));
        // Within the fourth column alpha goes from 0.43 to 0.57.
        for (x, y, found) in image.iter() {
            let wanted = if x < 3 { BLACK } else { GREEN };
            assert_eq!(found, wanted, "{samples:?} at {x}, {y}");
        }
    }
}

#[test]
fn a_mask_counts_color_texture_and_vertices_and_what_it_leaves_is_opaque() {
    let leaf = |alpha: u8| Material {
        texture: Some(texture(Encoding::Srgb, &[&[[255, 255, 255, alpha]]])),
        opacity: Opacity::Mask(0.4),
        ..painted([0.0, 1.0, 0.0, 0.9])
    };
    let of = |alpha: u8, vertex: f32| {
        middle(&[Quad {
            colors: Some([Vec4::new(1.0, 1.0, 1.0, vertex); 4]),
            ..quad(leaf(alpha))
        }])
    };
    assert_eq!(of(255, 0.5), GREEN);
    assert_eq!(of(220, 0.5), BLACK);
    assert_eq!(of(255, 0.4), BLACK);
    assert_eq!(of(110, 1.0), BLACK);
    assert_eq!(of(130, 1.0), GREEN);
}

#[test]
fn what_a_mask_leaves_out_hides_nothing() {
    // So large that whole blocks of pixels are hidden at a time; both orders.
    let near = at(0.5, masked(0.5));
    let far = quad(painted([0.0, 0.0, 1.0, 1.0]));
    for samples in [Samples::One, Samples::Four] {
        for quads in [[near.clone(), far.clone()], [far.clone(), near.clone()]] {
            let image = drawn(draft(&quads), scene([200, 200], samples));
            for (x, y, found) in image.iter() {
                let wanted = if x < 100 { BLUE } else { GREEN };
                assert_eq!(found, wanted, "{samples:?} at {x}, {y}");
            }
        }
    }
}

/// In linear light, on a background of nothing but blue.
fn before_blue(quads: &[Quad], opacity: f64) -> [u8; 4] {
    let mut scene = scene([40, 40], Samples::Four);
    scene.background = Background::new([0.0, 0.0, 1.0, 1.0]).expect("blue");
    scene.show = show(opacity);
    drawn(draft(quads), scene).center()
}

#[test]
fn what_blends_lets_the_background_through() {
    let pane = quad(blending([1.0, 0.5, 0.0, 0.25]));
    assert_near(
        before_blue(std::slice::from_ref(&pane), 1.0),
        srgb([0.25, 0.125, 0.75]),
        "a pane",
    );
    assert_near(
        before_blue(&[pane], 0.5),
        srgb([0.125, 0.0625, 0.875]),
        "half of it",
    );
    let nothing = Background::new([0.0; 4]).expect("nothing");
    let mut clear = scene([5, 5], Samples::Four);
    clear.background = nothing;
    let found = drawn(draft(&[quad(blending([1.0, 0.5, 0.0, 0.25]))]), clear).center();
    let [r, g, b, _] = srgb([1.0, 0.5, 0.0]);
    assert_near(found, [r, g, b, 64], "before nothing");
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
    assert_near(
        before_blue(&[pane], 1.0),
        srgb([alpha, alpha, 1.0]),
        "a pane",
    );
}

#[test]
fn what_is_opaque_does_not_ask_for_alpha() {
    let found = before_blue(&[quad(painted([1.0, 0.0, 0.0, 0.25]))], 1.0);
    assert_eq!(found, RED);
}

/// Linear light of colors laid over blue, farthest first.
fn over_blue(colors: &[[f64; 4]]) -> [u8; 4] {
    let mut light = [0.0, 0.0, 1.0];
    for [r, g, b, alpha] in colors {
        let over = [r, g, b].into_iter().zip(light);
        let mixed: Vec<f64> = over
            .map(|(over, behind)| over * alpha + behind * (1.0 - alpha))
            .collect();
        light = [mixed[0], mixed[1], mixed[2]];
    }
    srgb(light)
}

const FAR: [f64; 4] = [1.0, 1.0, 0.25, 0.5];
const MIDDLE: [f64; 4] = [1.0, 0.0, 0.5, 0.25];
const NEAR: [f64; 4] = [0.0, 1.0, 0.0, 0.6];

fn pane(color: [f64; 4], z: f32) -> Quad {
    at(z, quad(blending(color.map(|channel| channel as f32))))
}

#[test]
fn what_blends_is_laid_over_what_blends_behind_it() {
    let (far, near) = (pane(FAR, 0.3), pane(NEAR, 0.6));
    let middle = pane(MIDDLE, 0.5);
    let wall = quad(painted([0.0, 0.0, 1.0, 1.0]));
    for quads in [[&far, &near], [&near, &far]] {
        let quads = quads.map(Clone::clone);
        assert_near(before_blue(&quads, 1.0), over_blue(&[FAR, NEAR]), "two");
    }
    for quads in [
        [&far, &near, &middle, &wall],
        [&middle, &wall, &near, &far],
        [&wall, &near, &middle, &far],
    ] {
        let quads = quads.map(Clone::clone);
        let wanted = over_blue(&[FAR, MIDDLE, NEAR]);
        assert_near(before_blue(&quads, 1.0), wanted, "three before a wall");
    }
}

#[test]
fn what_is_opaque_hides_what_blends_behind_it() {
    let wall = quad(painted([1.0, 0.0, 0.0, 1.0]));
    let (near, behind) = (pane(NEAR, 0.6), pane(FAR, -0.5));
    for quads in [[&wall, &behind], [&behind, &wall]] {
        let quads = quads.map(Clone::clone);
        assert_eq!(before_blue(&quads, 1.0), RED, "behind a wall");
    }
    let wanted = over_blue(&[[1.0, 0.0, 0.0, 1.0], NEAR]);
    for quads in [[&wall, &behind, &near], [&near, &behind, &wall]] {
        let quads = quads.map(Clone::clone);
        assert_near(before_blue(&quads, 1.0), wanted, "before and behind it");
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
        opacity: Opacity::Blend,
        ..painted([1.0; 4])
    };
    let (leaf, far) = (at(0.6, quad(leaf)), pane(FAR, 0.3));
    for quads in [[leaf.clone(), far.clone()], [far, leaf]] {
        let mut scene = scene([40, 40], Samples::Four);
        scene.background = Background::new([0.0, 0.0, 1.0, 1.0]).expect("blue");
        let image = drawn(draft(&quads), scene);
        assert_near(image.at(2, 20), over_blue(&[FAR]), "where it is not");
        let half = [0.0, 1.0, 0.0, 128.0 / 255.0];
        assert_near(image.at(37, 20), over_blue(&[FAR, half]), "where it is");
    }
}

#[test]
fn what_blends_before_nothing_hides_as_much_as_all_of_it_does() {
    let mut clear = scene([5, 5], Samples::Four);
    clear.background = Background::new([0.0; 4]).expect("nothing");
    let found = drawn(draft(&[pane(FAR, 0.3), pane(NEAR, 0.6)]), clear).center();
    let through = 1.0 - NEAR[3];
    let alpha = NEAR[3] + FAR[3] * through;
    let light = [0, 1, 2].map(|it| (NEAR[it] * NEAR[3] + FAR[it] * FAR[3] * through) / alpha);
    let [r, g, b, _] = srgb(light);
    assert_near(found, [r, g, b, (255.0 * alpha).round() as u8], "two panes");
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
        ..quad(painted([1.0, 0.0, 0.0, 1.0]))
    };
    let mut scene = scene([5, 5], Samples::Four);
    scene.background = Background::new([0.0, 0.0, 1.0, 1.0]).expect("blue");
    let image = drawn(draft(&[left, below]), scene);
    let mixed = |behind: [f64; 3], share: f64| {
        let over = NEAR[3] * share;
        srgb([0, 1, 2].map(|it| NEAR[it] * over + behind[it] * (1.0 - over)))
    };
    let (blue, red) = ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    assert_near(image.at(2, 0), mixed(blue, 0.5), "half a pixel");
    assert_near(image.at(2, 4), mixed(red, 0.5), "half a pixel of the wall");
    assert_near(image.at(0, 2), mixed([0.5, 0.0, 0.5], 1.0), "half a wall");
    assert_near(
        image.at(2, 2),
        mixed([0.5, 0.0, 0.5], 0.5),
        "half of each, a sample of all four",
    );
    assert_eq!(image.at(4, 0), BLUE);
    assert_eq!(image.at(4, 4), RED);
}

#[test]
fn parts_that_blend_go_by_how_far_their_middles_are() {
    // One leans through the other: where it is nearer, it is still the one behind.
    let leaning = [pane(NEAR, 0.0), pane(FAR, 0.0)];
    let turned = [pane(FAR, 0.0), pane(NEAR, 0.0)];
    for (quads, leans) in [(leaning, 1), (turned, 0)] {
        let mut draft = draft(&quads);
        for (corner, z) in [1.0, -1.2, -1.2, 1.0].into_iter().enumerate() {
            draft.meshes[leans].positions[corner].z = z;
        }
        let mut scene = scene([40, 40], Samples::Four);
        scene.background = Background::new([0.0, 0.0, 1.0, 1.0]).expect("blue");
        let image = drawn(draft, scene);
        for x in [2, 37] {
            let wanted = over_blue(&[FAR, NEAR]);
            assert_near(image.at(x, 20), wanted, &format!("at {x}"));
        }
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
        assert_near(found, wanted, &format!("at {x}, {y}"));
    }
    assert!(own(&plan, Cores::All) == image);
}

#[test]
fn what_blends_stops_when_it_is_no_longer_wanted() {
    use rigd::render::cpu::{Cpu, Spread};
    use std::sync::atomic::{AtomicUsize, Ordering};
    // Drawn to its end this would take minutes: 6 * 10^10 pixels.
    let plan = many_panes(30_000, [2000, 1000]);
    for cores in [Cores::One, Cores::All] {
        let asked = AtomicUsize::new(0);
        let is_wanted = || asked.fetch_add(1, Ordering::Relaxed) < 100;
        let outputs = Cpu::default().render(&plan, Spread::over(cores, &is_wanted));
        assert!(outputs.is_none());
        // Whoever is told so asks no more.
        let asked = asked.into_inner();
        assert!((101..1000).contains(&asked), "{cores:?}: {asked}");
    }
}

#[test]
fn of_a_translucent_skin_the_nearest_shows_whatever_it_is_made_of() {
    let wall = at(0.5, quad(painted([1.0, 0.0, 0.0, 1.0])));
    let pane = quad(blending([0.0, 1.0, 0.0, 0.5]));
    let both = [wall.clone(), pane.clone()];
    assert_near(before_blue(&both, 0.5), srgb([0.5, 0.0, 0.5]), "a wall");
    let nearer = [wall, at(0.7, pane)];
    assert_near(before_blue(&nearer, 0.5), srgb([0.0, 0.25, 0.75]), "a pane");
}

#[test]
fn a_single_sided_surface_is_seen_from_its_front() {
    let single = Material {
        is_single_sided: true,
        ..painted([0.0, 1.0, 0.0, 1.0])
    };
    let of = |is_turned: bool, cull: Cull, scale: DVec3| {
        let wall = Quad {
            is_turned,
            ..quad(single.clone())
        };
        let mut scene = scene([5, 5], Samples::Four);
        scene.cull = cull;
        drawn(scaled(&[wall], scale), scene).center()
    };
    let mirrored = DVec3::new(-1.0, 1.0, 1.0);
    for scale in [DVec3::ONE, mirrored] {
        assert_eq!(of(false, Cull::Auto, scale), GREEN, "{scale}");
        assert_eq!(of(true, Cull::Auto, scale), BLACK, "{scale}");
        assert_eq!(of(true, Cull::Never, scale), GREEN, "{scale}");
    }
}

#[test]
fn beyond_its_edges_a_texture_is_repeated_mirrored_or_held() {
    let row = [RED, GREEN, BLUE, WHITE];
    let rows = row.map(|texel| [texel]);
    let across = texture(Encoding::Srgb, &[&row]);
    let down = texture(Encoding::Srgb, &[&rows[0], &rows[1], &rows[2], &rows[3]]);
    let of = |laid: &TexturePlace, wrap: [Wrap; 2], texcoord: Vec2| {
        let material = Material {
            texture: Some(TexturePlace {
                wrap,
                ..laid.clone()
            }),
            ..painted([1.0; 4])
        };
        middle(&[Quad {
            texcoords: Some([texcoord; 4]),
            ..quad(material)
        }])
    };
    // The middle of the sixth of texels that go on and on, and of the second before the first.
    for (place, [repeated, mirrored, held]) in
        [(1.375, [GREEN, BLUE, WHITE]), (-0.375, [BLUE, GREEN, RED])]
    {
        for (wrap, wanted) in [
            (Wrap::Repeat, repeated),
            (Wrap::Mirror, mirrored),
            (Wrap::Clamp, held),
        ] {
            let own = [wrap, Wrap::Repeat];
            let found = of(&across, own, Vec2::new(place, 0.5));
            assert_eq!(found, wanted, "{wrap:?} across at {place}");
            let own = [Wrap::Repeat, wrap];
            let found = of(&down, own, Vec2::new(0.5, 1.0 - place));
            assert_eq!(found, wanted, "{wrap:?} down at {place}");
        }
    }
    // Half way between two texels: beyond the edge there is the other one or the same.
    let between = |wrap| of(&across, [wrap, Wrap::Repeat], Vec2::new(1.25, 0.5));
    let at_edge = |wrap| of(&across, [wrap, Wrap::Repeat], Vec2::new(1.0, 0.5));
    assert_near(between(Wrap::Repeat), srgb([0.5, 0.5, 0.0]), "repeated");
    assert_near(between(Wrap::Mirror), srgb([0.5, 0.5, 1.0]), "mirrored");
    assert_eq!(between(Wrap::Clamp), WHITE);
    assert_near(at_edge(Wrap::Repeat), srgb([1.0, 0.5, 0.5]), "repeated");
    assert_eq!(at_edge(Wrap::Mirror), WHITE);
    assert_eq!(at_edge(Wrap::Clamp), WHITE);
}

#[test]
fn a_texture_lies_where_its_transform_puts_it() {
    let laid = texture(Encoding::Srgb, &[&[RED, GREEN], &[BLUE, WHITE]]);
    // Of two by two pixels, whose middles are those of texels: rows from the top.
    let of = |columns: [Vec2; 2], offset: Vec2| {
        let material = Material {
            texture: Some(TexturePlace {
                picture_from_texcoord: TextureTransform { columns, offset },
                ..laid.clone()
            }),
            ..painted([1.0; 4])
        };
        let image = drawn(draft(&[quad(material)]), scene([2, 2], Samples::One));
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, y)| image.at(x, y))
    };
    let upright = [Vec2::X, Vec2::Y];
    assert_eq!(of(upright, Vec2::ZERO), [RED, GREEN, BLUE, WHITE]);
    assert_eq!(of(upright, Vec2::new(0.5, 0.0)), [GREEN, RED, WHITE, BLUE]);
    assert_eq!(of(upright, Vec2::new(0.0, 0.5)), [BLUE, WHITE, RED, GREEN]);
    // (x, y) is at (y, 1 − x): a quarter turn.
    let turned = [Vec2::NEG_Y, Vec2::X];
    assert_eq!(of(turned, Vec2::Y), [BLUE, RED, WHITE, GREEN]);
    // Half of the picture to each side, from its middle.
    let halved = [0.5 * Vec2::X, 0.5 * Vec2::Y];
    let quarter = of(halved, Vec2::new(0.375, 0.375));
    assert_near(quarter[0], srgb([0.5; 3]), "the middle of all");
    // Twice as often: each pixel is the mean of all.
    let doubled = of([2.0 * Vec2::X, 2.0 * Vec2::Y], Vec2::ZERO);
    for pixel in doubled {
        assert_near(pixel, srgb([0.5; 3]), "the mean");
    }
}

#[test]
fn what_is_given_off_is_added_through_its_texture() {
    let glowing = Material {
        emissive: Vec3::new(0.5, 1.0, 0.25),
        emissive_texture: Some(texture(Encoding::Srgb, &[&[[255, 188, 0, 255]]])),
        ..painted([0.25, 0.0, 0.1, 1.0])
    };
    let found = middle(&[quad(glowing)]);
    assert_near(found, srgb([0.75, linear(188), 0.1]), "glowing");
    let without_texture = Material {
        emissive: Vec3::new(0.5, 1.0, 0.25),
        ..painted([0.75, 0.5, 0.0, 1.0])
    };
    let found = middle(&[quad(without_texture)]);
    assert_near(found, srgb([1.0, 1.0, 0.25]), "held to white");
}

/// How light a white square with this normal map is, lit along its own plane from each side: right, left, above, below.
fn leaned(texel: [u8; 4], scale: f32, change: impl Fn(Quad) -> Quad) -> [u8; 4] {
    let mapped = dull(Material {
        normal_map: Some(NormalMap {
            place: texture(Encoding::Linear, &[&[texel]]),
            scale,
        }),
        ..painted([1.0; 4])
    });
    let quad = change(quad(mapped));
    let from = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y];
    from.map(|from| {
        let scene = lit(scene([5, 5], Samples::Four), -from);
        drawn(draft(std::slice::from_ref(&quad)), scene).center()[0]
    })
}

#[test]
fn a_normal_map_leans_to_the_right_and_up_on_its_picture() {
    let as_it_is = |quad: Quad| quad;
    // Numbers of 127.5 would be nothing; 128 is next to it.
    let (right, up) = ([255, 128, 128, 255], [128, 255, 128, 255]);
    let is_lit = |found: [u8; 4]| found.map(|light| light > 200);
    assert_eq!(
        is_lit(leaned(right, 1.0, as_it_is)),
        [true, false, false, false]
    );
    assert_eq!(
        is_lit(leaned(up, 1.0, as_it_is)),
        [false, false, true, false]
    );
    // Mirrored on the square, the picture's right is the left; turned, it is above.
    let mirrored = |quad: Quad| Quad {
        texcoords: Some([Vec2::X, Vec2::ZERO, Vec2::Y, Vec2::ONE]),
        ..quad
    };
    assert_eq!(
        is_lit(leaned(right, 1.0, mirrored)),
        [false, true, false, false]
    );
    assert_eq!(
        is_lit(leaned(up, 1.0, mirrored)),
        [false, false, true, false]
    );
    let turned = |quad: Quad| Quad {
        texcoords: Some([Vec2::Y, Vec2::ZERO, Vec2::X, Vec2::ONE]),
        ..quad
    };
    assert_eq!(
        is_lit(leaned(right, 1.0, turned)),
        [false, false, true, false]
    );
    // From behind they are the same directions.
    let from_behind = |quad: Quad| Quad {
        normal: Vec3::NEG_Z,
        is_turned: true,
        ..quad
    };
    assert_eq!(
        is_lit(leaned(right, 1.0, from_behind)),
        [true, false, false, false]
    );
    // Half way out of the plane: one over the root of two; with half the scale, one over the root of five.
    let slanted = [255, 128, 255, 255];
    for (scale, share) in [(1.0, 0.5f64.sqrt()), (0.5, 0.2f64.sqrt())] {
        let found = f64::from(leaned(slanted, scale, as_it_is)[0]);
        assert!((found - encoded(share)).abs() < 1.6, "{found}");
    }
    // Where the place does not move, nothing leans; normals that a file leaves to the triangles do.
    let still = |quad: Quad| Quad {
        texcoords: Some([Vec2::splat(0.3); 4]),
        ..quad
    };
    let flat = |quad: Quad| Quad {
        is_flat: true,
        ..quad
    };
    assert_eq!(leaned(right, 1.0, still), [0; 4]);
    assert_eq!(
        is_lit(leaned(right, 1.0, flat)),
        [true, false, false, false]
    );
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
    // Light and eye a right angle apart, the normal between them: n·l and n·h are known.
    let direction = DVec3::new(0.0, -1.0, -1.0);
    let of = |surface: Surface| {
        let mut scene = lit(scene([5, 5], Samples::Four), direction);
        scene.surface = surface;
        drawn(draft(&[quad(shiny.clone())]), scene).center()
    };
    let n_dot_l = 0.5f64.sqrt();
    let n_dot_h = (std::f64::consts::PI / 8.0).cos();
    assert_near(
        of(Surface::default()),
        srgb([0.25 * n_dot_l, 0.0, 0.5 * n_dot_h]),
        "its own",
    );
    let surface = |diffuse, specular, shininess| {
        Surface::new(diffuse, specular, shininess).expect("a surface")
    };
    let green = Color::constant(0.0, 0.5, 0.0);
    assert_near(
        of(surface(Some(green), None, None)),
        srgb([0.0, 0.5 * n_dot_l, 0.5 * n_dot_h]),
        "diffuse",
    );
    assert_near(
        of(surface(None, Some(green), None)),
        srgb([0.25 * n_dot_l, 0.5 * n_dot_h, 0.0]),
        "specular",
    );
    assert_near(
        of(surface(None, None, Some(10.0))),
        srgb([0.25 * n_dot_l, 0.0, 0.5 * n_dot_h.powi(10)]),
        "shininess",
    );
}

#[test]
fn a_flat_part_is_lit_by_its_own_normals() {
    let of = |is_flat: bool| {
        let leaning = Quad {
            normal: Vec3::new(0.6, 0.0, 0.8),
            is_flat,
            ..quad(dull(painted([1.0; 4])))
        };
        let scene = lit(scene([5, 5], Samples::Four), DVec3::NEG_Z);
        drawn(draft(&[leaning]), scene).center()
    };
    assert_near(of(false), srgb([0.8; 3]), "smooth");
    assert_eq!(of(true), WHITE);
}

/// A picture of everything at once, from beside.
fn still_life(size: [u32; 2], samples: Samples, eye: DVec3) -> Plan {
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
            let of = |plan: &mut Plan, change: &dyn Fn(&mut Scene)| {
                if let rigd::render::Wanted::Picture(picture) = &mut plan.wanted {
                    change(&mut picture.scene);
                }
            };
            let has_one = samples == Samples::One;
            let plan = || still_life([150, 130], samples, eye);
            plans.push((format!("{name}, {samples:?}"), has_one, plan()));
            let mut translucent = plan();
            of(&mut translucent, &|scene| scene.show = show(0.6));
            plans.push((
                format!("{name}, {samples:?}, translucent"),
                has_one,
                translucent,
            ));
            let mut overruled = plan();
            of(&mut overruled, &|scene| {
                scene.cull = Cull::Never;
                let diffuse = Some(Color::constant(0.7, 0.6, 0.9));
                scene.surface = Surface::new(diffuse, None, Some(3.0)).expect("a surface");
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
    let Some(mut gpu) = support::adapters::gpu_on(&support::adapters::wgpu_adapter()) else {
        return;
    };
    let (mut off, mut all) = (0, 0);
    for (name, has_one_sample, plan) in still_lives() {
        let images = [own(&plan, Cores::One), by_gpu(&mut gpu, &plan)];
        let (of_picture, channels) =
            alike::compare(&format!("coats, {name}"), &images, has_one_sample);
        println!("{name}: {of_picture} of {channels} channels differ by more than 1");
        (off, all) = (off + of_picture, all + channels);
    }
    assert!(off as f64 <= share_of_all() * all as f64, "{off} of {all}");
}
