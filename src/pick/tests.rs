//! What rays meet, from the room's own door. Never lives here: cameras, which have their own tests.

use super::*;
use crate::frame::Pooled;
use crate::limits::Limits;
use crate::pose::Pose;
use crate::random::Random;
use crate::rig::{BindPose, BindingDraft, Draft, JointDraft, MeshDraft, Rig};
use glam::{DAffine3, DMat3, Vec3};
use std::sync::Arc;

/// In units: what crossing triangles about 1 in size from a few units away loses.
const ROUNDING: f64 = 1e-12;

fn ray(origin: DVec3, toward: DVec3) -> Ray {
    Ray {
        origin,
        direction: toward.normalize_or_zero(),
        from: 0.0,
        to: f64::INFINITY,
    }
}

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn mesh(positions: &[Vec3], triangles: &[[u32; 3]]) -> MeshDraft {
    MeshDraft {
        positions: positions.to_vec(),
        triangles: triangles.to_vec(),
        ..MeshDraft::default()
    }
}

/// Three joints in a column, 2 apart, and these meshes.
fn rig(meshes: Vec<MeshDraft>, bindings: &[Option<usize>]) -> Arc<Rig> {
    let joint = |index: usize| JointDraft {
        parent: index.checked_sub(1),
        offset: DVec3::Y * if index == 0 { 0.0 } else { 2.0 },
        ..JointDraft::default()
    };
    let binding = |&joint: &Option<usize>| BindingDraft {
        joint,
        file: None,
        bind_pose: BindPose::BindFromJoint(DAffine3::IDENTITY),
    };
    let draft = Draft {
        joints: (0..3).map(joint).collect(),
        meshes,
        bindings: bindings.iter().map(binding).collect(),
        ..Draft::default()
    };
    Arc::new(draft.build(&Limits::default()).expect("a valid draft"))
}

fn flat(vectors: &[Vec3]) -> Option<Pooled<Vec<f32>>> {
    let numbers = vectors.iter().flat_map(|vector| vector.to_array());
    Some(numbers.collect::<Vec<f32>>().into())
}

/// As a renderer gives them back, of a rig that stands where it was modelled.
fn vertices(rig: &Rig) -> Vec<SkinnedVertices> {
    let of_mesh = |mesh: &crate::rig::Mesh| SkinnedVertices {
        vertex_count: mesh.vertex_count(),
        positions: flat(mesh.positions()),
        normals: flat(mesh.normals()),
    };
    rig.meshes().iter().map(of_mesh).collect()
}

fn at_rest(rig: &Arc<Rig>) -> Posed {
    Posed::new(&Pose::rest(rig)).expect("within range")
}

fn pick_skin(ray: &Ray, rig: &Arc<Rig>, meshes: &[SkinnedVertices]) -> Option<Hit> {
    let targets = Targets {
        skin: Some(Skin {
            posed: &at_rest(rig),
            shape: Shape::Bind,
            cull: Cull::Auto,
            variant: None,
            meshes,
        }),
        bones: None,
    };
    pick(ray, &targets)
}

/// `(mesh, triangle, barycentric, normal, joint)`
fn of_skin(hit: Hit) -> (usize, usize, [f64; 3], DVec3, Option<usize>) {
    match hit.what {
        What::Skin {
            mesh,
            triangle,
            barycentric,
            normal,
            joint,
        } => (mesh, triangle, barycentric, normal, joint),
        What::Bone { .. } => panic!("skin was asked for: {hit:?}"),
    }
}

#[test]
fn the_nearest_of_many_triangles_is_the_one_that_solving_for_each_finds() {
    let mut random = Random(3);
    let positions: Vec<Vec3> = (0..300)
        .map(|_| DVec3::from(random.point()).as_vec3())
        .collect();
    let triangles: Vec<[u32; 3]> = (0..100).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let halves = [&triangles[..40], &triangles[40..]];
    let rig = rig(halves.map(|half| mesh(&positions, half)).into(), &[]);
    let meshes = vertices(&rig);
    let mut met = 0;
    for _ in 0..2000 {
        let origin = DVec3::from(random.point()) * 3.0;
        let window = Ray {
            from: random.unit() * 2.0,
            to: 2.0 + random.unit() * 3.0,
            ..ray(origin, DVec3::from(random.point()) - origin)
        };
        // origin + t·direction = a + v·(b - a) + w·(c - a), by the inverse of a matrix.
        let solved = triangles.iter().enumerate().filter_map(|(index, corners)| {
            let [a, b, c] = corners.map(|corner| positions[corner as usize].as_dvec3());
            let solution =
                DMat3::from_cols(-window.direction, b - a, c - a).inverse() * (origin - a);
            let (distance, v, w) = solution.into();
            let is_met = v >= 0.0 && w >= 0.0 && v + w <= 1.0 && window.reaches(distance);
            is_met.then_some((distance, index, [1.0 - v - w, v, w], [a, b, c]))
        });
        let wanted = solved.min_by(|a, b| a.0.total_cmp(&b.0));
        let found = pick_skin(&window, &rig, &meshes);
        assert_eq!(found.is_some(), wanted.is_some(), "{window:?}");
        let (Some(hit), Some((distance, index, shares, corners))) = (found, wanted) else {
            continue;
        };
        let (mesh, triangle, barycentric, ..) = of_skin(hit);
        assert_eq!(mesh * 40 + triangle, index, "{window:?}");
        // Solving for a triangle that is seen at a slant loses some more.
        assert!((hit.distance - distance).abs() < 1e-9);
        assert!(DVec3::from(barycentric).abs_diff_eq(shares.into(), 1e-9));
        assert!((barycentric.iter().sum::<f64>() - 1.0).abs() < ROUNDING);
        let shared: DVec3 = corners
            .iter()
            .zip(barycentric)
            .map(|(&at, share)| at * share)
            .sum();
        assert!(shared.distance(hit.position) < 1e-9);
        met += 1;
    }
    assert!(met > 1000, "{met}");
}

const CORNERS: [Vec3; 3] = [
    Vec3::new(0.0, 0.0, 0.0),
    Vec3::new(4.0, 0.0, 0.0),
    Vec3::new(0.0, 4.0, 0.0),
];

#[test]
fn a_hit_tells_the_triangle_as_the_file_has_it() {
    // The same triangle behind, and one that the file winds the other way.
    let behind = CORNERS.map(|corner| corner - Vec3::Z);
    let positions = [CORNERS, behind].concat();
    let rig = rig(vec![mesh(&positions, &[[3, 4, 5], [2, 1, 0]])], &[]);
    let meshes = vertices(&rig);
    let from_before = ray(v(1.0, 2.0, 5.0), DVec3::NEG_Z);
    let hit = pick_skin(&from_before, &rig, &meshes).expect("it is in the way");
    assert_eq!((hit.distance, hit.position), (5.0, v(1.0, 2.0, 0.0)));
    assert_eq!(of_skin(hit), (0, 1, [0.5, 0.25, 0.25], DVec3::Z, None));
    let from_behind = ray(v(1.0, 2.0, -5.0), DVec3::Z);
    let hit = pick_skin(&from_behind, &rig, &meshes).expect("it is in the way");
    assert_eq!((hit.distance, hit.position), (4.0, v(1.0, 2.0, -1.0)));
    assert_eq!(of_skin(hit), (0, 0, [0.25, 0.25, 0.5], DVec3::NEG_Z, None));
    for (x, y) in [(-0.001, 2.0), (1.0, -0.001), (2.001, 2.0)] {
        let beside = ray(v(x, y, 5.0), DVec3::NEG_Z);
        assert_eq!(pick_skin(&beside, &rig, &meshes), None);
    }
}

#[test]
fn edges_and_corners_belong_to_a_triangle_and_its_plane_does_not() {
    let rig = rig(vec![mesh(&CORNERS, &[[0, 1, 2]])], &[]);
    let meshes = vertices(&rig);
    for (x, y) in [
        (0.0, 0.0),
        (4.0, 0.0),
        (0.0, 4.0),
        (1.0, 0.0),
        (0.0, 3.0),
        (1.0, 3.0),
    ] {
        for z in [5.0, -5.0] {
            let edge = ray(v(x, y, z), DVec3::NEG_Z * z);
            assert!(pick_skin(&edge, &rig, &meshes).is_some(), "{x} {y} {z}");
        }
    }
    for edge_on in [
        ray(v(-3.0, 1.0, 0.0), DVec3::X),
        ray(v(-3.0, -3.0, 0.0), v(1.0, 1.1, 0.0)),
        ray(v(1.0, 1.0, 0.0), v(0.3, -0.2, 0.0)),
    ] {
        assert_eq!(pick_skin(&edge_on, &rig, &meshes), None, "{edge_on:?}");
    }
}

#[test]
fn triangles_without_area_are_never_met() {
    let line = Vec3::new(0.75, -0.5, 0.625);
    let positions = [Vec3::ZERO, line, line * 3.0, Vec3::X];
    let degenerate = [[0, 1, 2], [2, 0, 1], [0, 0, 0], [3, 3, 1], [3, 1, 1]];
    let rig = rig(vec![mesh(&positions, &degenerate)], &[]);
    let meshes = vertices(&rig);
    let mut random = Random(4);
    for _ in 0..3000 {
        let share = 3.0 * random.unit();
        for aim in [line.as_dvec3() * share, DVec3::X, DVec3::ZERO] {
            let origin = DVec3::from(random.point()) * 4.0;
            let ray = ray(origin, aim - origin);
            assert_eq!(pick_skin(&ray, &rig, &meshes), None, "{ray:?}");
        }
    }
}

#[test]
fn normals_are_interpolated_and_stand_on_the_side_that_is_seen() {
    let rig = rig(vec![mesh(&CORNERS, &[[0, 1, 2]])], &[]);
    let mut meshes = vertices(&rig);
    let given = [v(0.6, 0.0, 0.8), v(0.0, 0.6, 0.8), v(0.0, 0.0, 1.0)];
    meshes[0].normals = flat(&given.map(|normal| normal.as_vec3()));
    let toward = |z: f64| ray(v(1.0, 2.0, z), DVec3::NEG_Z * z);
    let normal = |ray: &Ray, meshes: &[SkinnedVertices]| {
        of_skin(pick_skin(ray, &rig, meshes).expect("it is in the way")).3
    };
    let wanted = (given[0] * 0.25 + given[1] * 0.25 + given[2] * 0.5).normalize_or_zero();
    let [before, behind] = [5.0, -5.0].map(|z| normal(&toward(z), &meshes));
    // The given ones were rounded to float32.
    assert!(before.abs_diff_eq(wanted, 1e-7), "{before} {wanted}");
    assert_eq!(behind, -before);
    assert!((before.length() - 1.0).abs() < ROUNDING);
    // So flat a ray that the interpolated normal leans away from it.
    let flat_ray = ray(v(1.0, 2.0, 0.0) - v(1.0, 1.0, -0.01), v(1.0, 1.0, -0.01));
    let leaning = normal(&flat_ray, &meshes);
    assert!(leaning.dot(flat_ray.direction) > 0.0 && leaning.z > 0.0);
    // Without normals, and with such as cancel out, it is the triangle's own.
    meshes[0].normals = None;
    assert_eq!(normal(&toward(-5.0), &meshes), DVec3::NEG_Z);
    meshes[0].normals = flat(&[Vec3::X, Vec3::X, Vec3::NEG_X]);
    assert_eq!(normal(&toward(5.0), &meshes), DVec3::Z);
}

#[test]
fn the_joint_is_the_one_that_weighs_most_where_it_is_met() {
    type Influences<'a> = [&'a [(u32, f64)]; 3];
    // Bindings 0 and 3 are both joint 1's; binding 4 is the world's.
    let bindings = [Some(1), Some(2), Some(0), Some(1), None];
    let with = |influences: Influences| MeshDraft {
        influence_counts: influences.map(|of_vertex| of_vertex.len() as u32).into(),
        influences: influences.concat(),
        ..mesh(&CORNERS, &[[0, 1, 2]])
    };
    // At (1, 2) the corners count a quarter, a quarter and a half: at (2, 1) the second counts half.
    let cases: [(Influences, (f64, f64), Option<usize>); 7] = [
        ([&[(0, 1.0)], &[(1, 1.0)], &[(2, 1.0)]], (1.0, 2.0), Some(0)),
        ([&[(0, 1.0)], &[(1, 1.0)], &[(2, 1.0)]], (2.0, 1.0), Some(2)),
        // No corner follows joint 1 most, but all do a little; two of its bindings count together.
        (
            [
                &[(0, 0.3), (3, 0.3), (1, 0.4)],
                &[(0, 0.4), (2, 0.6)],
                &[(0, 0.45), (1, 0.55)],
            ],
            (1.0, 2.0),
            Some(1),
        ),
        (
            [
                &[(1, 0.5), (0, 0.5)],
                &[(1, 0.5), (0, 0.5)],
                &[(1, 0.5), (0, 0.5)],
            ],
            (1.0, 2.0),
            Some(1),
        ),
        ([&[(4, 1.0)], &[(4, 1.0)], &[(4, 1.0)]], (1.0, 2.0), None),
        (
            [&[(4, 0.9), (1, 0.1)], &[(4, 1.0)], &[(4, 1.0)]],
            (1.0, 2.0),
            Some(2),
        ),
        // In the corner itself only its own influences count.
        ([&[(0, 1.0)], &[(1, 1.0)], &[(4, 1.0)]], (0.0, 4.0), None),
    ];
    for (influences, (x, y), wanted) in cases {
        let rig = rig(vec![with(influences)], &bindings);
        let ray = ray(v(x, y, 5.0), DVec3::NEG_Z);
        let hit = pick_skin(&ray, &rig, &vertices(&rig)).expect("it is in the way");
        assert_eq!(of_skin(hit).4, wanted, "{influences:?} at {x} {y}");
    }
}

#[test]
fn meshes_are_numbered_and_what_is_left_out_is_passed_over() {
    let at = |z: f32| {
        let twice = [[0, 1, 2], [1, 2, 0]];
        mesh(&CORNERS.map(|corner| corner + Vec3::Z * z), &twice)
    };
    let rig = rig(vec![at(0.0), at(2.0), at(2.0), at(1.0)], &[]);
    let mut meshes = vertices(&rig);
    let window = ray(v(1.0, 1.0, 5.0), DVec3::NEG_Z);
    let found = |ray: &Ray, meshes: &[SkinnedVertices]| {
        let hit = pick_skin(ray, &rig, meshes)?;
        let (mesh, triangle, ..) = of_skin(hit);
        assert_eq!(triangle, 0, "the first of equals");
        Some((mesh, hit.distance))
    };
    assert_eq!(
        found(&window, &meshes),
        Some((1, 3.0)),
        "the first of equals"
    );
    let from = Ray {
        from: 3.5,
        ..window
    };
    assert_eq!(found(&from, &meshes), Some((3, 4.0)));
    assert_eq!(found(&Ray { to: 2.5, ..window }, &meshes), None);
    meshes[1].positions = None;
    assert_eq!(found(&window, &meshes), Some((2, 3.0)));
    meshes[2].positions = Some(vec![0.0; 4].into());
    assert_eq!(found(&window, &meshes), Some((3, 4.0)));
    assert_eq!(found(&window, &meshes[..1]), Some((0, 5.0)));
}

#[test]
fn the_nearest_of_skin_and_bones_is_picked_and_skin_of_equals() {
    let roof = |y: f32| {
        let corners = [[-8.0, -8.0], [8.0, -8.0], [0.0, 8.0]];
        mesh(&corners.map(|[x, z]| Vec3::new(x, y, z)), &[[0, 1, 2]])
    };
    let down = ray(v(0.125, 8.0, 0.125), DVec3::NEG_Y);
    // The upper bone ends at 4.
    for (height, is_skin) in [(4.5, true), (4.0, true), (3.5, false)] {
        let rig = rig(vec![roof(height)], &[]);
        let meshes = vertices(&rig);
        let posed = at_rest(&rig);
        let both = Targets {
            bones: Some(Bones {
                posed: &posed,
                radius: None,
            }),
            skin: Some(Skin {
                posed: &posed,
                shape: Shape::Bind,
                cull: Cull::Auto,
                variant: None,
                meshes: &meshes,
            }),
        };
        let hit = pick(&down, &both).expect("both are in the way");
        assert_eq!(matches!(hit.what, What::Skin { .. }), is_skin, "{height}");
        let skinless = Targets { skin: None, ..both };
        let hit = pick(&down, &skinless).expect("the bone is in the way");
        let (joint, child, along) = (1, 2, 1.0);
        assert_eq!(
            hit.what,
            What::Bone {
                joint,
                child,
                along
            }
        );
        assert_eq!((hit.distance, hit.position), (4.0, v(0.125, 4.0, 0.125)));
        assert_eq!(pick(&down, &Targets::default()), None);
    }
}

#[test]
fn bones_are_as_thick_as_they_are_drawn_unless_a_radius_is_given() {
    let posed = at_rest(&rig(Vec::new(), &[]));
    // Bones of 2 have a radius of 0.2.
    let radius = |radius| Some(BoneRadius::new(radius).expect("a radius"));
    for (z, given, wanted) in [
        (0.19, None, true),
        (0.21, None, false),
        (0.19, radius(0.18), false),
        (0.7, radius(0.75), true),
    ] {
        let bones = Bones {
            posed: &posed,
            radius: given,
        };
        let targets = Targets {
            bones: Some(bones),
            skin: None,
        };
        let hit = pick(&ray(v(-5.0, 0.5, z), DVec3::X), &targets);
        assert_eq!(hit.is_some(), wanted, "{z} {given:?}");
        if let Some(hit) = hit {
            let (joint, child, along) = (0, 1, 0.25);
            assert_eq!(
                hit.what,
                What::Bone {
                    joint,
                    child,
                    along
                }
            );
        }
    }
}
