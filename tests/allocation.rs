//! Does drawing ask for memory once it is warm? rigd's own renderer keeps its scratch memory from picture to picture. And does parsing ask
//! for more than what it gives?

mod support;

use allocation_counter::{AllocationInfo, measure};
use rigd::formats::{self, Source};
use rigd::limits::Limits;
use rigd::pose::{Pose, PoseEdit, Posed, Skinning};
use rigd::protocol;
use rigd::protocol::frame::FrameParams;
use rigd::protocol::pose::PoseSetParams;
use rigd::render::Plan;
use rigd::render::cpu::{Cores, Cpu, Parallelism};
use rigd::rig::{Material, Opacity, Rig};
use rigd::scene::{
    Background, Bounds, Camera, Color, Cull, Light, Orbit, Samples, Show, ShowNormals,
    ShowSkeleton, ShowSkin, Size, Surface,
};
use std::sync::Arc;
use support::quads::{Quad, painted, quad, scene};
use support::shot::Shot;

/// The figure in another pose each time, in pictures of several sizes and kinds.
fn plan(rig: &Arc<Rig>, index: usize) -> Plan {
    let turn = 0.3 * (index as f64).sin();
    let edit = PoseEdit {
        dofs: (6..12).map(|dof| (dof, turn)).collect(),
        ..PoseEdit::default()
    };
    let (pose, _) = Pose::rest(rig).edited(&edit).expect("clamped");
    let posed = Arc::new(Posed::new(&pose).expect("a small pose"));
    let side = [64, 200, 131][index % 3];
    let size = Size {
        width: side,
        height: side,
    };
    let bounds = Bounds {
        min: glam::DVec3::new(-0.8, 0.0, -0.3),
        max: glam::DVec3::new(0.8, 1.8, 0.3),
    };
    let skeleton = [
        ShowSkeleton::None,
        ShowSkeleton::Sticks,
        ShowSkeleton::Wireframe,
    ][index % 3];
    let opacity = [1.0, 0.5][index % 2];
    let scene = Shot {
        size,
        samples: [Samples::Four, Samples::One][index % 2],
        camera: Camera::orbit(Orbit::default(), &bounds, size).expect("a camera"),
        lights: Light::default_pair(),
        ambient: Color::constant(0.1, 0.1, 0.1),
        surface: Surface::default(),
        background: Background::default(),
        show: Show::new(ShowSkin::Posed, skeleton, ShowNormals::Smooth, opacity)
            .expect("an opacity"),
        cull: Cull::Auto,
    };
    scene.plan(posed, Skinning::Linear, bounds.size())
}

/// What comes out of a renderer, and surfaces, materials and meshes of a picture: short lists, of which none grows.
const LISTS: u64 = 4;

fn allocations(cpu: &Cpu, plan: &Plan) -> AllocationInfo {
    measure(
        || match cpu.render(plan, Parallelism::uncancelled(Cores::One)) {
            Some(outputs) => assert!(!outputs.images[0].bytes.is_empty()),
            None => unreachable!("it is wanted"),
        },
    )
}

#[test]
fn a_warm_renderer_asks_for_no_memory_but_short_lists() {
    let files = rigd::cli::figure();
    let loaded = formats::load(&files, &Source::inline_only(), &Limits::default());
    let rig = Arc::new(loaded.expect("the figure").rig);
    let cpu = Cpu::default();
    let plans: Vec<Plan> = (0..12).map(|index| plan(&rig, index)).collect();
    let cold = allocations(&cpu, &plans[0]);
    // Or the counter counts nothing.
    assert!(cold.count_total > 10, "{cold:?}");
    for plan in &plans {
        allocations(&cpu, plan);
    }
    for (index, plan) in plans.iter().enumerate() {
        let warm = allocations(&cpu, plan);
        assert_eq!(warm.count_total, LISTS, "picture {index}: {warm:?}");
    }
}

#[test]
fn neither_does_it_for_coats() {
    let pane = Material {
        opacity: Opacity::Blend,
        ..painted([1.0, 0.5, 0.2, 0.5])
    };
    let mask = Material {
        opacity: Opacity::Mask(0.5),
        ..painted([1.0; 4])
    };
    let draft = support::quads::draft(&[quad(mask), quad(pane), quad(painted([0.5; 4]))]);
    let plan = support::quads::plan(draft, scene([200, 100], Samples::Four));
    let cpu = Cpu::default();
    assert!(allocations(&cpu, &plan).count_total > 10);
    let warm = allocations(&cpu, &plan);
    assert_eq!(warm.count_total, LISTS, "{warm:?}");
}

#[test]
fn neither_does_it_for_many_parts_that_blend() {
    let pane = |index| Quad {
        z: 0.001 * (index % 70) as f32,
        ..quad(blending())
    };
    let panes: Vec<Quad> = (0..200).map(pane).collect();
    let draft = support::quads::draft(&panes);
    let plan = support::quads::plan(draft, scene([100, 50], Samples::Four));
    let cpu = Cpu::default();
    assert!(allocations(&cpu, &plan).count_total > 10);
    let warm = allocations(&cpu, &plan);
    assert_eq!(warm.count_total, LISTS, "{warm:?}");
}

#[test]
fn what_blends_over_all_of_a_picture_asks_for_little() {
    let mut draft = support::quads::draft(&[quad(blending())]);
    let count = 1000;
    let mesh = &mut draft.meshes[0];
    mesh.triangles = mesh.triangles.repeat(count);
    mesh.parts[0].triangle_count *= count;
    let plan = support::quads::plan(draft, scene([64, 64], Samples::Four));
    let cold = allocations(&Cpu::default(), &plan);
    // Some four million pixels are laid over each other; each kept, they would be 32 MiB.
    assert!(cold.bytes_max < 4 << 20, "{cold:?}");
}

fn allocations_of_parsing<T: serde::de::DeserializeOwned>(text: &str) -> u64 {
    let raw = serde_json::value::RawValue::from_string(text.to_owned()).expect("JSON");
    let parse = || assert!(protocol::params::<T>(Some(&raw)).is_ok());
    measure(parse).count_total
}

#[test]
fn parsing_asks_for_no_memory_but_what_it_gives() {
    let text = r#"{
        "rig": "a", "camera": {"kind": "orbit", "azimuth": 1, "fov_y": 0.5}, "ambient": [0, 0, 0], "size": [64, 64], "samples": 1,
        "show": {"skin": "bind", "skin_opacity": 0.5}, "material": {"shininess": 3}, "background": [0, 0, 0, 1], "image": "rgba8"
    }"#;
    // The name of the rig, and the list of outputs once there are several to choose from.
    let whole = allocations_of_parsing::<FrameParams>(text);
    assert!((1..=2).contains(&whole), "{whole}");
    let pose = |count: usize| {
        let dofs: Vec<String> = (0..count)
            .map(|dof| format!(r#""joint_{dof:03}.rx": {dof}"#))
            .collect();
        let text = format!(
            r#"{{"rig": "a", "pose": {{"dofs": {{{}}}}}}}"#,
            dofs.join(",")
        );
        allocations_of_parsing::<PoseSetParams>(&text)
    };
    let (few, many) = (pose(100), pose(200));
    // Each name once, and the nodes of two trees: of the values, and of the names seen so far.
    assert!((100..150).contains(&(many - few)), "{few} and {many}");
}

fn blending() -> Material {
    Material {
        opacity: Opacity::Blend,
        ..painted([1.0, 0.5, 0.2, 0.5])
    }
}
