//! What the server tells of itself, of its limits, and of a frame that it drew.

use crate::support::{self, ask, ask_kind, ask_ok};
use crate::{ARM, F64, FLAG, SERVICE, ask_error, assert_near, files, load, merge, numbers, text};
use rigd::formats::Source;
use rigd::limits::Limits;
use rigd::service::Service;
use serde_json::{Value, json};
use std::f64::consts::FRAC_PI_2;

#[test]
fn a_frame_says_what_it_was_made_with() {
    let eye = [0.0, 1.0, 4.0];
    let camera = json!({"kind": "look_at", "eye": eye, "target": [0, 1, 0], "fov_y": FRAC_PI_2});
    let params = json!({"rig": "figure", "camera": camera, "size": [40, 20]});
    let frame = ask_ok(&SERVICE, "frame.render", params);
    assert_eq!(
        (&frame["width"], &frame["height"]),
        (&json!(40), &json!(20))
    );
    let camera = &frame["camera"];
    let matrix = numbers(&camera["world_from_camera"]);
    assert_near(&matrix[12..15], &eye, F64, "the eye");
    // Half the height over the tangent of half the angle.
    for (name, wanted) in [("fx", 10.0), ("fy", 10.0), ("cx", 20.0), ("cy", 10.0)] {
        assert_near(
            &[camera[name].as_f64().expect("a number")],
            &[wanted],
            1e-12,
            name,
        );
    }
    assert_eq!(numbers(&camera["clip_from_world"]).len(), 16);
    assert_eq!(frame["renderer"]["name"], "rigd");
    for time in ["queue", "render", "encode"] {
        assert!(
            frame["timings_ms"][time]
                .as_f64()
                .is_some_and(|ms| ms >= 0.0)
        );
    }
    let blob = &frame["images"]["color"];
    assert_eq!(
        (&blob["encoding"], &blob["media"]),
        (&json!("base64"), &json!("image/png"))
    );
}

#[test]
fn what_is_too_large_is_refused_before_anything_is_allocated() {
    let limits = Limits {
        pixels: 10_000,
        side: 500,
        lights: 2,
        joints: 2,
        vertices: 3,
        triangles: 1,
        influences: 4,
        rigs: 2,
        rig_file_bytes: 4000,
        ..Limits::default()
    };
    let service = Service::new(support::engine(limits), Source::inline_only());
    load(&service, "arm");
    // The renderer is warm, so that what it takes is what it goes on taking.
    let draw = |size: Value| json!({"rig": "arm", "size": size});
    ask_ok(&service, "frame.render", draw(json!([100, 100])));
    let memory = || ask_ok(&service, "server.stats", json!({}))["memory"].take();
    let before = memory();
    let skin = |from: &str, to: &str| json!({"name": "new", "files": [text("arm.skel", ARM), text("arm.skin", &FLAG.replace(from, to))]});
    let skel = |content: &str| json!({"name": "new", "files": [text("new.skel", content)]});
    let light = json!({"kind": "directional", "direction": [0, -1, 0]});
    let many_lights = json!({"rig": "arm", "size": [8, 8], "lights": [light, light, light]});
    let long = "#".repeat(4001);
    for (method, params, limit, maximum, asked) in [
        (
            "frame.render",
            draw(json!([500, 21])),
            "pixels",
            10_000,
            10_500,
        ),
        ("frame.render", draw(json!([501, 1])), "side", 500, 501),
        (
            "frame.render",
            draw(json!([u32::MAX, u32::MAX])),
            "side",
            500,
            u64::from(u32::MAX),
        ),
        ("frame.render", many_lights, "lights", 2, 3),
        (
            "rig.load",
            skin("positions 3", "positions 99999999"),
            "vertices",
            3,
            99_999_999,
        ),
        (
            "rig.load",
            skin("skinweights 3", "skinweights 4"),
            "vertices",
            3,
            4,
        ),
        (
            "rig.load",
            skin("triangles 1", "triangles 2"),
            "triangles",
            1,
            2,
        ),
        ("rig.load", skin("bindings 2", "bindings 3"), "joints", 2, 3),
        (
            "rig.load",
            skin("2 0 0.5 1 0.5", "3 0 0.5 1 0.25 0 0.25"),
            "influences",
            4,
            5,
        ),
        (
            "rig.load",
            skel("joint a { joint b { } joint c { } }"),
            "joints",
            2,
            3,
        ),
        ("rig.load", skel(&long), "rig_file_bytes", 4000, 4001),
    ] {
        let (code, kind, data) = ask_error(&service, method, params);
        assert_eq!((code, kind.as_str()), (-32003, "limit_exceeded"), "{limit}");
        let wanted = json!({"limit": limit, "maximum": maximum, "asked": asked});
        assert_eq!(Value::Object(data), wanted);
    }
    let after = memory();
    for held in ["rigs_bytes", "gpu_bytes"] {
        assert_eq!(after[held], before[held], "{held}");
    }
    // One more rig is allowed, a third is not, and in the place of another it is.
    load(&service, "second");
    let third = json!({"name": "third", "files": files()});
    let (_, _, data) = ask_error(&service, "rig.load", third);
    assert_eq!(data["limit"], "rigs");
    let mut replaced = skel("joint a { }");
    merge(&mut replaced, json!({"name": "second", "replace": true}));
    ask_ok(&service, "rig.load", replaced);
    let rigs = ask_ok(&service, "rig.list", json!({}));
    assert_eq!(rigs["rigs"].as_array().map(Vec::len), Some(2));

    // Every limit is there to be read.
    let info = ask_ok(&service, "server.info", json!({}));
    for (name, maximum) in limits.entries() {
        assert_eq!(info["limits"][name], maximum, "{name}");
    }
}

#[test]
fn the_server_tells_what_it_is() {
    let info = ask_ok(&SERVICE, "server.info", json!({}));
    assert_eq!(
        (&info["name"], &info["protocol"]),
        (&json!("rigd"), &json!(1))
    );
    assert_eq!(info["version"], env!("CARGO_PKG_VERSION"));
    for member in ["name", "backend", "type", "driver", "why"] {
        assert!(info["adapter"][member].is_string(), "{member}");
    }
    assert_eq!(info["formats"], json!(rigd::formats::FORMATS));
    assert!(
        info["uptime_s"]
            .as_f64()
            .is_some_and(|seconds| seconds > 0.0)
    );
    assert_eq!(ask_ok(&SERVICE, "server.ping", json!({})), json!({}));
    assert_eq!(
        ask_ok(&SERVICE, "rpc.discover", json!({})),
        rigd::protocol::openrpc()
    );
}

#[test]
fn every_answer_is_counted_once() {
    // Its own, so that nobody else's requests are counted.
    let service = support::service();
    let draw = || {
        ask(
            &service,
            "frame.render",
            json!({"rig": "figure", "size": [16, 16]}),
        )
    };
    for _ in 0..3 {
        draw().expect("a picture");
    }
    ask_ok(
        &service,
        "mesh.vertices",
        json!({"rig": "figure", "range": {"start": 0, "count": 10}}),
    );
    ask_kind(&service, "frame.render", json!({"rig": "nobody"}));
    ask_kind(
        &service,
        "frame.render",
        json!({"rig": "figure", "size": 3}),
    );
    ask_kind(&service, "no.such.method", json!({}));
    support::answer(&service, "not JSON");
    // A notification that only asks is passed over, which is no failure of anybody's.
    let notification = r#"{"jsonrpc":"2.0","method":"server.info"}"#;
    assert!(support::answer(&service, notification).is_none());
    let stats = ask_ok(&service, "server.stats", json!({}));
    let wanted = json!({
        "frame.render": {"ok": 3, "errors": {"rig_not_loaded": 1, "invalid_params": 1}},
        "mesh.vertices": {"ok": 1, "errors": {}},
        "(none)": {"ok": 0, "errors": {"method_not_found": 1, "parse_error": 1}},
    });
    assert_eq!(stats["requests"], wanted);
    assert_eq!((&stats["frames"], &stats["rigs"]), (&json!(3), &json!(1)));
    let figure = ask_ok(&service, "rig.describe", json!({"rig": "figure"}));
    let per_frame = figure["vertex_count"].as_u64().expect("a number");
    assert_eq!(stats["vertices"], 3 * per_frame + 10);
    for held in ["cpu_bytes", "rigs_bytes"] {
        assert!(
            stats["memory"][held]
                .as_u64()
                .is_some_and(|bytes| bytes > 0),
            "{held}"
        );
    }
}
