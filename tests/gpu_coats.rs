//! Does wgpu's renderer show what a file's materials say? Walls made here, of which every pixel is known. Where there is no software
//! adapter, these tests say so and pass.

mod support;

use glam::{DAffine3, DVec3, Vec2, Vec3, Vec4};
use rigd::limits::Limits;
use rigd::pose::{Pose, Posed, Skinning};
use rigd::render::gpu::Gpu;
use rigd::render::{Instance, Outputs, Plan};
use rigd::rig::{
    BindPose, BindingDraft, Draft, Encoding, JointDraft, Material, MeshDraft, MorphDraft,
    NormalMap, Opacity, PartDraft, Rig, Texture, TextureLevel, TexturePlace, TextureTransform,
    Wrap,
};
use rigd::scene::{
    Background, Bounds, Camera, Color, Cull, Light, LookAt, Near, Samples, Scene, Shape, Show,
    Size, Surface, VertexQuery,
};
use std::path::PathBuf;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};
use support::pictures::{Image, encoded};

static GPU: LazyLock<Option<Mutex<Gpu>>> =
    LazyLock::new(|| support::adapters::gpu_on(&support::adapters::wgpu_adapter()).map(Mutex::new));

const SIDE: u32 = 64;

/// A wall at this depth from -1 to 1 that faces +Z, the whole picture on it.
fn wall(z: f32) -> MeshDraft {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(Vec2::from_array);
    MeshDraft {
        positions: corners.map(|corner| corner.extend(z)).to_vec(),
        texcoords: Some(corners.map(|corner| (corner + 1.0) / 2.0).to_vec()),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..MeshDraft::default()
    }
}

fn of_material(mesh: MeshDraft, material: usize) -> MeshDraft {
    let part = PartDraft {
        triangle_count: mesh.triangles.len(),
        material: Some(material),
        is_flat: false,
    };
    MeshDraft {
        parts: vec![part],
        ..mesh
    }
}

fn material() -> Material {
    Material::named("paint".to_owned())
}

/// Of a single color that is scattered.
fn painted(color: [f32; 4]) -> Material {
    Material {
        color: Some(Vec4::from_array(color)),
        ..material()
    }
}

fn texture(encoding: Encoding, side: u32, texel: impl Fn(u32, u32) -> [u8; 4]) -> Arc<Texture> {
    let places = (0..side).flat_map(|y| (0..side).map(move |x| (x, y)));
    let level = TextureLevel {
        width: side,
        height: side,
        texels: places.map(|(x, y)| texel(x, y)).collect(),
    };
    Arc::new(Texture::new("t.png".to_owned(), encoding, level))
}

fn plain(texture: Arc<Texture>) -> Option<TexturePlace> {
    Some(TexturePlace::plain(texture))
}

/// One wall of this material.
fn single(material: Material) -> Draft {
    Draft {
        meshes: vec![of_material(wall(0.0), 0)],
        materials: vec![material],
        ..Draft::default()
    }
}

fn built(draft: Draft) -> Arc<Rig> {
    Arc::new(draft.build(&Limits::default()).expect("a rig"))
}

fn posed(rig: &Arc<Rig>) -> Arc<Posed> {
    Arc::new(Posed::new(&Pose::rest(rig)).expect("a small pose"))
}

fn camera(eye: [f64; 3]) -> Camera {
    let look = LookAt {
        eye: DVec3::from_array(eye),
        target: DVec3::ZERO,
        up: DVec3::Y,
        fov_y: None,
        height: Some(2.0),
        near: Near(None),
    };
    let size = Size {
        width: SIDE,
        height: SIDE,
    };
    Camera::look_at(look, &Bounds::ORIGIN, size).expect("a camera")
}

/// Seen straight on, the wall fills the picture; the light is even and white, so that a pixel is what is scattered.
fn scene() -> Scene {
    Scene {
        size: Size {
            width: SIDE,
            height: SIDE,
        },
        samples: Samples::One,
        camera: camera([0.0, 0.0, 5.0]),
        lights: vec![],
        ambient: Color::WHITE,
        surface: Surface {
            specular: Some(Color::constant(0.0, 0.0, 0.0)),
            ..Surface::default()
        },
        background: Background::new([0.0, 0.0, 0.0, 1.0]).expect("black"),
        show: Show::default(),
        cull: Cull::Auto,
    }
}

fn run(plan: &Plan) -> Option<Outputs> {
    let mut gpu = GPU.as_ref()?.lock().unwrap_or_else(PoisonError::into_inner);
    let in_flight = gpu.submit(&[plan]).expect("room");
    gpu.finish(in_flight).expect("outputs").outputs.pop()
}

/// The picture, also written where somebody can look at it. `None` where there is nothing to draw with.
fn seen(name: &str, draft: Draft, scene: Scene) -> Option<Image> {
    let plan = Plan::picture(posed(&built(draft)), Skinning::Linear, scene, 2.0);
    let Outputs::Picture(frame) = run(&plan)? else {
        panic!("a picture was asked for");
    };
    let image = Image::from_bytes([SIDE as usize; 2], &frame.pixels);
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("coats");
    image.write(&folder.join(format!("{name}.png")));
    Some(image)
}

#[track_caller]
fn assert_is(found: [u8; 4], linear: [f64; 3], alpha: f64) {
    let [r, g, b] = linear.map(encoded);
    let off = found
        .iter()
        .zip([r, g, b, 255.0 * alpha])
        .map(|(found, wanted)| (f64::from(*found) - wanted).abs());
    assert!(
        off.fold(0.0, f64::max) <= 1.5,
        "{found:?} is not {:?}",
        [r, g, b, 255.0 * alpha]
    );
}

/// Half the light of white.
const HALF: u8 = 188;

#[test]
fn color_texture_and_vertex_color_multiply() {
    let grey = texture(Encoding::Srgb, 4, |_, _| [HALF, HALF, HALF, 255]);
    let material = Material {
        texture: plain(grey),
        ..painted([0.5, 1.0, 1.0, 1.0])
    };
    let mut draft = single(material);
    // What is more than 1 counts as 1.
    draft.meshes[0].colors = Some(vec![Vec4::new(3.0, 1.0, 0.5, 1.0); 4]);
    let Some(image) = seen("product", draft, scene()) else {
        return;
    };
    assert_is(image.center(), [0.25, 0.5, 0.25], 1.0);
    assert_is(image.at(1, 1), [0.25, 0.5, 0.25], 1.0);
}

#[test]
fn a_request_has_the_last_word_on_color_and_highlight() {
    let given = Scene {
        surface: Surface {
            diffuse: Some(Color::constant(0.1, 0.2, 0.3)),
            ..scene().surface
        },
        ..scene()
    };
    let red = || single(painted([1.0, 0.0, 0.0, 1.0]));
    let Some(image) = seen("given", red(), given) else {
        return;
    };
    assert_is(image.center(), [0.1, 0.2, 0.3], 1.0);
    let gleaming = Material {
        highlight: Some(rigd::rig::Highlight {
            specular: Vec3::new(0.0, 0.5, 0.0),
            shininess: 10.0,
        }),
        ..painted([0.2, 0.0, 0.0, 1.0])
    };
    let lit = Scene {
        lights: vec![Light::directional(DVec3::NEG_Z, Color::WHITE, 1.0).expect("a light")],
        ambient: Color::constant(0.0, 0.0, 0.0),
        surface: Surface::default(),
        ..scene()
    };
    let image = seen("gleam", single(gleaming), lit).expect("as before");
    assert_is(image.center(), [0.2, 0.5, 0.0], 1.0);
}

#[test]
fn vertex_colors_need_no_material_and_walls_beside_them_stay_white() {
    let mut colored = wall(0.0);
    colored.colors = Some(
        [[1.0, 0.0], [0.0, 0.0], [0.0, 1.0], [1.0, 1.0]]
            .map(|[r, g]| Vec4::new(r, g, 0.0, 1.0))
            .to_vec(),
    );
    let half = |mut mesh: MeshDraft, x: f32| {
        mesh.positions.iter_mut().for_each(|p| p.x = p.x / 2.0 + x);
        mesh
    };
    let draft = Draft {
        meshes: vec![of_material(half(wall(0.0), -0.5), 0), half(colored, 0.5)],
        materials: vec![painted([1.0, 1.0, 1.0, 1.0])],
        ..Draft::default()
    };
    let white = Scene {
        surface: Surface {
            diffuse: Some(Color::WHITE),
            ..scene().surface
        },
        ..scene()
    };
    let Some(image) = seen("vertex_colors", draft, white) else {
        return;
    };
    assert_is(image.at(16, 32), [1.0, 1.0, 1.0], 1.0);
    // A quarter of the way across, three quarters of the way up.
    assert_is(
        image.at(39, 16),
        [1.0 - 7.5 / 32.0, 1.0 - 16.5 / 64.0, 0.0],
        1.0,
    );
}

#[test]
fn what_is_unlit_is_shown_as_it_is_and_what_glows_needs_no_light() {
    let dark = || Scene {
        ambient: Color::constant(0.0, 0.0, 0.0),
        ..scene()
    };
    let unlit = Material {
        is_unlit: true,
        emissive: Vec3::ONE,
        ..painted([0.2, 0.4, 0.6, 1.0])
    };
    let Some(image) = seen("unlit", single(unlit), dark()) else {
        return;
    };
    assert_is(image.center(), [0.2, 0.4, 0.6], 1.0);
    let stripes = texture(Encoding::Srgb, 4, |x, _| {
        if x < 2 {
            [255; 4]
        } else {
            [HALF, HALF, HALF, 255]
        }
    });
    let glowing = Material {
        emissive: Vec3::new(1.0, 0.5, 0.0),
        emissive_texture: plain(stripes),
        ..painted([1.0; 4])
    };
    let image = seen("glowing", single(glowing), dark()).expect("as before");
    assert_is(image.at(20, 32), [1.0, 0.5, 0.0], 1.0);
    assert_is(image.at(44, 32), [0.5, 0.25, 0.0], 1.0);
}

#[test]
fn a_mask_cuts_out_and_shows_what_is_behind() {
    let half = texture(Encoding::Srgb, 2, |x, _| {
        [255, 0, 0, if x == 0 { 0 } else { 255 }]
    });
    let cut = Material {
        texture: Some(TexturePlace {
            wrap: [Wrap::Clamp; 2],
            ..TexturePlace::plain(half)
        }),
        opacity: Opacity::Mask(0.5),
        ..painted([1.0; 4])
    };
    let mut draft = single(cut);
    draft.meshes.push(of_material(wall(-0.5), 1));
    draft.materials.push(painted([0.0, 0.0, 1.0, 1.0]));
    let four = Scene {
        samples: Samples::Four,
        ..scene()
    };
    let Some(image) = seen("mask", draft, four) else {
        return;
    };
    assert_is(image.at(31, 32), [0.0, 0.0, 1.0], 1.0);
    assert_is(image.at(32, 32), [1.0, 0.0, 0.0], 1.0);
    let mixed = image
        .iter()
        .filter(|(_, _, [r, _, b, _])| (*r > 0) == (*b > 0));
    assert_eq!(mixed.count(), 0, "all samples of a pixel or none");
}

fn glass(color: [f32; 4]) -> Material {
    Material {
        opacity: Opacity::Blend,
        ..painted(color)
    }
}

/// Before nothing.
fn clear() -> Scene {
    Scene {
        background: Background::new([0.0; 4]).expect("nothing"),
        ..scene()
    }
}

fn of_opacity(scene: Scene, opacity: f64) -> Scene {
    let show = Show::new(
        Default::default(),
        Default::default(),
        Default::default(),
        opacity,
    );
    Scene {
        show: show.expect("an opacity"),
        ..scene
    }
}

/// Color and alpha of these laid over each other, each linear and with its alpha, the farthest first.
fn over(layers: &[[f32; 4]]) -> ([f64; 3], f64) {
    let (mut sum, mut alpha) = (DVec3::ZERO, 0.0);
    for layer in layers {
        let [r, g, b, own] = layer.map(f64::from);
        sum = sum * (1.0 - own) + DVec3::new(r, g, b) * own;
        alpha = alpha * (1.0 - own) + own;
    }
    ((sum / alpha).to_array(), alpha)
}

#[track_caller]
fn assert_shows(image: &Image, layers: &[[f32; 4]]) {
    let (color, alpha) = over(layers);
    assert_is(image.center(), color, alpha);
}

/// Walls at these depths, named in this order, each of the paint or glass with this index.
fn stack(materials: &[Material], walls: &[(f32, usize)]) -> Draft {
    let walls = walls.iter();
    Draft {
        meshes: walls
            .map(|&(z, material)| of_material(wall(z), material))
            .collect(),
        materials: materials.to_vec(),
        ..Draft::default()
    }
}

const RED_GLASS: [f32; 4] = [1.0, 0.0, 0.0, 0.25];
const GREEN_GLASS: [f32; 4] = [0.0, 1.0, 0.0, 0.5];
const WHITE_GLASS: [f32; 4] = [1.0, 1.0, 1.0, 0.4];
const BLUE: [f32; 4] = [0.0, 0.0, 1.0, 1.0];

#[test]
fn what_blends_is_laid_over_what_is_behind() {
    // Over nothing, its color stays its own.
    let Some(image) = seen("glass", single(glass([1.0, 0.5, 0.0, 0.25])), clear()) else {
        return;
    };
    assert_is(image.center(), [1.0, 0.5, 0.0], 0.25);

    // Named first and drawn last: an opaque wall behind shines through, one before hides it, and hides no pane before itself.
    let materials = [glass(RED_GLASS), painted(BLUE), glass(GREEN_GLASS)];
    for (name, walls, wanted) in [
        ("over", &[(0.0, 0), (-0.5, 1)][..], &[BLUE, RED_GLASS][..]),
        ("under", &[(0.0, 0), (0.5, 1)], &[BLUE]),
        (
            "around",
            &[(0.0, 0), (0.5, 2), (0.2, 1)],
            &[BLUE, GREEN_GLASS],
        ),
        (
            "panes",
            &[(0.0, 0), (0.2, 2), (-0.5, 1)],
            &[BLUE, RED_GLASS, GREEN_GLASS],
        ),
        (
            "panes_alone",
            &[(0.2, 2), (0.4, 0)],
            &[GREEN_GLASS, RED_GLASS],
        ),
    ] {
        let image = seen(name, stack(&materials, walls), clear()).expect("as before");
        assert_shows(&image, wanted);
    }
}

#[test]
fn panes_show_farthest_first_whatever_their_order_in_the_file() {
    let colors = [RED_GLASS, GREEN_GLASS, WHITE_GLASS];
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
        // The one with index 0 is the farthest.
        let walls = order.map(|index| (0.2 * index as f32, index));
        for (name, eye, count) in [
            ("two", 5.0, 2),
            ("two_from_behind", -5.0, 2),
            ("three", 5.0, 3),
            ("three_from_behind", -5.0, 3),
        ] {
            let from = Scene {
                samples,
                camera: camera([0.0, 0.0, eye]),
                ..clear()
            };
            let draft = stack(&colors.map(glass), &walls[..count]);
            let [a, b, c] = order;
            let Some(image) = seen(&format!("{name}_{a}{b}{c}_{samples:?}"), draft, from) else {
                return;
            };
            let mut farthest_first = order[..count].to_vec();
            farthest_first.sort_unstable();
            if eye < 0.0 {
                farthest_first.reverse();
            }
            let farthest_first = farthest_first.iter().map(|&index| colors[index]);
            assert_shows(&image, &farthest_first.collect::<Vec<_>>());
        }
    }
}

#[test]
fn panes_of_one_mesh_and_of_several_instances_are_sorted_together() {
    // Two panes of one mesh, with room for another between them and one before them.
    let [far, near] = [wall(-0.2), wall(0.2)];
    let part = |material| PartDraft {
        triangle_count: 2,
        material: Some(material),
        is_flat: false,
    };
    let both = MeshDraft {
        positions: [near.positions, far.positions].concat(),
        triangles: vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]],
        parts: vec![part(1), part(0)],
        ..MeshDraft::default()
    };
    let around = built(Draft {
        meshes: vec![both],
        materials: [RED_GLASS, GREEN_GLASS].map(glass).to_vec(),
        ..Draft::default()
    });
    let bare = built(Draft {
        joints: vec![JointDraft::default()],
        ..Draft::default()
    });
    let materials = [glass(WHITE_GLASS), glass(RED_GLASS), painted(BLUE)];
    let walls = [(0.0, 0), (0.4, 1), (-0.6, 2)];
    let between = built(stack(&materials, &walls));
    let wanted = [BLUE, RED_GLASS, WHITE_GLASS, GREEN_GLASS, RED_GLASS];
    for rigs in [[&around, &bare, &between], [&between, &bare, &around]] {
        let rigs = rigs.map(posed);
        let [first, ..] = &rigs;
        let mut plan = Plan::picture(Arc::clone(first), Skinning::Linear, clear(), 2.0);
        let instances = rigs.map(|posed| Instance::new(posed, Shape::Posed, Skinning::Linear));
        plan.instances = instances.to_vec();
        let Some(outputs) = run(&plan) else { return };
        let Outputs::Picture(frame) = outputs else {
            panic!("a picture was asked for");
        };
        let image = Image::from_bytes([SIDE as usize; 2], &frame.pixels);
        assert_shows(&image, &wanted);
    }
}

#[test]
fn a_pane_hides_nothing_where_its_texture_is_clear() {
    let half = texture(Encoding::Srgb, 2, |x, _| {
        [255, 255, 255, if x == 0 { 0 } else { 255 }]
    });
    let half_clear = Material {
        texture: Some(TexturePlace {
            wrap: [Wrap::Clamp; 2],
            ..TexturePlace::plain(half)
        }),
        ..glass(GREEN_GLASS)
    };
    let materials = [half_clear, glass(RED_GLASS), painted(BLUE)];
    let walls = [(0.2, 0), (0.0, 1), (-0.2, 2)];
    let [near, far, opaque] = walls;
    for (name, walls) in [
        ("clear_first", [near, far, opaque]),
        ("clear_last", [opaque, far, near]),
    ] {
        let Some(image) = seen(name, stack(&materials, &walls), clear()) else {
            return;
        };
        let (through, alpha) = over(&[BLUE, RED_GLASS]);
        assert_is(image.at(8, 32), through, alpha);
        let (all, alpha) = over(&[BLUE, RED_GLASS, GREEN_GLASS]);
        assert_is(image.at(56, 32), all, alpha);
    }
}

#[test]
fn panes_are_laid_over_each_other_sample_by_sample() {
    // Both end in the middle of a pixel: half of its samples see both, the others none.
    let mut draft = stack(&[RED_GLASS, GREEN_GLASS].map(glass), &[(0.2, 1), (0.0, 0)]);
    let corners = draft.meshes.iter_mut().flat_map(|mesh| &mut mesh.positions);
    corners.for_each(|corner| corner.x = corner.x.min(1.0 / SIDE as f32));
    let four = Scene {
        samples: Samples::Four,
        ..clear()
    };
    let Some(image) = seen("pane_edges", draft, four) else {
        return;
    };
    let (color, alpha) = over(&[RED_GLASS, GREEN_GLASS]);
    assert_is(image.at(31, 32), color, alpha);
    assert_is(image.at(32, 32), color, alpha / 2.0);
    assert_eq!(image.at(33, 32)[3], 0);
}

#[test]
fn a_single_sided_pane_shows_its_front_alone_unless_asked_for() {
    // One part, of which one wall faces the camera and one, named later, does not: what is drawn later is not hidden.
    let mesh = || MeshDraft {
        positions: [wall(-0.2), wall(0.2)].map(|wall| wall.positions).concat(),
        triangles: vec![[4, 5, 6], [0, 2, 1], [4, 6, 7], [0, 3, 2]],
        ..MeshDraft::default()
    };
    let pane = Material {
        is_single_sided: true,
        ..glass(GREEN_GLASS)
    };
    let draft = || Draft {
        meshes: vec![of_material(mesh(), 0), of_material(wall(0.4), 1)],
        materials: vec![pane.clone(), glass(RED_GLASS)],
        ..Draft::default()
    };
    for (name, cull, wanted) in [
        ("sided_pane", Cull::Auto, &[GREEN_GLASS, RED_GLASS][..]),
        (
            "both_panes",
            Cull::Never,
            &[GREEN_GLASS, GREEN_GLASS, RED_GLASS],
        ),
    ] {
        let Some(image) = seen(name, draft(), Scene { cull, ..clear() }) else {
            return;
        };
        assert_shows(&image, wanted);
    }
}

#[test]
fn of_a_translucent_skin_the_nearest_surface_alone_shows() {
    // Translucent where its material is opaque, and more so where it is not.
    let materials = [glass(RED_GLASS), painted(BLUE), glass(GREEN_GLASS)];
    for (name, walls, color, alpha) in [
        ("faint", &[(0.0, 1)][..], [0.0, 0.0, 1.0], 0.5),
        ("fainter", &[(0.0, 2)], [0.0, 1.0, 0.0], 0.25),
        ("faint_panes", &[(0.0, 0), (0.2, 2)], [0.0, 1.0, 0.0], 0.25),
        (
            "faint_panes_turned",
            &[(0.2, 2), (0.0, 0)],
            [0.0, 1.0, 0.0],
            0.25,
        ),
        (
            "faint_over_blue",
            &[(0.2, 2), (0.0, 1)],
            [0.0, 1.0, 0.0],
            0.25,
        ),
    ] {
        let scene = of_opacity(clear(), 0.5);
        let Some(image) = seen(name, stack(&materials, walls), scene) else {
            return;
        };
        assert_is(image.center(), color, alpha);
    }
}

#[test]
fn a_single_sided_wall_is_not_seen_from_behind_unless_asked_for() {
    let sided = || {
        single(Material {
            is_single_sided: true,
            ..painted([1.0, 0.0, 0.0, 1.0])
        })
    };
    let from = |z: f64, cull: Cull| Scene {
        camera: camera([0.0, 0.0, z]),
        cull,
        ..scene()
    };
    let Some(image) = seen("front", sided(), from(5.0, Cull::Auto)) else {
        return;
    };
    assert_is(image.center(), [1.0, 0.0, 0.0], 1.0);
    let image = seen("back", sided(), from(-5.0, Cull::Auto)).expect("as before");
    assert_is(image.center(), [0.0; 3], 1.0);
    let image = seen("back_too", sided(), from(-5.0, Cull::Never)).expect("as before");
    assert_is(image.center(), [1.0, 0.0, 0.0], 1.0);
}

#[test]
fn beyond_its_edges_a_texture_is_repeated_mirrored_or_held() {
    let corners = texture(Encoding::Srgb, 4, |x, y| {
        [
            if x < 2 { 255 } else { 0 },
            if y < 2 { 255 } else { 0 },
            0,
            255,
        ]
    });
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
    let wraps = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];
    for (u, v) in wraps.into_iter().flat_map(|u| wraps.map(|v| (u, v))) {
        let material = Material {
            texture: Some(TexturePlace {
                texture: Arc::clone(&corners),
                wrap: [u, v],
                picture_from_texcoord: thrice,
            }),
            ..material()
        };
        let name = format!("wrap_{u:?}_{v:?}");
        let Some(image) = seen(&name, single(material), scene()) else {
            return;
        };
        for (row, down) in halves(v).into_iter().enumerate() {
            for (column, across) in halves(u).into_iter().enumerate() {
                let middle = |half: usize| (SIDE as usize * (2 * half + 1)) / 12;
                let linear = [across, down, false].map(|is| f64::from(u8::from(is)));
                assert_is(image.at(middle(column), middle(row)), linear, 1.0);
            }
        }
    }
}

#[test]
fn a_normal_map_leans_red_to_the_right_and_green_up_on_its_picture() {
    let lit_from = |direction: [f64; 3]| Scene {
        lights: vec![
            Light::directional(-DVec3::from_array(direction), Color::WHITE, 1.0).expect("a light"),
        ],
        ambient: Color::constant(0.0, 0.0, 0.0),
        ..scene()
    };
    let mapped = |texel: [u8; 3], scale: f32, turned: TextureTransform| {
        let [r, g, b] = texel;
        let texture = texture(Encoding::Linear, 4, |_, _| [r, g, b, 255]);
        single(Material {
            normal_map: Some(NormalMap {
                place: TexturePlace {
                    picture_from_texcoord: turned,
                    ..TexturePlace::plain(texture)
                },
                scale,
            }),
            ..painted([1.0; 4])
        })
    };
    let straight = TextureTransform::IDENTITY;
    let mirrored = TextureTransform {
        columns: [-Vec2::X, Vec2::Y],
        offset: Vec2::X,
    };
    // The picture's right is the wall's up.
    let turned = TextureTransform {
        columns: [Vec2::Y, -Vec2::X],
        offset: Vec2::ZERO,
    };
    let slanted = std::f64::consts::FRAC_1_SQRT_2;
    let (right, left, up) = ([1.0, 0.0, 1.0], [-1.0, 0.0, 1.0], [0.0, 1.0, 1.0]);
    let lean = |x: f64, z: f64| (x + z) * slanted / x.hypot(z);
    for (name, texel, scale, transform, from, wanted) in [
        ("upright", [128, 128, 255], 1.0, straight, right, slanted),
        ("red", [255, 128, 255], 1.0, straight, right, 1.0),
        ("red_other", [255, 128, 255], 1.0, straight, left, 0.0),
        ("dark_red", [0, 128, 255], 1.0, straight, left, 1.0),
        ("green", [128, 255, 255], 1.0, straight, up, 1.0),
        ("dark_green", [128, 0, 255], 1.0, straight, up, 0.0),
        (
            "scaled",
            [255, 128, 255],
            0.5,
            straight,
            right,
            lean(0.5, 1.0),
        ),
        ("mirrored", [255, 128, 255], 1.0, mirrored, left, 1.0),
        ("mirrored_green", [128, 255, 255], 1.0, mirrored, up, 1.0),
        // A turn of the map such that (u, 1 − v) = (0, 1) lies at its right.
        ("turned", [255, 128, 255], 1.0, turned, [0.0, 1.0, 1.0], 1.0),
    ] {
        let Some(image) = seen(name, mapped(texel, scale, transform), lit_from(from)) else {
            return;
        };
        for (x, y) in [(32, 32), (3, 60), (50, 9)] {
            let found = f64::from(image.at(x, y)[0]);
            let off = (found - encoded(wanted)).abs();
            // 128 is not quite the middle.
            assert!(
                off <= 4.0 || (wanted == 0.0 && found <= 16.0),
                "{name}: {found}"
            );
        }
    }
}

#[test]
fn where_the_place_on_the_map_does_not_move_normals_stay() {
    let slanting = || {
        let look = LookAt {
            eye: DVec3::new(2.0, 1.0, 2.5),
            target: DVec3::ZERO,
            up: DVec3::Y,
            fov_y: Some(0.9),
            height: None,
            near: Near(None),
        };
        Scene {
            camera: Camera::look_at(look, &Bounds::ORIGIN, scene().size).expect("a camera"),
            lights: vec![Light::directional(DVec3::NEG_ONE, Color::WHITE, 1.0).expect("a light")],
            ambient: Color::constant(0.0, 0.0, 0.0),
            ..scene()
        }
    };
    let draft = |texcoord: fn(Vec2) -> Vec2, is_mapped: bool| {
        let red = texture(Encoding::Linear, 4, |_, _| [255, 128, 200, 255]);
        let map = NormalMap {
            place: TexturePlace::plain(red),
            scale: 1.0,
        };
        let mut draft = single(Material {
            normal_map: is_mapped.then_some(map),
            ..painted([1.0; 4])
        });
        let texcoords = draft.meshes[0].texcoords.as_mut().expect("the wall's");
        texcoords.iter_mut().for_each(|it| *it = texcoord(*it));
        draft
    };
    let Some(bare) = seen("bare", draft(|it| it, false), slanting()) else {
        return;
    };
    let moving = seen("moving", draft(|it| it, true), slanting()).expect("as before");
    assert!(moving.worst_difference(&bare) > 20);
    for (name, texcoord) in [
        ("a_point", (|_| Vec2::new(0.37, 0.61)) as fn(Vec2) -> Vec2),
        ("a_far_point", |_| Vec2::new(-70.3, 33.1)),
        ("a_line", |it| Vec2::new(it.x, 0.3)),
    ] {
        let image = seen(name, draft(texcoord, true), slanting()).expect("as before");
        assert!(image.worst_difference(&bare) <= 1, "{name}");
    }
}

#[test]
fn a_flat_part_is_lit_by_its_triangles() {
    let draft = |is_flat: bool| {
        let mut draft = single(painted([1.0; 4]));
        draft.meshes[0].normals = Some(vec![Vec3::new(1.0, 0.0, 0.2); 4]);
        draft.meshes[0].parts[0].is_flat = is_flat;
        draft
    };
    let ahead = || Scene {
        lights: vec![Light::directional(DVec3::NEG_Z, Color::WHITE, 1.0).expect("a light")],
        ambient: Color::constant(0.0, 0.0, 0.0),
        ..scene()
    };
    let Some(image) = seen("flat", draft(true), ahead()) else {
        return;
    };
    assert_is(image.center(), [1.0; 3], 1.0);
    let image = seen("smooth", draft(false), ahead()).expect("as before");
    assert_is(image.center(), [0.2 / 1.0f64.hypot(0.2); 3], 1.0);
}

/// As many triangles as there are meshes, each on a joint of its own, of three or four vertices by turns, in rows of eight.
fn crowd(count: usize) -> Draft {
    let place = |index: usize| Vec3::new((index % 8) as f32, (index / 8) as f32, 0.0);
    let joint = |index: usize| JointDraft {
        name: format!("j{index}"),
        offset: place(index).as_dvec3(),
        ..JointDraft::default()
    };
    let mesh = |index: usize| {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(0.5, 0.5, 0.0)];
        let vertices = 3 + index % 2;
        MeshDraft {
            positions: corners[..vertices].to_vec(),
            texcoords: index.is_multiple_of(3).then(|| vec![Vec2::ZERO; vertices]),
            influence_counts: vec![1; vertices],
            influences: vec![(index as u32, 1.0); vertices],
            triangles: vec![[0, 1, 2]],
            ..MeshDraft::default()
        }
    };
    let binding = |index| BindingDraft {
        joint: Some(index),
        stood: BindPose::JointFromBind(DAffine3::IDENTITY),
    };
    Draft {
        joints: (0..count).map(joint).collect(),
        meshes: (0..count).map(mesh).collect(),
        bindings: (0..count).map(binding).collect(),
        morphs: vec![MorphDraft {
            name: "lift".to_owned(),
            mesh: 7,
            positions: vec![(3, Vec3::new(0.5, 0.5, 2.0))],
            rest: 1.0,
            ..MorphDraft::default()
        }],
        ..Draft::default()
    }
}

#[test]
fn each_of_many_meshes_follows_its_own_joint_and_is_found_again() {
    let rig = built(crowd(59));
    let all: Vec<usize> = (0..59).collect();
    for meshes in [&all[..], &[3], &[58], &[5, 6, 7, 20, 41, 42]] {
        let query = |&mesh: &usize| VertexQuery {
            mesh,
            start: 1,
            count: rig.meshes()[mesh].vertex_count() - 1,
            positions: true,
            normals: true,
        };
        let queries = meshes.iter().map(query).collect();
        let plan = Plan::vertices(posed(&rig), Skinning::Linear, Shape::Posed, queries);
        let Some(outputs) = run(&plan) else { return };
        let Outputs::Vertices(found) = outputs else {
            panic!("vertices were asked for");
        };
        for (&mesh, found) in meshes.iter().zip(&found) {
            let place = Vec3::new((mesh % 8) as f32, (mesh / 8) as f32, 0.0);
            let lifted = |vertex: usize| if (mesh, vertex) == (7, 3) { 2.0 } else { 0.0 };
            let own = rig.meshes()[mesh].positions().iter().enumerate();
            let wanted = own.map(|(vertex, p)| *p + place + Vec3::Z * lifted(vertex));
            let wanted: Vec<f32> = wanted.skip(1).flat_map(|p| p.to_array()).collect();
            assert_eq!(found.positions.as_deref(), Some(&wanted[..]), "mesh {mesh}");
            let normals = found.normals.as_deref().expect("asked for").chunks(3);
            let own = rig.meshes()[mesh].normals().iter().skip(1);
            let off = normals
                .zip(own)
                .map(|(n, own)| own.distance(Vec3::from_slice(n)));
            assert!(off.fold(0.0, f32::max) < 1e-6, "mesh {mesh}");
        }
    }
}

#[test]
fn a_crowd_of_meshes_is_drawn_where_it_stands() {
    let look = LookAt {
        eye: DVec3::new(4.0, 4.0, 10.0),
        target: DVec3::new(4.0, 4.0, 0.0),
        up: DVec3::Y,
        fov_y: None,
        height: Some(8.0),
        near: Near(None),
    };
    let size = scene().size;
    let crowded = Scene {
        camera: Camera::look_at(look, &Bounds::ORIGIN, size).expect("a camera"),
        surface: Surface {
            diffuse: Some(Color::WHITE),
            ..scene().surface
        },
        ..scene()
    };
    let Some(image) = seen("crowd", crowd(59), crowded) else {
        return;
    };
    for index in 0..64 {
        // Eight pixels to a mesh, counted from below.
        let (x, y) = (8 * (index % 8) + 2, 63 - 8 * (index / 8) - 2);
        let wanted = f64::from(u8::from(index < 59));
        assert_is(image.at(x, y), [wanted; 3], 1.0);
        assert_is(image.at(x + 4, y - 4), [0.0; 3], 1.0);
    }
}

#[test]
fn a_texture_that_two_materials_wear_takes_memory_once() {
    let large = || texture(Encoding::Srgb, 256, |x, _| [x as u8, 0, 0, 255]);
    let two = |first: Arc<Texture>, second: Arc<Texture>| {
        let dressed = |texture: Arc<Texture>, red: f32| Material {
            texture: plain(texture),
            ..painted([red, 1.0, 1.0, 1.0])
        };
        Draft {
            meshes: vec![of_material(wall(0.0), 0), of_material(wall(0.1), 1)],
            materials: vec![dressed(first, 0.5), dressed(second, 0.25)],
            ..Draft::default()
        }
    };
    // A device of its own, as others draw on the shared one meanwhile.
    let Some(mut gpu) = support::adapters::gpu_on(&support::adapters::wgpu_adapter()) else {
        return;
    };
    let mut grown_by = |draft: Draft| {
        let before = gpu.memory_bytes();
        let rig = built(draft);
        let plan = Plan::picture(posed(&rig), Skinning::Linear, scene(), 2.0);
        let in_flight = gpu.submit(&[&plan]).expect("room");
        gpu.finish(in_flight).expect("a picture");
        let grown = gpu.memory_bytes() - before;
        drop((plan, rig));
        gpu.sweep();
        grown
    };
    // The first picture makes what the others find.
    grown_by(two(large(), large()));
    let apart = grown_by(two(large(), large()));
    let same = large();
    let shared = grown_by(two(Arc::clone(&same), Arc::clone(&same)));
    assert_eq!(apart - shared, same.memory_bytes() as u64);
}
