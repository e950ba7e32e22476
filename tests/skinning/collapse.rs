//! Does a tube that is twisted or bent keep its shape where dual quaternions blend, and lose it where matrices do? Never lives here: where
//! exactly a vertex has to be.

use crate::made::{RINGS, SIDES, Tube};
use crate::subject::{DUAL, LINEAR, Subject};
use crate::support::oracle::matrix::{Vector, cross, dot, length};
use crate::support::oracle::{Pose, Rig, Skinning};

/// The upper joint turned by so many degrees.
fn turned(rig: &Rig, axis: usize, degrees: f64) -> Pose {
    let mut pose = rig.rest();
    pose.angles[1][axis] = degrees.to_radians();
    pose
}

fn by_oracle(subject: &Subject, pose: &Pose, skinning: Skinning) -> Vec<Vector> {
    let skinned = subject.oracle.skin(pose, skinning);
    let positions: Vec<Vector> = skinned.positions.into_iter().flatten().collect();
    assert_eq!(positions.len(), subject.oracle.positions.len());
    positions
}

fn by_service(subject: &Subject, pose: &Pose, skinning: Skinning) -> Vec<Vector> {
    let asked = subject.values("turned".to_owned(), pose.clone());
    let found = subject.by_gpu(&asked, skinning);
    found.iter().map(|it| it[0].map(f64::from)).collect()
}

/// Mean distance from the y axis of the two rings nearest to the joint.
fn radius_at_joint(positions: &[Vector]) -> f64 {
    let rings = &positions[(RINGS / 2 - 1) * SIDES..(RINGS / 2 + 1) * SIDES];
    let distances = rings.iter().map(|&[x, _, z]| length([x, 0.0, z]));
    distances.sum::<f64>() / rings.len() as f64
}

/// Of tetrahedra from the origin to each triangle.
fn volume(positions: &[Vector], triangles: &[[usize; 3]]) -> f64 {
    let six_times = |triangle: &[usize; 3]| {
        let [a, b, c] = triangle.map(|corner| positions[corner]);
        dot(a, cross(b, c))
    };
    triangles.iter().map(six_times).sum::<f64>() / 6.0
}

/// Who skins: the oracle, to see that the definition has the property, and the service.
type Skinner = fn(&Subject, &Pose, Skinning) -> Vec<Vector>;

fn check_twist(subject: &Subject, skinner: Skinner) {
    let pose = turned(&subject.oracle, 1, 170.0);
    let radius = |skinning| radius_at_joint(&skinner(subject, &pose, skinning));
    let [linear, dual] = [LINEAR, DUAL].map(radius);
    println!("radius twisted: linear {linear:.4}, dual quaternions {dual:.4}");
    assert!(dual >= 0.9, "{dual}");
    assert!(linear < 0.2, "{linear}");
}

fn check_bend(subject: &Subject, skinner: Skinner) {
    let triangles = &subject.oracle.triangles;
    let straight = volume(&subject.oracle.positions, triangles);
    // A little less than a cylinder's, the tube having corners.
    assert!((straight / (8.0 * std::f64::consts::PI) - 0.99).abs() < 0.01);
    for axis in [0, 2] {
        let pose = turned(&subject.oracle, axis, 120.0);
        let share = |skinning| volume(&skinner(subject, &pose, skinning), triangles) / straight;
        let [linear, dual] = [LINEAR, DUAL].map(share);
        println!("volume bent: linear {linear:.4}, dual quaternions {dual:.4}");
        assert!((dual - 1.0).abs() <= 0.05, "{dual}");
        assert!(linear < 0.95 && linear < dual, "{linear}");
    }
}

#[test]
fn by_definition_a_twisted_tube_keeps_its_radius_only_with_dual_quaternions() {
    check_twist(&Subject::load(&Tube::new().rig()), by_oracle);
}

#[test]
fn a_twisted_tube_keeps_its_radius_only_with_dual_quaternions() {
    check_twist(&Subject::load(&Tube::new().rig()), by_service);
}

#[test]
fn by_definition_a_bent_tube_keeps_its_volume_only_with_dual_quaternions() {
    check_bend(&Subject::load(&Tube::new().rig()), by_oracle);
}

#[test]
fn a_bent_tube_keeps_its_volume_only_with_dual_quaternions() {
    check_bend(&Subject::load(&Tube::new().rig()), by_service);
}
