//! Several characters of one plan: where they stand, how each looks, and vertices beside a picture, by both renderers.

mod support;

use glam::{DAffine3, DMat3, DVec3, Vec2, Vec3};
use rigd::frame::Outputs;
use rigd::pose::{Pose, Posed, Skinning};
use rigd::render::cpu::{Cores, Cpu, Parallelism};
use rigd::render::{ImagePlan, Instance, Plan};
use rigd::scene::{
    Appearance, Bounds, Camera, Color, Light, LookAt, Near, Samples, Show, ShowSkeleton, Surface,
    VertexQuery,
};
use std::sync::Arc;
use support::pictures::Image;
use support::quads::{self, Quad, painted, quad};
use support::shot::Shot;

/// Two slanted walls, one red and one behind it that is blue, so that no side looks like another.
fn posed() -> Arc<Posed> {
    let red = Quad {
        reach: [Vec2::new(-0.3, -0.2), Vec2::new(0.1, 0.3)],
        z: 0.1,
        normal: Vec3::new(0.6, 0.0, 0.8),
        ..quad(painted([0.9, 0.1, 0.1, 1.0]))
    };
    let blue = Quad {
        reach: [Vec2::new(-0.1, -0.3), Vec2::new(0.3, 0.1)],
        normal: Vec3::new(0.0, 0.6, 0.8),
        ..quad(painted([0.1, 0.2, 0.9, 1.0]))
    };
    let draft = quads::draft(&[red, blue]);
    let rig = Arc::new(draft.build(&Default::default()).expect("a rig"));
    Arc::new(Posed::new(&Pose::rest(&rig)).expect("a pose"))
}

fn looking(eye: DVec3, target: DVec3, up: DVec3, travelling: DVec3) -> Shot {
    let mut shot = quads::scene([120, 90], Samples::Four);
    let look = LookAt {
        eye,
        target,
        up,
        fov_y: Some(0.5),
        height: None,
        near: Near(Some(0.01)),
    };
    shot.camera = Camera::look_at(look, &Bounds::ORIGIN, shot.size).expect("a camera");
    shot.ambient = Color::constant(0.1, 0.1, 0.1);
    let light = Light::directional(travelling, Color::WHITE, 1.0).expect("a light");
    shot.lights = vec![light];
    shot
}

fn straight() -> Shot {
    let toward = DVec3::new(-0.5, -0.3, -0.8);
    looking(DVec3::new(0.3, 0.2, 3.0), DVec3::ZERO, DVec3::Y, toward)
}

fn plan(shot: &Shot, instances: Vec<Instance>) -> Plan {
    let (scene, _) = shot.clone().split();
    let outputs = [rigd::frame::ImageKind::Color].into();
    Plan {
        instances,
        image: Some(ImagePlan { scene, outputs }),
        vertices: Vec::new(),
    }
}

fn shown(posed: &Arc<Posed>, appearance: Appearance) -> Instance {
    Instance::shown(Arc::clone(posed), Skinning::Linear, appearance, 1.0)
}

fn drawn(plan: &Plan) -> Image {
    quads::own(plan, Cores::One)
}

/// The share of pixels of which a channel differs by more than rounding.
fn differing(one: &Image, other: &Image) -> f64 {
    let pixels = one.pixels.iter().zip(&other.pixels);
    let differs = |(one, other): &(&[u8; 4], &[u8; 4])| {
        one.iter()
            .zip(*other)
            .any(|(one, other)| one.abs_diff(*other) > 1)
    };
    pixels.filter(differs).count() as f64 / one.pixels.len() as f64
}

#[test]
fn a_character_that_is_moved_looks_as_if_camera_and_lights_were_moved_back() {
    let posed = posed();
    let turned = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize_or(DVec3::Z), 0.8);
    let moved = DVec3::new(1.5, -0.4, 2.0);
    let (eye, toward) = (DVec3::new(0.3, 0.2, 3.0), DVec3::new(-0.5, -0.3, -0.8));
    let still = drawn(&plan(
        &straight(),
        vec![shown(&posed, Appearance::default())],
    ));
    for scale in [1.0, 0.25] {
        let world_from_model = DAffine3::from_mat3_translation(turned * scale, moved);
        let camera = looking(
            world_from_model.transform_point3(eye),
            moved,
            turned * DVec3::Y,
            turned * toward,
        );
        let instance = shown(&posed, Appearance::default());
        let unmoved = drawn(&plan(&camera, vec![instance.clone()]));
        let found = drawn(&plan(&camera, vec![instance.placed(world_from_model)]));
        let share = differing(&found, &still);
        assert!(share < 0.002, "scale {scale}: {share}");
        assert!(differing(&unmoved, &still) > 0.02, "the camera did move");
    }
}

#[test]
fn a_mirrored_character_is_the_mirror_image() {
    let posed = posed();
    let from_ahead =
        |travelling| looking(DVec3::new(0.0, 0.2, 3.0), DVec3::ZERO, DVec3::Y, travelling);
    let still = plan(
        &from_ahead(DVec3::new(-0.5, -0.3, -0.8)),
        vec![shown(&posed, Appearance::default())],
    );
    let mirror = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    let mirrored = plan(
        &from_ahead(DVec3::new(0.5, -0.3, -0.8)),
        vec![shown(&posed, Appearance::default()).placed(mirror)],
    );
    let (still, mirrored) = (drawn(&still), drawn(&mirrored));
    let rows = still.pixels.chunks(still.width);
    let flipped = rows.flat_map(|row| row.iter().rev().copied()).collect();
    let flipped = Image {
        pixels: flipped,
        ..still.clone()
    };
    // Edges that lie on a sample belong to the other side.
    let share = differing(&mirrored, &flipped);
    assert!(share < 0.005, "{share}");
    assert!(differing(&mirrored, &still) > 0.02);
}

#[test]
fn characters_apart_give_the_pixels_of_each_alone() {
    let posed = posed();
    let at = |x: f64| DAffine3::from_translation(DVec3::new(x, 0.0, 0.0));
    let gold = Appearance {
        surface: Surface::new(
            Some(Color::constant(0.9, 0.7, 0.1)),
            Some(Color::WHITE),
            Some(5.0),
        )
        .expect("a surface"),
        show: Show::new(
            Default::default(),
            ShowSkeleton::None,
            rigd::scene::ShowNormals::Flat,
            1.0,
        )
        .expect("an opacity"),
        ..Appearance::default()
    };
    let left = shown(&posed, Appearance::default()).placed(at(-0.4));
    let right = shown(&posed, gold).placed(at(0.4));
    let shot = straight();
    let [alone_left, alone_right, both, turned_round] = [
        vec![left.clone()],
        vec![right.clone()],
        vec![left.clone(), right.clone()],
        vec![right, left],
    ]
    .map(|instances| drawn(&plan(&shot, instances)));
    assert!(both == turned_round, "their order does not matter");
    let empty = drawn(&plan(&shot, Vec::new()));
    let mut seen = [0; 2];
    for (index, pixel) in both.pixels.iter().enumerate() {
        let of = |image: &Image| image.pixels[index];
        let nothing = of(&empty);
        let wanted = match (of(&alone_left) == nothing, of(&alone_right) == nothing) {
            (false, false) => panic!("they overlap at {index}"),
            (false, true) => {
                seen[0] += 1;
                of(&alone_left)
            }
            (true, _) => {
                seen[1] += usize::from(of(&alone_right) != nothing);
                of(&alone_right)
            }
        };
        assert_eq!(*pixel, wanted, "at {index}");
    }
    assert!(seen.iter().all(|count| *count > 300), "{seen:?}");
}

fn query(instance: usize, mesh: usize) -> VertexQuery {
    VertexQuery {
        instance,
        mesh,
        start: 1,
        count: 3,
        positions: true,
        normals: true,
    }
}

/// A picture of one character, vertices of both.
fn mixed() -> Plan {
    let (first, second) = (posed(), posed());
    let hidden = Appearance {
        show: Show::new(
            rigd::scene::ShowSkin::None,
            ShowSkeleton::None,
            Default::default(),
            1.0,
        )
        .expect("an opacity"),
        ..Appearance::default()
    };
    let instances = vec![shown(&first, Appearance::default()), shown(&second, hidden)];
    Plan {
        vertices: vec![query(1, 0), query(0, 1), query(0, 0)],
        ..plan(&straight(), instances)
    }
}

fn assert_is_each_by_itself(render: &mut dyn FnMut(&Plan) -> Outputs) {
    let mixed = mixed();
    let found = render(&mixed);
    let picture = render(&Plan {
        vertices: Vec::new(),
        ..mixed.clone()
    });
    let vertices = render(&Plan {
        image: None,
        ..mixed
    });
    assert_eq!(found.images.len(), 1);
    assert_eq!(found.images, picture.images);
    assert_eq!(found.vertices.len(), 3);
    assert_eq!(found.vertices, vertices.vertices);
    assert_ne!(found.vertices[1], found.vertices[2]);
}

#[test]
fn a_picture_and_vertices_of_one_plan_are_those_of_each_alone() {
    let cpu = Cpu::default();
    assert_is_each_by_itself(&mut |plan| {
        let outputs = cpu.render(plan, Parallelism::uncancelled(Cores::One));
        outputs.expect("it is wanted")
    });
}
