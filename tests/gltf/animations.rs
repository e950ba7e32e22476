//! Animations: interpolation, keys, and what channels move.

use crate::support::gltf::{Component, Gltf};
use crate::{
    F32, NEAR, Quaternion, assert_near, clip_at, describe, first_corner, joint, linear_part, load,
    morphed, place, rotation_columns, triangle, turn_z, unit, warnings,
};
use serde_json::json;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Appendix C of the specification, the shortest way.
fn slerp(from: Quaternion, to: Quaternion, share: f64) -> Quaternion {
    let dot: f64 = (0..4).map(|i| from[i] * to[i]).sum();
    let angle = dot.abs().acos();
    let sign = dot.signum();
    let part = |share: f64| (share * angle).sin() / angle.sin();
    std::array::from_fn(|i| part(1.0 - share) * from[i] + sign * part(share) * to[i])
}

/// The triangle with one channel on its node, in the clip `c`.
fn animated(path: &str, times: &[f64], shape: &str, values: &[f64], interpolation: &str) -> Gltf {
    let mut gltf = triangle();
    let (input, output) = (gltf.floats("SCALAR", times), gltf.floats(shape, values));
    gltf.channel(
        "c",
        json!({"node": 0, "path": path}),
        json!({"input": input, "output": output, "interpolation": interpolation}),
    );
    gltf
}

#[test]
fn steps_and_lines_go_from_key_to_key_and_hold_the_ends() {
    let times = [1.0, 2.0, 4.0];
    let values = [1.0, 0.0, 0.0, 3.0, 0.0, 0.0, 3.0, 8.0, 0.0];
    for (interpolation, moments) in [
        (
            "STEP",
            &[
                (0.0, [1.0, 0.0]),
                (1.0, [1.0, 0.0]),
                (1.99, [1.0, 0.0]),
                (2.0, [3.0, 0.0]),
                (3.9, [3.0, 0.0]),
                (4.0, [3.0, 8.0]),
                (9.0, [3.0, 8.0]),
            ][..],
        ),
        (
            "LINEAR",
            &[
                (-5.0, [1.0, 0.0]),
                (1.0, [1.0, 0.0]),
                (1.5, [2.0, 0.0]),
                (2.0, [3.0, 0.0]),
                (3.5, [3.0, 6.0]),
                (4.0, [3.0, 8.0]),
                (9.0, [3.0, 8.0]),
            ],
        ),
    ] {
        load(
            interpolation,
            &animated("translation", &times, "VEC3", &values, interpolation),
        );
        for &(time, [x, y]) in moments {
            let found = place(interpolation, "stand", clip_at("c", time));
            assert_near(
                &found,
                &[x, y, 0.0],
                NEAR,
                &format!("{interpolation} at {time}"),
            );
        }
        let clip = &describe(interpolation)["clips"][0];
        assert_eq!(
            (&clip["name"], &clip["range"]),
            (&json!("c"), &json!([1.0, 4.0]))
        );
    }
    // A scale is animated like a translation; without a word about it, linear.
    let mut gltf = animated(
        "scale",
        &[0.0, 1.0],
        "VEC3",
        &[1.0, 1.0, 1.0, 3.0, 5.0, 7.0],
        "LINEAR",
    );
    let sampler = gltf.json["animations"][0]["samplers"][0].as_object_mut();
    sampler.expect("an object").remove("interpolation");
    load("scale", &gltf);
    let found = linear_part(&joint("scale", "stand", clip_at("c", 0.5)));
    assert_near(
        &found,
        &[2.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 4.0],
        NEAR,
        "scale",
    );
}

#[test]
fn rotations_are_slerped_the_shortest_way() {
    let from = unit([0.1, -0.2, 0.3, 0.9]);
    let to = unit([-0.5, 0.4, 0.6, 0.3]);
    for (what, to) in [("near", to), ("on the other side", to.map(|x| -x))] {
        let gltf = animated(
            "rotation",
            &[0.0, 1.0],
            "VEC4",
            &[from, to].concat(),
            "LINEAR",
        );
        load(what, &gltf);
        for share in [0.25, 0.5, 0.9] {
            let wanted = rotation_columns(slerp(from, to, share));
            let found = linear_part(&joint(what, "stand", clip_at("c", share)));
            assert_near(&found, &wanted, NEAR, &format!("{what} at {share}"));
        }
    }
}

/// Appendix C: values, tangents out of the first key and into the second, the seconds between them.
fn hermite(from: f64, out: f64, to: f64, into: f64, seconds: f64, share: f64) -> f64 {
    let (t, t2, t3) = (share, share * share, share * share * share);
    (2.0 * t3 - 3.0 * t2 + 1.0) * from
        + seconds * (t3 - 2.0 * t2 + t) * out
        + (-2.0 * t3 + 3.0 * t2) * to
        + seconds * (t3 - t2) * into
}

#[test]
fn cubic_splines_scale_their_tangents_by_the_time_between_keys() {
    let times = [1.0, 3.0];
    // In-tangent, value, out-tangent of each key.
    let values = [
        [9.0, 9.0, 9.0],
        [0.0, 1.0, 2.0],
        [1.0, -2.0, 0.5],
        [3.0, 0.0, -1.0],
        [4.0, 5.0, 6.0],
        [9.0, 9.0, 9.0],
    ];
    load(
        "spline",
        &animated(
            "translation",
            &times,
            "VEC3",
            values.as_flattened(),
            "CUBICSPLINE",
        ),
    );
    for share in [0.0, 0.25, 0.5, 0.8, 1.0] {
        let wanted: [f64; 3] = std::array::from_fn(|i| {
            hermite(
                values[1][i],
                values[2][i],
                values[4][i],
                values[3][i],
                2.0,
                share,
            )
        });
        let found = place("spline", "stand", clip_at("c", 1.0 + 2.0 * share));
        assert_near(&found, &wanted, NEAR, &format!("at {share}"));
    }
    for (time, key) in [(0.0, 1), (7.0, 4)] {
        let found = place("spline", "stand", clip_at("c", time));
        assert_near(&found, &values[key], NEAR, "held at the ends");
    }

    let (from, to) = (unit([0.1, -0.2, 0.3, 0.9]), unit([0.4, 0.1, 0.2, 0.8]));
    let (out, into) = ([0.3, -0.1, 0.2, 0.0], [-0.2, 0.5, 0.1, 0.1]);
    let turns = [[0.0; 4], from, out, into, to, [0.0; 4]];
    load(
        "turning spline",
        &animated(
            "rotation",
            &times,
            "VEC4",
            turns.as_flattened(),
            "CUBICSPLINE",
        ),
    );
    for share in [0.25, 0.5, 0.8] {
        let wanted = unit(std::array::from_fn(|i| {
            hermite(from[i], out[i], to[i], into[i], 2.0, share)
        }));
        let found = linear_part(&joint(
            "turning spline",
            "stand",
            clip_at("c", 1.0 + 2.0 * share),
        ));
        assert_near(
            &found,
            &rotation_columns(wanted),
            NEAR,
            &format!("turned at {share}"),
        );
    }
}

#[test]
fn weights_are_animated_all_at_once() {
    for (what, interpolation, values, wanted) in [
        (
            "linear weights",
            "LINEAR",
            &[0.0, 1.0, 1.0, 0.5][..],
            [0.25, 0.875],
        ),
        ("stepped weights", "STEP", &[0.0, 1.0, 1.0, 0.5], [0.0, 1.0]),
        (
            // All tangents are 0 but the one out of the first weight.
            "splined weights",
            "CUBICSPLINE",
            &[0.0, 0.0, 0.0, 1.0, 4.0, 0.0, 0.0, 0.0, 1.0, 0.5, 0.0, 0.0],
            [
                hermite(0.0, 4.0, 1.0, 0.0, 2.0, 0.25),
                hermite(1.0, 0.0, 0.5, 0.0, 2.0, 0.25),
            ],
        ),
    ] {
        let mut gltf = morphed();
        let (input, output) = (
            gltf.floats("SCALAR", &[0.0, 2.0]),
            gltf.floats("SCALAR", values),
        );
        let sampler = json!({"input": input, "output": output, "interpolation": interpolation});
        gltf.channel("c", json!({"node": 0, "path": "weights"}), sampler);
        load(what, &gltf);
        let found = first_corner(what, clip_at("c", 0.5));
        assert_near(&found, &[0.0, wanted[0], 10.0 * wanted[1]], F32, what);
    }
}

#[test]
fn keys_may_be_normalized_integers() {
    for (component, one, tolerance) in [
        (Component::I16, 32_767.0, 1e-4),
        (Component::U16, 65_535.0, 1e-4),
        (Component::I8, 127.0, 0.02),
        (Component::U8, 255.0, 0.02),
    ] {
        let name = format!("{component:?} keys");
        let mut gltf = triangle();
        let turns: Vec<f64> = [turn_z(0.0), turn_z(FRAC_PI_2)]
            .concat()
            .iter()
            .map(|x| (x * one).round())
            .collect();
        let (input, output) = (
            gltf.floats("SCALAR", &[0.0, 1.0]),
            gltf.normalized(component, "VEC4", &turns),
        );
        gltf.channel(
            "c",
            json!({"node": 0, "path": "rotation"}),
            json!({"input": input, "output": output}),
        );
        load(&name, &gltf);
        let found = linear_part(&joint(&name, "stand", clip_at("c", 0.5)));
        assert_near(
            &found,
            &rotation_columns(turn_z(FRAC_PI_4)),
            tolerance,
            &name,
        );
    }
}

/// Before the second key of two at one time the curve goes to the first of them, from then on it leaves the second.
#[test]
fn a_curve_jumps_where_two_keys_are_at_one_time() {
    let values = [0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 6.0, 0.0, 0.0, 8.0, 0.0, 0.0];
    let gltf = animated(
        "translation",
        &[0.0, 1.0, 1.0, 2.0],
        "VEC3",
        &values,
        "LINEAR",
    );
    let summary = load("jump", &gltf);
    assert!(warnings(&summary)[0].contains("1 keys at the time of the one before"));
    assert_eq!(describe("jump")["clips"][0]["range"], json!([0.0, 2.0]));
    for (time, x) in [(0.5, 1.0), (0.999, 1.998), (1.0, 6.0), (1.5, 7.0)] {
        let at = place("jump", "stand", clip_at("c", time));
        assert_near(&at, &[x, 0.0, 0.0], NEAR, &time.to_string());
    }
}

#[test]
fn of_two_channels_on_one_target_the_first_counts() {
    let mut gltf = animated("translation", &[0.0], "VEC3", &[1.0, 2.0, 3.0], "STEP");
    let target = gltf.json["animations"][0]["channels"][0]["target"].clone();
    let [input, output] = [&[0.0][..], &[7.0; 3]].map(|it| it.to_vec());
    let input = gltf.floats("SCALAR", &input);
    let output = gltf.floats("VEC3", &output);
    gltf.channel("c", target, json!({"input": input, "output": output}));
    let summary = load("contested", &gltf);
    assert!(warnings(&summary)[0].contains("channels[1] has the target of channels[0]"));
    let at = place("contested", "stand", clip_at("c", 0.0));
    assert_near(&at, &[1.0, 2.0, 3.0], NEAR, "the first channel");
}

#[test]
fn a_key_of_no_rotation_is_none() {
    for interpolation in ["STEP", "LINEAR"] {
        let gltf = animated("rotation", &[0.0, 1.0], "VEC4", &[0.0; 8], interpolation);
        let name = format!("no turn, {interpolation}");
        let summary = load(&name, &gltf);
        assert!(warnings(&summary)[0].contains("2 rotations that are no unit quaternions"));
        let at = joint(&name, "stand", clip_at("c", 0.5));
        assert_near(
            &linear_part(&at),
            &rotation_columns([0.0, 0.0, 0.0, 1.0]),
            NEAR,
            interpolation,
        );
    }
}

#[test]
fn a_channel_that_moves_nothing_is_passed_over() {
    let mut gltf = animated("translation", &[0.0], "VEC3", &[1.0, 2.0, 3.0], "STEP");
    let sampler = gltf.json["animations"][0]["samplers"][0].clone();
    gltf.channel("c", json!({"path": "translation"}), sampler);
    load("aimless", &gltf);
    assert_near(
        &place("aimless", "stand", clip_at("c", 0.0)),
        &[1.0, 2.0, 3.0],
        NEAR,
        "the other channel",
    );
}
