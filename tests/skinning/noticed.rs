//! Would a mistake be noticed? Everything that can be got wrong is got wrong here once, and has to be rejected. Never lives here: what is right.

use crate::figure;
use crate::made::{self, Made, Tube};
use crate::subject::{DUAL, LINEAR, Subject};
use crate::support::oracle::clip::{Extrapolation, Key, Tangent};
use crate::support::oracle::compare::{Found, compare};
use crate::support::oracle::dual_quaternion::rotation_of;
use crate::support::oracle::matrix::{
    Vector, affine, along, cross, difference, inverse, linear_part, origin, scaled, transposed,
};
use crate::support::oracle::{AngleOrder, Pose, Rig, Signs, Skinned, Skinning};
use crate::support::random::Random;

#[test]
fn a_joint_turned_a_thousandth_too_far_is_noticed() {
    let subject = Subject::load(&figure());
    let found = subject.by_gpu(&subject.rest(), LINEAR);
    let is_followed = |joint: usize| {
        let follows = |influences: &Vec<(usize, f64)>| {
            influences.iter().any(|it| it.0 == joint && it.1 > 0.1)
        };
        subject.oracle.weights.iter().any(follows)
    };
    let followed: Vec<usize> = (0..subject.oracle.joints.len())
        .filter(|&joint| is_followed(joint))
        .collect();
    assert!(followed.len() > 10);
    for joint in followed {
        for axis in 0..3 {
            let mut pose = subject.oracle.rest();
            pose.angles[joint][axis] += 1e-3;
            let off = compare(&found, &subject.oracle.skin(&pose, LINEAR));
            assert!(
                !off.is_close(),
                "{} axis {axis}: {off:?}",
                subject.oracle.joints[joint].name
            );
        }
    }
}

#[test]
fn vertices_out_of_order_are_noticed() {
    let subject = Subject::load(&figure());
    let rest = subject.rest();
    let mut found = subject.by_gpu(&rest, LINEAR);
    found.swap(17, 18);
    assert!(!compare(&found, &subject.wanted(&rest, LINEAR)).is_close());
}

#[test]
fn normals_of_other_lengths_or_directions_and_nan_are_noticed() {
    let subject = Subject::load(&figure());
    let rest = subject.rest();
    let (found, wanted) = (subject.by_gpu(&rest, LINEAR), subject.wanted(&rest, LINEAR));
    assert!(compare(&found, &wanted).is_close());
    let disturbances: [fn(&mut [[f32; 3]; 2]); 5] = [
        |[_, normal]| *normal = normal.map(|x| x * 0.99),
        |[_, normal]| *normal = normal.map(|x| -x),
        |[_, normal]| *normal = [f32::NAN; 3],
        |[position, _]| position[0] = f32::NAN,
        |[position, _]| position[1] += 1e-3,
    ];
    for (index, disturb) in disturbances.iter().enumerate() {
        let mut found = found.clone();
        disturb(&mut found[200]);
        let off = compare(&found, &wanted);
        assert!(!off.is_close(), "disturbance {index}: {off:?}");
    }
}

/// What a skinner without a fault would answer. Where rounding decides, anything will do.
fn rounded(skinned: &Skinned) -> Found {
    let rounded = |v: &Option<Vector>| v.unwrap_or([1.0, 0.0, 0.0]).map(|x| x as f32);
    let positions = skinned.positions.iter().map(rounded);
    let normals = skinned.normals.iter().map(rounded);
    positions.zip(normals).map(|(p, n)| [p, n]).collect()
}

/// Something got wrong in how a rig was read, posed or skinned. Takes what is right and gives what comes of the mistake.
type Mistake = fn(Rig, Pose, Skinning) -> Skinned;

/// Panics unless what is right passes in every pose and what is wrong does not in one at least.
fn assert_noticed(made: &Made, skinning: Skinning, mistakes: &[(&str, Mistake)]) {
    let rig = made.oracle();
    let mut random = Random(3);
    let poses: Vec<Pose> = (0..10).map(|_| rig.random_pose(&mut random)).collect();
    let right: Vec<Found> = poses
        .iter()
        .map(|pose| rounded(&rig.skin(pose, skinning)))
        .collect();
    for (pose, right) in poses.iter().zip(&right) {
        assert!(compare(right, &rig.skin(pose, skinning)).is_close());
    }
    for (what, mistake) in mistakes {
        let is_noticed = |(pose, right): &(&Pose, &Found)| {
            !compare(right, &mistake(rig.clone(), (*pose).clone(), skinning)).is_close()
        };
        let noticed = poses.iter().zip(&right).filter(is_noticed).count();
        println!("{what} of {}: noticed in {noticed} of 10 poses", made.name);
        assert!(noticed > 0, "{what} of {}", made.name);
    }
}

#[test]
fn mistakes_with_bindings_and_weights_are_noticed() {
    const MISTAKES: [(&str, Mistake); 6] = [
        ("a binding read by row", |mut rig, pose, skinning| {
            let binding = rig.bindings[0];
            rig.bindings[0] = affine(&transposed(&linear_part(&binding)), origin(&binding));
            rig.skin(&pose, skinning)
        }),
        (
            "a binding that is not inverted",
            |mut rig, pose, skinning| {
                rig.bindings[1] = inverse(&rig.bindings[1]);
                rig.skin(&pose, skinning)
            },
        ),
        ("a weight of a hundredth more", |mut rig, pose, skinning| {
            rig.weights[3][1].1 *= 1.01;
            rig.skin(&pose, skinning)
        }),
        ("angles in the wrong order", |mut rig, pose, skinning| {
            rig.angle_order = AngleOrder::ZFirst;
            rig.skin(&pose, skinning)
        }),
        ("an offset that is replaced", |mut rig, pose, skinning| {
            rig.joints[0].offset = [0.0; 3];
            rig.skin(&pose, skinning)
        }),
        ("the other way to blend", |rig, pose, skinning| {
            let other = if skinning == LINEAR { DUAL } else { LINEAR };
            rig.skin(&pose, other)
        }),
    ];
    assert_noticed(&made::bound_turned(), LINEAR, &MISTAKES);
    assert_noticed(&made::bound_turned(), DUAL, &MISTAKES);
}

#[test]
fn an_influence_that_is_dropped_is_noticed() {
    const MISTAKES: [(&str, Mistake); 2] = [
        ("the smallest dropped", |mut rig, pose, skinning| {
            for influences in &mut rig.weights {
                influences.sort_by(|a, b| b.1.total_cmp(&a.1));
                influences.pop();
            }
            rig.skin(&pose, skinning)
        }),
        ("all but four dropped", |mut rig, pose, skinning| {
            for influences in &mut rig.weights {
                influences.sort_by(|a, b| b.1.total_cmp(&a.1));
                influences.truncate(4);
            }
            rig.skin(&pose, skinning)
        }),
    ];
    assert_noticed(&made::forty(), LINEAR, &MISTAKES);
    assert_noticed(&made::forty(), DUAL, &MISTAKES);
}

#[test]
fn mistakes_with_morphs_are_noticed() {
    const MISTAKES: [(&str, Mistake); 6] = [
        ("morphs after skinning", |rig, pose, skinning| {
            let mut unmoved = pose.clone();
            unmoved.morphs.fill(0.0);
            let mut skinned = rig.skin(&unmoved, skinning);
            for (morph, &weight) in rig.morphs.iter().zip(&pose.morphs) {
                for &(vertex, target) in &morph.positions {
                    let step = difference(target, rig.positions[vertex]);
                    let position = &mut skinned.positions[vertex];
                    *position = position.map(|position| along(position, weight, step));
                }
            }
            skinned
        }),
        (
            "the second in place of the first",
            |mut rig, pose, skinning| {
                let second = rig.morphs[1].clone();
                let listed =
                    |entry: &(usize, Vector)| second.positions.iter().any(|it| it.0 == entry.0);
                rig.morphs[0].positions.retain(|entry| !listed(entry));
                rig.skin(&pose, skinning)
            },
        ),
        ("targets taken as steps", |mut rig, pose, skinning| {
            for morph in &mut rig.morphs {
                for (vertex, target) in &mut morph.positions {
                    *target = along(*target, 1.0, rig.positions[*vertex]);
                }
            }
            rig.skin(&pose, skinning)
        }),
        ("normals left as they were", |mut rig, pose, skinning| {
            rig.morphs
                .iter_mut()
                .for_each(|morph| morph.normals.clear());
            rig.skin(&pose, skinning)
        }),
        (
            "target normals of other lengths",
            |mut rig, pose, skinning| {
                for (_, normal) in &mut rig.morphs[0].normals {
                    *normal = normal.map(|x| 1.2 * x);
                }
                rig.skin(&pose, skinning)
            },
        ),
        ("weights in the wrong order", |rig, mut pose, skinning| {
            pose.morphs.reverse();
            rig.skin(&pose, skinning)
        }),
    ];
    assert_noticed(&made::morphing(), LINEAR, &MISTAKES);
    assert_noticed(&made::morphing(), DUAL, &MISTAKES);
}

#[test]
fn mistakes_with_the_signs_of_dual_quaternions_are_noticed() {
    const KEPT: (&str, Mistake) = ("signs not flipped", |rig, pose, _| {
        rig.skin(&pose, Skinning::DualQuaternion(Signs::Kept))
    });
    const LIGHTEST: (&str, Mistake) = ("signs of the lightest", |rig, pose, _| {
        rig.skin(&pose, Skinning::DualQuaternion(Signs::Lightest))
    });
    const LAST_OF_EQUALS: (&str, Mistake) = ("the last among equals", |mut rig, pose, skinning| {
        // Too little to move anything but the choice.
        for influences in &mut rig.weights {
            let last = influences.iter_mut().max_by_key(|it| it.0);
            last.expect("an influence").1 += 1e-9;
        }
        rig.skin(&pose, skinning)
    });
    assert_noticed(&made::forty(), DUAL, &[KEPT, LIGHTEST]);
    assert_noticed(&made::equals(), DUAL, &[KEPT, LAST_OF_EQUALS]);
}

#[test]
fn mistakes_with_stretch_beside_dual_quaternions_are_noticed() {
    const MISTAKES: [(&str, Mistake); 2] = [
        ("stretch forgotten", |mut rig, pose, skinning| {
            for binding in &mut rig.bindings {
                let back = inverse(binding);
                *binding = inverse(&affine(&rotation_of(&linear_part(&back)), origin(&back)));
            }
            rig.skin(&pose, skinning)
        }),
        ("normals stretched as positions", |rig, pose, skinning| {
            // What a step along the normal becomes.
            let mut stepped = rig.clone();
            for (position, normal) in stepped.positions.iter_mut().zip(&rig.normals) {
                *position = along(*position, 1.0, normal.expect("a normal"));
            }
            let mut skinned = rig.skin(&pose, skinning);
            let stepped = stepped.skin(&pose, skinning);
            let ends = skinned.positions.iter().zip(stepped.positions);
            let normals = ends.map(|(from, to)| Some(scaled(difference(to?, (*from)?))));
            skinned.normals = normals.collect();
            skinned
        }),
    ];
    assert_noticed(&made::bound_stretched(), DUAL, &MISTAKES);
    assert_noticed(&made::bound_sheared(), DUAL, &MISTAKES);
    assert_noticed(&made::bound_sheared(), LINEAR, &MISTAKES);
}

#[test]
fn mistakes_with_models_of_mits_kind_are_noticed() {
    const MISTAKES: [(&str, Mistake); 4] = [
        ("angles in the wrong order", |mut rig, pose, skinning| {
            rig.angle_order = AngleOrder::XFirst;
            rig.skin(&pose, skinning)
        }),
        (
            "weights that begin at the root",
            |mut rig, pose, skinning| {
                for (joint, _) in rig.weights.iter_mut().flatten() {
                    *joint -= 1;
                }
                rig.skin(&pose, skinning)
            },
        ),
        ("triangles all as large", |mut rig, pose, skinning| {
            let mut sums = vec![[0.0; 3]; rig.positions.len()];
            for triangle in &rig.triangles {
                let [a, b, c] = triangle.map(|corner| rig.positions[corner]);
                let normal = scaled(cross(difference(b, a), difference(c, a)));
                for &corner in triangle {
                    sums[corner] = along(sums[corner], 1.0, normal);
                }
            }
            rig.normals = sums.into_iter().map(|sum| Some(scaled(sum))).collect();
            rig.skin(&pose, skinning)
        }),
        ("triangles seen from behind", |mut rig, pose, skinning| {
            for normal in rig.normals.iter_mut().flatten() {
                *normal = normal.map(|x| -x);
            }
            rig.skin(&pose, skinning)
        }),
    ];
    assert_noticed(&Tube::new().mit_rig(), LINEAR, &MISTAKES);
}

/// Something got wrong in how a clip was read or sampled.
type ClipMistake = fn(&mut Rig);

fn each_key(rig: &mut Rig, change: impl Fn(&mut Key)) {
    let channels = rig.clips[0].channels.iter_mut();
    channels.flat_map(|it| &mut it.keys).for_each(change);
}

fn each_extrapolation(rig: &mut Rig, from: Extrapolation, to: Extrapolation) {
    for channel in &mut rig.clips[0].channels {
        for mode in [&mut channel.before, &mut channel.after] {
            if *mode == from {
                *mode = to;
            }
        }
    }
}

fn each_tangent(rig: &mut Rig, from: Tangent, to: Tangent) {
    each_key(rig, |key| {
        for tangent in [&mut key.arriving, &mut key.leaving] {
            if *tangent == from {
                *tangent = to;
            }
        }
    });
}

#[test]
fn mistakes_with_clips_are_noticed() {
    const MISTAKES: [(&str, ClipMistake); 11] = [
        ("linear in place of smooth", |rig| {
            each_tangent(rig, Tangent::Smooth, Tangent::Linear);
        }),
        ("flat in place of linear", |rig| {
            each_tangent(rig, Tangent::Linear, Tangent::Flat);
        }),
        ("smooth in place of flat", |rig| {
            each_tangent(rig, Tangent::Flat, Tangent::Smooth);
        }),
        ("a slope not taken", |rig| {
            each_tangent(rig, Tangent::Fixed(-0.75), Tangent::Flat);
        }),
        ("tangents the other way around", |rig| {
            each_key(rig, |key| {
                std::mem::swap(&mut key.arriving, &mut key.leaving)
            });
        }),
        ("held in place of linear", |rig| {
            each_extrapolation(rig, Extrapolation::Linear, Extrapolation::Constant);
        }),
        ("bouncing in place of cycles", |rig| {
            each_extrapolation(rig, Extrapolation::Cycle, Extrapolation::Bounce);
        }),
        ("cycles without their offset", |rig| {
            each_extrapolation(rig, Extrapolation::CycleOffset, Extrapolation::Cycle);
        }),
        ("before in place of after", |rig| {
            let channels = rig.clips[0].channels.iter_mut();
            channels.for_each(|it| std::mem::swap(&mut it.before, &mut it.after));
        }),
        ("channels without the root's displacement", |rig| {
            rig.clips[0].channels.drain(..3);
        }),
        ("limits not kept", |rig| {
            for joint in &mut rig.joints {
                joint.limits = [[f64::NEG_INFINITY, f64::INFINITY]; 3];
            }
        }),
    ];
    let rig = made::moving().oracle();
    let sampled = |rig: &Rig, time| rig.skin(&rig.sampled(&rig.clips[0], time), LINEAR);
    for (what, mistake) in MISTAKES {
        let mut wrong = rig.clone();
        mistake(&mut wrong);
        let is_noticed = |time: &f64| {
            let off = compare(&rounded(&sampled(&rig, *time)), &sampled(&wrong, *time));
            !off.is_close()
        };
        let times = (0..40).map(|step| -4.0 + 0.3 * f64::from(step));
        let noticed = times.filter(is_noticed).count();
        println!("{what}: noticed at {noticed} of 40 times");
        assert!(noticed > 3, "{what}: {noticed}");
    }
}
