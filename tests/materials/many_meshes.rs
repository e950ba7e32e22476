//! Rigs of many meshes, and several in one picture.

use super::{
    Pixel, assert_shown, before, blending, drawn, gpu, over, small,
    support::quads::{draft, painted, quad, scene},
};
use glam::{DAffine3, DVec3, Vec2, Vec3};
use rigd::frame::Outputs;
use rigd::limits::Limits;
use rigd::pose::{Pose, Posed, Skinning};
use rigd::render::cpu::{Cores, Cpu, Parallelism};
use rigd::render::{Instance, Plan, Skin};
use rigd::rig::{BindPose, BindingDraft, Draft, JointDraft, MeshDraft, MorphDraft};
use rigd::scene::{Bounds, Camera, LookAt, Near, Samples, Shape, VertexQuery};
use std::sync::Arc;

fn posed(draft: Draft) -> Arc<Posed> {
    let rig = Arc::new(draft.build(&Limits::default()).expect("a rig"));
    Arc::new(Posed::new(&Pose::rest(&rig)).expect("a pose"))
}

#[test]
fn panes_of_one_mesh_and_of_several_instances_are_sorted_together() {
    let color = |[r, g, b, a]: [f64; 4]| [r, g, b, a].map(|channel| channel as f32);
    let (red, green) = ([1.0, 0.0, 0.0, 0.25], [0.0, 1.0, 0.0, 0.5]);
    let (white, blue) = ([1.0, 1.0, 1.0, 0.4], [0.0, 0.0, 1.0, 1.0]);
    let pane = |z: f32, layer: [f64; 4]| super::at(z, quad(blending(color(layer))));
    // Two panes of one mesh, with room for another between them and one before them; the nearer is named first.
    let mut around = draft(&[pane(0.2, green), pane(-0.2, red)]);
    let far = around.meshes.remove(1);
    let both = &mut around.meshes[0];
    both.positions.extend(far.positions);
    both.normals = None;
    both.texcoords = None;
    both.triangles.extend([[4, 5, 6], [4, 6, 7]]);
    both.parts.extend(far.parts);
    let bare = Draft {
        joints: vec![JointDraft::default()],
        ..Draft::default()
    };
    let wall = super::at(-0.6, quad(painted(color(blue))));
    let between = draft(&[pane(0.0, white), pane(0.4, red), wall]);
    let [around, bare, between] = [around, bare, between].map(posed);
    let wanted = over(&[blue, red, white, green, red]);
    for rigs in [[&around, &bare, &between], [&between, &bare, &around]] {
        let scene = before([0.0; 4], small());
        let (_, appearance) = scene.clone().split();
        let mut plan = scene.plan(Arc::clone(rigs[0]), Skinning::Linear, 2.0);
        let instance = |posed: &Arc<Posed>| {
            let posed = Arc::clone(posed);
            if posed.rig().vertex_count() == 0 {
                // Shown, it would be a skeleton.
                return Instance::new(Skin::new(posed, Shape::Posed, Skinning::Linear));
            }
            Instance::shown(posed, Skinning::Linear, appearance, 2.0)
        };
        plan.instances = rigs.map(instance).to_vec();
        for (renderer, image) in drawn(&plan) {
            let found = image.center();
            let off = found.iter().zip(wanted).map(|(a, b)| a.abs_diff(b)).max();
            assert!(off <= Some(1), "{renderer}: {found:?}, not {wanted:?}");
        }
    }
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
        file: None,
        bind_pose: BindPose::JointFromBind(DAffine3::IDENTITY),
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

fn vertices(plan: &Plan) -> Vec<(&'static str, Outputs)> {
    let own = Cpu::default().render(plan, Parallelism::uncancelled(Cores::One));
    let by_wgpu = gpu().map(|mut gpu| {
        let in_flight = gpu.submit(&[plan]).expect("room");
        let finished = gpu.finish(in_flight).expect("vertices");
        (
            "wgpu",
            finished.outputs.into_iter().next().expect("of one plan"),
        )
    });
    let own = ("cpu", own.expect("it is wanted"));
    std::iter::once(own).chain(by_wgpu).collect()
}

#[test]
fn each_of_many_meshes_follows_its_own_joint_and_is_found_again() {
    let posed = posed(crowd(59));
    let rig = posed.rig();
    let all: Vec<usize> = (0..59).collect();
    for meshes in [&all[..], &[3], &[58], &[5, 6, 7, 20, 41, 42]] {
        let query = |&mesh: &usize| VertexQuery {
            instance: 0,
            mesh,
            start: 1,
            count: rig.meshes()[mesh].vertex_count() - 1,
            positions: true,
            normals: true,
        };
        let queries = meshes.iter().map(query).collect();
        let plan = Plan::vertices(Arc::clone(&posed), Skinning::Linear, Shape::Posed, queries);
        for (renderer, outputs) in vertices(&plan) {
            for (&mesh, found) in meshes.iter().zip(&outputs.vertices) {
                let place = Vec3::new((mesh % 8) as f32, (mesh / 8) as f32, 0.0);
                let lifted = |vertex: usize| if (mesh, vertex) == (7, 3) { 2.0 } else { 0.0 };
                let own = rig.meshes()[mesh].positions().iter().enumerate();
                let wanted = own.map(|(vertex, p)| *p + place + Vec3::Z * lifted(vertex));
                let wanted: Vec<f32> = wanted.skip(1).flat_map(|p| p.to_array()).collect();
                let positions = found.positions.as_deref().map(Vec::as_slice);
                assert_eq!(positions, Some(&wanted[..]), "mesh {mesh}, {renderer}");
                let normals = found.normals.as_deref().expect("asked for").chunks(3);
                let own = rig.meshes()[mesh].normals().iter().skip(1);
                let off = normals
                    .zip(own)
                    .map(|(n, own)| own.distance(Vec3::from_slice(n)));
                assert!(off.fold(0.0, f32::max) < 1e-6, "mesh {mesh}, {renderer}");
            }
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
    let bounds = Bounds {
        min: DVec3::ZERO,
        max: DVec3::splat(8.0),
    };
    let mut scene = scene([64, 64], Samples::One);
    scene.camera = Camera::look_at(look, &bounds, scene.size).expect("a camera");
    let white = rigd::scene::Surface::new(Some(rigd::scene::Color::WHITE), None, None);
    scene.surface = white.expect("a surface");
    let wanted = (0..64).flat_map(|index| -> [Pixel; 2] {
        // Eight pixels to a mesh, counted from below.
        let (x, y) = (8 * (index % 8) + 2, 63 - 8 * (index / 8) - 2);
        let color = if index < 59 {
            super::WHITE
        } else {
            super::BLACK
        };
        [([x, y], color), ([x + 4, y - 4], super::BLACK)]
    });
    assert_shown("a crowd", crowd(59), scene, wanted);
}
