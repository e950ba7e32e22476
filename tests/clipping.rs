//! Is a triangle seen where a ray in f64 meets it, wherever its corners are: behind the eye, before the near plane, a million units away?
//! rigd's own renderer against the definition.

mod support;

use glam::{DVec2, DVec3, Vec3};
use rigd::limits::Limits;
use rigd::pose::{Pose, Posed, Skinning};
use rigd::render::cpu::{Cores, Cpu, Parallelism};
use rigd::rig::{Draft, MeshDraft};
use rigd::scene::{
    Background, Bounds, Camera, Color, Cull, LookAt, Near, Ray, Samples, Show, Size, Surface,
};
use std::sync::Arc;
use support::random::Random;
use support::shot::Shot;

const SIZE: Size = Size {
    width: 97,
    height: 61,
};

/// Pixels by which corners and edges may be off: 1/256 for rounding to fixed point, and some more for float32.
const SLACK: f64 = 0.02;

/// Share of the largest coordinate by which float32 may move a corner against the eye.
const ROUNDING: f64 = 5e-7;

fn camera(height: Option<f64>, near: f64) -> Camera {
    let look = LookAt {
        eye: DVec3::new(0.3, 0.2, 2.0),
        target: DVec3::new(0.1, -0.1, 0.0),
        up: DVec3::new(0.1, 1.0, 0.0),
        fov_y: height.is_none().then_some(1.2),
        height,
        near: Near(Some(near)),
    };
    Camera::look_at(look, &Bounds::ORIGIN, SIZE).expect("a camera")
}

/// Where the ray meets the triangle, by Cramer's rule.
fn meets(ray: &Ray, [a, b, c]: [DVec3; 3]) -> bool {
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(ac);
    let slope = -ray.direction.dot(normal);
    if slope == 0.0 {
        return false;
    }
    let from = ray.origin - a;
    let across = from.cross(ray.direction);
    let (distance, u, v) = (
        from.dot(normal) / slope,
        ac.dot(across) / slope,
        -ab.dot(across) / slope,
    );
    ray.reaches(distance) && u >= 0.0 && v >= 0.0 && u + v <= 1.0
}

/// Whether anything is met at a point of the picture; `None` so near an edge that rounding decides.
fn seen(camera: &Camera, triangles: &[[DVec3; 3]], [x, y]: [f64; 2]) -> Option<bool> {
    let at = |aside: [f64; 2], away: DVec3| {
        let mut ray = camera
            .ray(DVec2::new(x + aside[0], y + aside[1]))
            .expect("a ray");
        ray.origin += away;
        let met = triangles.iter().map(|triangle| meets(&ray, *triangle));
        met.collect::<Vec<_>>()
    };
    let corners = triangles.as_flattened().iter();
    let rounding = ROUNDING
        * corners
            .map(|corner| corner.abs().max_element())
            .fold(1.0, f64::max);
    let here = at([0.0; 2], DVec3::ZERO);
    let beside = [[SLACK, 0.0], [-SLACK, 0.0], [0.0, SLACK], [0.0, -SLACK]];
    let beyond = DVec3::AXES
        .into_iter()
        .flat_map(|axis| [axis * rounding, -axis * rounding]);
    let is_clear = beside
        .into_iter()
        .all(|aside| at(aside, DVec3::ZERO) == here)
        && beyond.into_iter().all(|away| at([0.0; 2], away) == here);
    is_clear.then(|| here.contains(&true))
}

fn drawn(camera: Camera, triangles: &[[DVec3; 3]]) -> Vec<u8> {
    let positions: Vec<Vec3> = triangles
        .as_flattened()
        .iter()
        .map(|corner| corner.as_vec3())
        .collect();
    let mesh = MeshDraft {
        triangles: (0..triangles.len() as u32)
            .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
            .collect(),
        positions,
        ..MeshDraft::default()
    };
    let draft = Draft {
        meshes: vec![mesh],
        ..Draft::default()
    };
    let rig = Arc::new(draft.build(&Limits::default()).expect("a rig"));
    let posed = Arc::new(Posed::new(&Pose::rest(&rig)).expect("a pose"));
    let scene = Shot {
        size: SIZE,
        samples: Samples::One,
        camera,
        lights: Vec::new(),
        ambient: Color::WHITE,
        surface: Surface::new(
            Some(Color::WHITE),
            Some(Color::constant(0.0, 0.0, 0.0)),
            Some(1.0),
        )
        .expect("a surface"),
        background: Background::new([0.0, 0.0, 0.0, 1.0]).expect("black"),
        show: Show::default(),
        cull: Cull::Auto,
    };
    match Cpu::default().render(
        &scene.plan(posed, Skinning::Linear, 1.0),
        Parallelism::uncancelled(Cores::One),
    ) {
        Some(outputs) => outputs.images[0].bytes.to_vec(),
        None => unreachable!("it is wanted"),
    }
}

/// How many pixels were compared, and how many of them showed something.
fn compare(what: &str, camera: Camera, triangles: &[[DVec3; 3]]) -> [usize; 2] {
    // As the renderer has them.
    let rounded: Vec<[DVec3; 3]> = triangles
        .iter()
        .map(|t| t.map(|corner| corner.as_vec3().as_dvec3()))
        .collect();
    let pixels = drawn(camera, triangles);
    let mut counts = [0, 0];
    for y in 0..SIZE.height {
        for x in 0..SIZE.width {
            let middle = [f64::from(x) + 0.5, f64::from(y) + 0.5];
            let Some(wanted) = seen(&camera, &rounded, middle) else {
                continue;
            };
            let found = pixels[4 * (y * SIZE.width + x) as usize] == 255;
            assert_eq!(found, wanted, "{what}: at {x},{y} of {triangles:?}");
            counts[0] += 1;
            counts[1] += usize::from(wanted);
        }
    }
    counts
}

#[test]
fn triangles_are_seen_where_rays_meet_them() {
    let mut random = Random(11);
    let mut total = [0, 0];
    for (reach, rounds) in [(1.0, 60), (3.0, 60), (30.0, 40), (1e4, 30), (1e6, 20)] {
        for round in 0..rounds {
            let triangles: Vec<[DVec3; 3]> = (0..4)
                .map(|_| [0; 3].map(|_| DVec3::from_array([0; 3].map(|_| random.within(reach)))))
                .collect();
            for (lens, camera) in [
                ("perspective", camera(None, 0.05)),
                ("a near plane in the midst", camera(None, 1.7)),
                ("a near plane in the eye itself", camera(None, 1e-12)),
                ("orthographic", camera(Some(3.0), 0.5)),
            ] {
                let what = format!("{lens}, corners within {reach}, round {round}");
                let counts = compare(&what, camera, &triangles);
                total = [total[0] + counts[0], total[1] + counts[1]];
            }
        }
    }
    // A comparison of next to nothing proves nothing.
    println!("{total:?}");
    assert!(total[0] > 3_000_000 && total[1] > 500_000, "{total:?}");
}

#[test]
fn what_has_no_area_is_not_seen_and_harms_nobody() {
    let a = DVec3::new(-0.5, 0.0, 0.0);
    let b = DVec3::new(0.5, 0.1, 0.0);
    let square = [
        [
            DVec3::new(-0.2, -0.2, 0.1),
            DVec3::new(0.2, -0.2, 0.1),
            DVec3::new(0.2, 0.2, 0.1),
        ],
        [
            DVec3::new(-0.2, -0.2, 0.1),
            DVec3::new(0.2, 0.2, 0.1),
            DVec3::new(-0.2, 0.2, 0.1),
        ],
    ];
    let nothing = [[a, a, a], [a, b, a], [a, b, (a + b) / 2.0]];
    let extremes = [
        [DVec3::splat(1e9), DVec3::splat(-1e9), DVec3::splat(1e9)],
        [
            DVec3::X * 1e9,
            DVec3::X * 1e9 + DVec3::Y,
            DVec3::X * 1e9 + DVec3::Z,
        ],
        [DVec3::X * 1e-30, DVec3::Y * 1e-30, DVec3::ZERO],
        // At the eye itself.
        [DVec3::new(0.3, 0.2, 2.0); 3],
    ];
    for near in [1e-12, 0.01, 1.0] {
        let alone = drawn(camera(None, near), &square);
        for more in [nothing.as_slice(), &extremes] {
            let all = [&square, more].concat();
            assert_eq!(drawn(camera(None, near), &all), alone, "{near}");
        }
    }
}

#[test]
fn the_oracle_refuses_a_triangle_that_is_not_the_one_drawn() {
    let triangle = [
        DVec3::new(-0.5, -0.5, 0.0),
        DVec3::new(0.5, -0.5, 0.0),
        DVec3::new(0.0, 0.6, 0.0),
    ];
    let moved = triangle.map(|corner| corner + DVec3::X * 0.05);
    let camera = camera(None, 0.05);
    let pixels = drawn(camera, &[triangle]);
    let off = |triangle: [DVec3; 3]| {
        (0..SIZE.height * SIZE.width)
            .filter(|&i| {
                let middle = [
                    f64::from(i % SIZE.width) + 0.5,
                    f64::from(i / SIZE.width) + 0.5,
                ];
                let wanted = seen(&camera, &[triangle], middle);
                wanted.is_some_and(|wanted| wanted != (pixels[4 * i as usize] == 255))
            })
            .count()
    };
    assert_eq!(off(triangle), 0);
    assert!(off(moved) > 20, "{}", off(moved));
}
