//! Does the graphics device do what only it can: take memory, and go away? Where there is no Vulkan adapter, these tests say so and pass.

mod support;

use rigd::engine::{Engine, EngineError, LoadedRig, Terms, Urgency};
use rigd::formats::Source;
use rigd::frame::Outputs;
use rigd::limits::Limits;
use rigd::pose::{Pose, PoseEdit, Posed, Skinning};
use rigd::render::Plan;
use rigd::render::gpu::Gpu;
use rigd::scene::{
    Background, Camera, Cull, Light, Orbit, Samples, Scene, Shape, Show, ShowNormals, ShowSkeleton,
    ShowSkin, Size, Surface, VertexQuery,
};
use serde_json::json;
use std::sync::Arc;
use std::sync::mpsc::channel;
use support::shot::Shot;
use support::{ask, ask_ok};

#[test]
fn a_lost_device_is_opened_again() {
    let Some(service) = support::service_on("vulkan") else {
        return;
    };
    let draw = || {
        ask(
            &service,
            "frame.render",
            json!({"rig": "figure", "size": [16, 16]}),
        )
    };
    let wanted = draw().expect("a picture")["images"]["color"]["data"].take();
    let mut lost = 0;
    for _ in 0..3 {
        service.engine().lose_device();
        // The next request may be the one that finds out.
        if let Err(error) = draw() {
            assert_eq!(
                (error.code, error.data.kind.as_str()),
                (-32006, "device_lost")
            );
            assert!(error.data.retryable);
            lost += 1;
        }
        let again = draw().expect("the device is there again");
        assert!(
            again["images"]["color"]["data"] == wanted,
            "another picture than before"
        );
        ask_ok(&service, "mesh.vertices", json!({"rig": "figure"}));
    }
    println!("{lost} of 3 losses were noticed by a request");
}

#[test]
fn memory_of_the_device_is_told() {
    let Some(service) = support::service_on("vulkan") else {
        return;
    };
    ask_ok(&service, "frame.render", json!({"rig": "figure"}));
    let stats = ask_ok(&service, "server.stats", json!({}));
    let held = stats["memory"]["gpu_bytes"].as_u64().expect("a number");
    assert!(held > 0);
}

/// The figure's plans of every kind: of pictures that differ in size, samples, layers and what they show, and of vertices, some of them
/// in the same pose.
fn mixed_plans(rig: &LoadedRig) -> Vec<Plan> {
    let limits = Limits::default();
    let posed = |bend: f64| {
        let dofs = rig.rig.dofs().all().iter().enumerate();
        let bent = dofs.filter(|(_, dof)| dof.name.ends_with(".rx") || dof.name == "morph.smile");
        let edit = PoseEdit {
            dofs: bent.map(|(dof, _)| (dof, bend)).collect(),
            ..PoseEdit::default()
        };
        let (pose, _) = Pose::rest(&rig.rig).edited(&edit).expect("clamped");
        Arc::new(Posed::new(&pose).expect("a small pose"))
    };
    let poses = [posed(0.0), posed(0.2), posed(-0.3)];
    let picture =
        |index: usize, side: u32, samples: Samples, skeleton: ShowSkeleton, opacity: f64| {
            let size = Size::new(side, side + 1, &limits).expect("a small size");
            let orbit = Orbit {
                azimuth: Some(index as f64),
                ..Orbit::default()
            };
            let show = Show::new(ShowSkin::Posed, skeleton, ShowNormals::Smooth, opacity);
            let scene = Shot {
                size,
                samples,
                camera: Camera::orbit(orbit, &rig.extents.bounds(), size).expect("a camera"),
                lights: Light::default_pair(),
                ambient: Scene::DEFAULT_AMBIENT,
                surface: Surface::default(),
                background: Background::default(),
                show: show.expect("an opacity"),
                cull: Cull::Auto,
            };
            let skinning = [Skinning::Linear, Skinning::DualQuaternion][index % 2];
            let posed = Arc::clone(&poses[index % poses.len()]);
            scene.plan(posed, skinning, rig.extents.bounds().size())
        };
    let vertices = |index: usize, start: usize, count: usize, positions: bool, normals: bool| {
        let query = VertexQuery {
            instance: 0,
            mesh: 0,
            start,
            count,
            positions,
            normals,
        };
        let posed = Arc::clone(&poses[index % poses.len()]);
        Plan::vertices(posed, Skinning::Linear, Shape::Posed, vec![query, query])
    };
    let all = rig.rig.meshes()[0].vertex_count();
    use ShowSkeleton::{Boxes, Cylinders, None, Sticks, Wireframe};
    vec![
        vertices(0, 17, 5, true, false),
        picture(0, 40, Samples::Four, None, 1.0),
        picture(6, 40, Samples::Four, Wireframe, 1.0),
        picture(1, 40, Samples::One, Boxes, 0.5),
        vertices(1, 0, all, true, true),
        picture(2, 64, Samples::Four, Sticks, 0.3),
        picture(3, 40, Samples::Four, Wireframe, 0.0),
        vertices(2, 3, 0, true, true),
        picture(4, 33, Samples::One, Cylinders, 1.0),
        picture(5, 40, Samples::Four, Sticks, 1.0),
        vertices(0, all - 1, 1, false, true),
    ]
}

/// An engine on this adapter, and the figure; `None` where there is no such adapter.
fn figure_on(adapter: &str) -> Option<(Engine, Arc<LoadedRig>)> {
    let engine = support::adapters::engine_on(adapter, Limits::default())?;
    let rig = engine.load(None, &rigd::cli::figure(), &Source::inline_only(), false);
    Some((engine, rig.expect("the built-in figure loads")))
}

#[test]
fn plans_that_share_a_submission_give_what_each_gives_alone() {
    let Some(mut gpu) = support::adapters::gpu_on("vulkan") else {
        return;
    };
    let (_, rig) = figure_on("cpu").expect("it needs no adapter");
    let plans = mixed_plans(&rig);
    let plans: Vec<&Plan> = plans.iter().collect();
    assert_eq!(gpu.fitting(&plans), plans.len());
    assert_eq!(gpu.fitting(&[plans[1]; 40]), 16, "a submission is bounded");
    let run = |gpu: &mut Gpu, plans: &[&Plan]| {
        let in_flight = gpu.submit(plans).expect("room");
        gpu.finish(in_flight).expect("outputs")
    };
    let alone: Vec<Outputs> = plans
        .iter()
        .flat_map(|plan| run(&mut gpu, &[plan]).outputs)
        .collect();
    for (index, one) in alone.iter().enumerate() {
        let others = alone[index + 1..].iter();
        assert!(
            others.clone().all(|other| other != one),
            "{index} is like another"
        );
    }
    let differing = |found: &[Outputs], wanted: &[Outputs]| -> Vec<usize> {
        assert_eq!(found.len(), wanted.len());
        (0..wanted.len())
            .filter(|&index| found[index] != wanted[index])
            .collect()
    };
    let together = run(&mut gpu, &plans);
    assert_eq!(differing(&together.outputs, &alone), [0; 0]);
    if let Some(device_time) = together.device_time {
        assert!(
            !device_time.is_zero() && device_time.as_secs() < 60,
            "{device_time:?}"
        );
    }
    // Several on their way at once, in other company.
    let parts = [&plans[..4], &plans[4..], &plans[2..7]];
    let in_flight = parts.map(|part| gpu.submit(part).expect("room"));
    let finished = in_flight.map(|in_flight| gpu.finish(in_flight).expect("outputs").outputs);
    for (found, wanted) in finished
        .iter()
        .zip([&alone[..4], &alone[4..], &alone[2..7]])
    {
        assert_eq!(differing(found, wanted), [0; 0]);
    }
}

#[test]
fn a_plan_that_is_refused_takes_no_other_with_it() {
    let Some((engine, rig)) = figure_on("vulkan") else {
        return;
    };
    let (sender, answers) = channel();
    let posed = Arc::new(Posed::new(&Pose::rest(&rig.rig)).expect("the rest pose"));
    let ask = |index: usize, count: usize| {
        let query = VertexQuery {
            instance: 0,
            mesh: 0,
            start: 0,
            count,
            positions: true,
            normals: false,
        };
        let ticket = engine.admission().admit().expect("room");
        let terms = Terms {
            urgency: Urgency::default(),
            ticket,
        };
        let sender = sender.clone();
        let done = move |result: Result<(Vec<_>, _), EngineError>| {
            sender
                .send((index, result.map(|_| ())))
                .expect("the test waits");
        };
        engine.vertices(
            Arc::clone(&posed),
            Skinning::Linear,
            Shape::Posed,
            vec![query],
            terms,
            done,
        );
    };
    // What no request can ask for: more vertices than there are.
    let (all, broken) = (60, 30);
    (0..all).for_each(|index| ask(index, if index == broken { 5_000_000 } else { 10 }));
    for _ in 0..all {
        let (index, result) = answers.recv().expect("an answer");
        match result {
            Err(EngineError::Internal { .. }) => assert_eq!(index, broken),
            Err(error) => panic!("{index}: {error}"),
            Ok(()) => assert_ne!(index, broken),
        }
    }
    drop(sender);
    assert!(answers.recv().is_err(), "each is answered once");
}
