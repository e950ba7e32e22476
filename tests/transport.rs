//! Does every byte that a client sends, or fails to send, get what the contract promises, and nobody else's connection suffer?

mod support;

use rigd::formats::Source;
use rigd::limits::Limits;
use rigd::service::Service;
use serde_json::{Value, json};
use std::io::Write;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, LazyLock};
use std::time::{Duration, Instant};
use support::server::{TestServer, Wire, assert_is_png, picture, png, request};

/// One renderer for all tests; each has a server of its own before it.
static SERVICE: LazyLock<Arc<Service>> = LazyLock::new(support::service);

/// Another with little room for anything.
static NARROW: LazyLock<Arc<Service>> = LazyLock::new(|| {
    let limits = Limits {
        line_bytes: 4096,
        attachment_bytes: 4096,
        connections: 3,
        in_flight: 1,
        ..Limits::default()
    };
    support::service_with(limits, Source::inline_only())
});

fn server() -> TestServer {
    TestServer::start(&SERVICE)
}

fn ping(id: impl Into<Value>) -> String {
    request(id, "server.ping", json!({}))
}

#[test]
fn where_packets_break_does_not_matter() {
    let server = server();
    let mut wire = server.connect();
    // Two bytes, three, and four: every break within a character is tried.
    let id = "é–😀";
    for byte in ping(id).bytes() {
        wire.send([byte]);
    }
    assert_eq!(wire.result(id), json!({}));

    // Many in one packet, with every kind of line end and nothing in between.
    let many: String = (0..50)
        .map(|id| match id % 3 {
            0 => ping(id),
            1 => ping(id).replace('\n', "\r\n"),
            _ => format!("\n\r\n \t\n{}", ping(id)),
        })
        .collect();
    wire.send(many);
    for id in 0..50 {
        assert_eq!(wire.result(id), json!({}));
    }
    wire.assert_alive();
}

#[test]
fn half_a_line_then_eof_is_not_an_error() {
    let server = server();
    let whole = ping(1);
    let line = whole.trim_end();
    let list = format!("[{line}]");
    let two = format!("{line} {{}}");
    for half in [
        "",
        "{",
        &whole[..20],
        &line[..line.len() - 1],
        " \t\r",
        // Whole, but none of these is an object.
        "7",
        "hello",
        "GET / HTTP/1.1",
        &list,
        &two,
    ] {
        let mut wire = server.connect();
        wire.send(format!("{}{half}", ping(0)));
        wire.half_close();
        assert_eq!(wire.result(0), json!({}));
        wire.assert_end();
    }
}

#[test]
fn a_whole_last_request_needs_no_line_end() {
    let server = server();
    let case = include_str!("cases/wire/no_newline.ndjson");
    assert!(!case.ends_with('\n'), "that is the point of it");
    for before in [String::new(), ping(0)] {
        let mut wire = server.connect();
        wire.send(format!("{before}{case}"));
        wire.half_close();
        if !before.is_empty() {
            assert_eq!(wire.result(0), json!({}));
        }
        assert_eq!(wire.result(1), json!({}));
        wire.assert_end();
    }
    // An object that is no request is told what is wrong with it, as on any other line.
    for (line, id, path) in [
        (r#"{"id":7}"#, json!(7), "jsonrpc"),
        ("\n \r{}\r", Value::Null, "jsonrpc"),
        // Raw bytes come behind the line's end.
        (
            r#"{"jsonrpc":"2.0","id":7,"method":"server.ping","attach_bytes":3}"#,
            json!(7),
            "attach_bytes",
        ),
    ] {
        let mut wire = server.connect();
        wire.send(line);
        wire.half_close();
        let data = wire.error(id);
        assert_eq!(data["kind"], "invalid_request", "{line}");
        assert_eq!(data["path"], path, "{line}");
        wire.assert_end();
    }
    // A notification takes effect and is not answered.
    let mut wire = server.connect();
    load_bone(&mut wire, "unended");
    wire.send(r#"{"jsonrpc":"2.0","method":"pose.set","params":{"rig":"unended","pose":{"dofs":{"bone.rx":0.25}}}}"#);
    wire.half_close();
    wire.assert_end();
    let mut wire = server.connect();
    wire.request(1, "pose.get", json!({"rig": "unended"}));
    assert_eq!(wire.result(1)["dofs"]["bone.rx"], 0.25);
}

#[test]
fn a_last_line_without_end_has_the_limit_of_any_other() {
    let server = TestServer::start(&NARROW);
    let line = ping(1);
    let padded = |length: usize| {
        let line = line.trim_end();
        format!("{}{line}", " ".repeat(length - line.len()))
    };
    let mut wire = server.connect();
    wire.send(padded(4096));
    wire.half_close();
    assert_eq!(wire.result(1), json!({}));
    wire.assert_end();
    let mut wire = server.connect();
    wire.send(padded(4097));
    wire.half_close();
    assert_eq!(wire.error(Value::Null)["limit"], "line_bytes");
    wire.assert_end();
}

#[test]
fn a_half_closed_client_still_gets_its_replies() {
    let server = server();
    let mut wire = server.connect();
    for id in 0..5 {
        wire.request(id, "frame.render", picture(64));
    }
    wire.half_close();
    for id in 0..5 {
        assert_is_png(&png(&wire.result(id)), 64);
    }
    wire.assert_end();
}

#[test]
fn raw_bytes_that_stop_short_are_not_an_error() {
    let server = server();
    let mut wire = server.connect();
    wire.send(ping(0));
    wire.send(
        b"{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"server.ping\",\"attach_bytes\":10}\nonly",
    );
    wire.half_close();
    assert_eq!(wire.result(0), json!({}));
    wire.assert_end();
}

#[test]
fn a_line_past_the_limit_is_answered_and_then_nothing_more_is_heard() {
    let server = TestServer::start(&NARROW);
    for length in [4097, 5000, 100_000] {
        let mut wire = server.connect();
        wire.send(ping(0));
        wire.send(vec![b'x'; length]);
        wire.send("\n");
        wire.send(ping(1));
        assert_eq!(wire.result(0), json!({}));
        let data = wire.error(Value::Null);
        let wanted = json!({"kind": "limit_exceeded", "retryable": false, "limit": "line_bytes", "maximum": 4096, "asked": 4097});
        assert_eq!(data, wanted);
        wire.assert_end();
    }
    // As long as the limit is not past it.
    let mut wire = server.connect();
    let line = ping(0);
    wire.send(format!(
        "{}{line}",
        " ".repeat(4096 - line.trim_end().len())
    ));
    assert_eq!(wire.result(0), json!({}));
}

#[test]
fn a_line_without_end_takes_no_memory() {
    // Other tests of this process draw small pictures meanwhile; what is sent here is many times what those take.
    const SENT: usize = 256 << 20;
    const MOST: usize = 64 << 20;
    let resident = || memory_stats::memory_stats().map_or(0, |memory| memory.physical_mem);
    let server = TestServer::start(&NARROW);
    let mut wire = server.connect();
    let before = resident();
    let mut writer = wire.writer();
    let writing = std::thread::spawn(move || {
        let piece = vec![b'x'; 1 << 20];
        let mut most = 0;
        for _ in 0..SENT / piece.len() {
            most = most.max(resident());
            // The server has heard enough at some point.
            if writer.write_all(&piece).is_err() {
                break;
            }
        }
        most
    });
    assert_eq!(wire.error(Value::Null)["limit"], "line_bytes");
    let grown = writing
        .join()
        .expect("writing goes wrong quietly")
        .saturating_sub(before);
    assert!(grown < MOST, "{grown} bytes more");
}

#[test]
fn a_bad_line_is_a_reply_and_the_connection_lives_on() {
    let server = server();
    let mut wire = server.connect();
    let deep = "[".repeat(100_000);
    let huge = format!(
        r#"{{"jsonrpc":"2.0","id":7,"method":"{}"}}"#,
        "x".repeat(1 << 20)
    );
    let table: &[(&[u8], Value, &str, Value)] = &[
        (b"{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"server.\xFFping\"}", Value::Null, "parse_error", Value::Null),
        (b"\xC3\x28", Value::Null, "parse_error", Value::Null),
        (b"hello", Value::Null, "parse_error", Value::Null),
        (b"\0", Value::Null, "parse_error", Value::Null),
        (b"{\"jsonrpc\":\"2.0\",\"id\":7,\"method\":\"server.ping\"", json!(7), "parse_error", Value::Null),
        (b"{\"jsonrpc\":\"2.0\",\"id\":7,\"method\":\"server.ping\"} {}", json!(7), "parse_error", Value::Null),
        (deep.as_bytes(), Value::Null, "parse_error", Value::Null),
        (b"[]", Value::Null, "invalid_request", Value::Null),
        (b"[{\"jsonrpc\":\"2.0\",\"id\":7,\"method\":\"server.ping\"}]", Value::Null, "invalid_request", Value::Null),
        (b"3", Value::Null, "invalid_request", Value::Null),
        (b"null", Value::Null, "invalid_request", Value::Null),
        (b"{\"id\":7,\"method\":\"server.ping\"}", json!(7), "invalid_request", json!("jsonrpc")),
        (b"{\"jsonrpc\":\"1.0\",\"id\":7,\"method\":\"server.ping\"}", json!(7), "invalid_request", json!("jsonrpc")),
        (b"{\"jsonrpc\":2.0,\"id\":7,\"method\":\"server.ping\"}", json!(7), "invalid_request", json!("jsonrpc")),
        (b"{\"jsonrpc\":\"2.0\",\"id\":7}", json!(7), "invalid_request", json!("method")),
        (b"{\"jsonrpc\":\"2.0\",\"id\":7,\"method\":3}", json!(7), "invalid_request", json!("method")),
        (b"{\"jsonrpc\":\"2.0\",\"id\":7,\"method\":\"server.ping\",\"params\":[]}", json!(7), "invalid_request", json!("params")),
        (b"{\"jsonrpc\":\"2.0\",\"id\":7,\"method\":\"server.ping\",\"parms\":{}}", json!(7), "invalid_request", json!("parms")),
        (b"{\"jsonrpc\":\"2.0\",\"id\":7,\"method\":\"server.ping\",\"deadline_ms\":-1}", json!(7), "invalid_request", json!("deadline_ms")),
        (b"{\"jsonrpc\":\"2.0\",\"id\":7,\"id\":8,\"method\":\"server.ping\"}", json!(7), "invalid_request", json!("id")),
        (b"{\"jsonrpc\":\"2.0\",\"id\":7,\"method\":\"server.ping\",\"method\":\"server.ping\"}", json!(7), "invalid_request", json!("method")),
        (b"{\"jsonrpc\":\"2.0\",\"id\":7,\"method\":\"rig.describe\",\"params\":{\"rig\":\"a\",\"rig\":\"b\"}}", json!(7), "invalid_params", json!("rig")),
        (b"{\"jsonrpc\":\"2.0\",\"id\":7,\"method\":\"pose.set\",\"params\":{\"rig\":\"figure\",\"pose\":{\"dofs\":{\"a\":1,\"a\":1}}}}", json!(7), "invalid_params", json!("pose.dofs.a")),
        (b"{\"jsonrpc\":\"2.0\",\"id\":7,\"method\":\"server.pong\"}", json!(7), "method_not_found", json!("method")),
        (huge.as_bytes(), json!(7), "method_not_found", json!("method")),
    ];
    for (line, id, kind, path) in table {
        let shown = line[..line.len().min(100)].escape_ascii();
        wire.send(line);
        wire.send("\n");
        let reply = wire.reply();
        let data = &reply["error"]["data"];
        assert_eq!(
            (&reply["id"], &data["kind"], &data["path"]),
            (id, &json!(kind), path),
            "{shown}: {reply}"
        );
        assert!(reply.to_string().len() < 1000, "{shown}");
    }
    wire.assert_alive();
}

#[test]
fn ids_come_back_as_they_were() {
    let server = server();
    let mut wire = server.connect();
    let longest = "x".repeat(64);
    for id in [
        json!(0),
        json!(-1),
        json!(i64::MIN),
        json!(u64::MAX),
        json!(""),
        json!("1"),
        json!("\"\\\n\u{0}é"),
        json!(longest),
        Value::Null,
    ] {
        wire.send(ping(id.clone()));
        assert_eq!(wire.result(id), json!({}));
    }
    // An integral float is an integer, and comes back as one.
    wire.send(ping(json!(1e3)));
    assert_eq!(wire.result(1000), json!({}));
    for id in [
        json!(1.5),
        json!(1e300),
        json!(true),
        json!({}),
        json!([1]),
        json!("x".repeat(65)),
        // 33 characters, but 66 bytes.
        json!("é".repeat(33)),
    ] {
        wire.send(ping(id.clone()));
        let data = wire.error(Value::Null);
        let wanted = json!({"kind": "invalid_request", "retryable": false, "path": "id"});
        assert_eq!(data, wanted, "{id}");
    }
    wire.send("{\"jsonrpc\":\"2.0\",\"id\":18446744073709551616,\"method\":\"server.ping\"}\n");
    assert_eq!(wire.error(Value::Null)["path"], "id");
    wire.assert_alive();
}

#[test]
fn a_notification_is_never_answered() {
    let service = &SERVICE;
    let server = TestServer::start(service);
    let mut wire = server.connect();
    load_bone(&mut wire, "notified");
    let notify = |method: &str, params: Value| {
        format!(
            "{}\n",
            json!({"jsonrpc": "2.0", "method": method, "params": params})
        )
    };
    for line in [
        notify("server.ping", json!({})),
        notify("server.ping", json!({"unknown": 1})),
        notify("no.such.method", json!({})),
        notify("rig.describe", json!({"rig": "nowhere"})),
        notify("frame.render", picture(16)),
        notify("request.cancel", json!({"request": 1})),
        notify("request.cancel", json!({"what": 1})),
        notify(
            "pose.set",
            json!({"rig": "notified", "pose": {"dofs": {"bone.rx": 0.25}}}),
        ),
    ] {
        wire.send(line);
    }
    // Only asking is not worth the work, but what changes something has been done.
    wire.request(1, "pose.get", json!({"rig": "notified"}));
    assert_eq!(wire.result(1)["dofs"]["bone.rx"], 0.25);
}

#[test]
fn pipelined_pictures_come_in_order_and_hold_nobody_up() {
    const COUNT: usize = 200;
    // Large enough that half of them take many times as long as a busy machine makes anybody wait for a turn.
    const SIDE: u32 = 256;
    let server = server();
    let mut wire = server.connect();
    let mut other = server.connect();
    let mut writer = wire.writer();
    let written = std::thread::spawn(move || {
        for id in 0..COUNT {
            writer
                .write_all(request(id, "frame.render", picture(SIDE)).as_bytes())
                .expect("the server reads on");
        }
    });
    let received = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            for id in 0..COUNT {
                assert_is_png(&png(&wire.result(id)), SIDE);
                received.fetch_add(1, Ordering::SeqCst);
            }
        });
        // Once they are on their way, somebody who wants next to nothing is answered long before the last of them.
        let end = Instant::now() + support::server::PATIENCE;
        while received.load(Ordering::SeqCst) == 0 {
            assert!(Instant::now() < end, "not one picture came");
            std::thread::yield_now();
        }
        other.assert_alive();
        let before = received.load(Ordering::SeqCst);
        assert!(before < COUNT / 2, "{before} pictures came first");
    });
    written.join().expect("all are written");
    wire.assert_alive();
}

#[test]
fn a_pose_set_before_a_picture_is_in_the_picture() {
    let server = server();
    let mut wire = server.connect();
    // A name of its own, since the stored pose is everybody's.
    let files: Vec<Value> = [
        ("figure.skel", include_str!("../assets/figure.skel")),
        ("figure.skin", include_str!("../assets/figure.skin")),
    ]
    .map(|(name, text)| json!({"name": name, "text": text}))
    .to_vec();
    wire.request(0, "rig.load", json!({"name": "pipelined", "files": files}));
    wire.result(0);
    let angles = [0.0, 0.4, -0.8, 1.2];
    let picture =
        |pose: Value| json!({"rig": "pipelined", "pose": pose, "size": [64, 64], "image": "rgba8"});
    let bent = |angle: f64| json!({"dofs": {"upper_arm_l.rz": angle}});
    for angle in angles {
        wire.request(
            1,
            "pose.set",
            json!({"rig": "pipelined", "pose": bent(angle)}),
        );
        wire.request(2, "frame.render", picture(json!({})));
    }
    let stored = angles.map(|_| {
        wire.result(1);
        wire.result(2)["images"]["color"]["data"].take()
    });
    let inline = angles.map(|angle| {
        let mut pose = bent(angle);
        pose["base"] = json!("rest");
        wire.request(3, "frame.render", picture(pose));
        wire.result(3)["images"]["color"]["data"].take()
    });
    assert!(
        stored == inline,
        "the stored poses and the same poses inline make other pictures"
    );
    assert!(stored[0] != stored[1], "the pose is not in the picture");
}

/// A rig of one joint, from attached bytes.
fn load_bone(wire: &mut Wire, name: &str) {
    let file = b"balljoint bone {\n}\n";
    let params = json!({
        "name": name,
        "files": [{"name": "bone.skel", "attach": {"offset": 0, "bytes": file.len()}}],
    });
    send_attached(wire, 0, "rig.load", params, file);
    assert_eq!(wire.result(0)["joint_count"], 1);
}

fn send_attached(wire: &mut Wire, id: u64, method: &str, params: Value, attached: &[u8]) {
    let request = json!({
        "jsonrpc": "2.0", "id": id, "method": method, "params": params, "attach_bytes": attached.len(),
    });
    wire.send(format!("{request}\n"));
    wire.send(attached);
}

#[test]
fn files_and_values_may_follow_a_request_as_raw_bytes() {
    let server = server();
    let mut wire = server.connect();
    let skel: &[u8] = b"balljoint hip { balljoint knee { offset 0 -1 0 rotzlimit 0 2 } }";
    let skin: &[u8] = b"positions 3 { 0 0 0 1 0 0 0 1 0 } skinweights 3 { 1 0 1 1 0 1 1 1 1 }
        bindings 2 { matrix { 1 0 0 0 1 0 0 0 1 0 0 0 } matrix { 1 0 0 0 1 0 0 0 1 0 -1 0 } } triangles 1 { 0 1 2 }";
    // In reverse, with a gap that looks like a request.
    let gap = ping(99);
    let attached = [skin, gap.as_bytes(), skel].concat();
    let [skel_text, skin_text] = [skel, skin].map(|file| String::from_utf8_lossy(file));
    let inline =
        json!([{"name": "leg.skel", "text": skel_text}, {"name": "leg.skin", "text": skin_text}]);
    wire.request(0, "rig.load", json!({"name": "leg", "files": inline}));
    wire.result(0);
    let files = json!([
        {"name": "leg.skel", "attach": {"offset": skin.len() + gap.len(), "bytes": skel.len()}},
        {"name": "leg.skin", "attach": {"offset": 0, "bytes": skin.len()}},
    ]);
    let params = json!({"name": "attached", "files": files});
    send_attached(&mut wire, 1, "rig.load", params, &attached);
    let attached_digest = wire.result(1)["digest"].take();
    wire.request(2, "rig.describe", json!({"rig": "leg"}));
    let described = wire.result(2);
    assert_eq!(attached_digest, described["digest"]);

    let dofs = described["dofs"].as_array().expect("a list");
    // Exact as float32.
    let values: Vec<f32> = (0..dofs.len())
        .map(|index| (index % 5) as f32 / 64.0)
        .collect();
    let transforms = |pose: Value| json!({"rig": "leg", "pose": pose});
    let bytes: Vec<u8> = values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    let attach = json!({"attach": {"offset": 0, "bytes": bytes.len()}});
    let params = transforms(json!({"dof_values": attach, "limits": "ignore"}));
    send_attached(&mut wire, 3, "joint.transforms", params, &bytes);
    wire.request(
        4,
        "joint.transforms",
        transforms(json!({"dof_values": values, "limits": "ignore"})),
    );
    wire.request(5, "joint.transforms", transforms(json!({"base": "rest"})));
    let (from_bytes, from_list, rest) = (wire.result(3), wire.result(4), wire.result(5));
    assert_eq!(from_bytes, from_list);
    assert_ne!(from_bytes, rest);
}

#[test]
fn attached_bytes_that_are_not_there_or_make_no_sense_are_named() {
    let server = server();
    let mut wire = server.connect();
    for (method, params, path) in [
        (
            "rig.load",
            json!({"files": [{"name": "a.skel", "text": "joint a { }"}, {"name": "b.skin", "attach": {"offset": 2, "bytes": 7}}]}),
            "files[1].attach",
        ),
        (
            "joint.transforms",
            json!({"rig": "figure", "pose": {"dof_values": {"attach": {"offset": 9, "bytes": 0}}}}),
            "pose.dof_values.attach",
        ),
        (
            "joint.transforms",
            json!({"rig": "figure", "pose": {"dof_values": {"attach": {"offset": 0, "bytes": 7}}}}),
            "pose.dof_values.attach",
        ),
        (
            "joint.transforms",
            json!({"rig": "figure", "pose": {"dof_values": {"attach": {"offset": 0, "bytes": 8}}}}),
            "pose.dof_values",
        ),
    ] {
        send_attached(&mut wire, 1, method, params, b"\n{}\0\xFF\r\n\n");
        let mut reply = wire.reply();
        let data = reply["error"]["data"].take();
        assert_eq!(
            (&data["kind"], &data["path"]),
            (&json!("invalid_params"), &json!(path))
        );
        let message = reply["error"]["message"].as_str().expect("a sentence");
        assert_eq!(message.matches(path).count(), 1, "{message}");
    }
    wire.assert_alive();
}

#[test]
fn exactly_the_announced_bytes_follow_a_reply() {
    let server = server();
    let mut wire = server.connect();
    let mut attach = picture(48);
    attach["transport"] = json!("attach");
    wire.request(1, "frame.render", attach.clone());
    wire.request(2, "frame.render", picture(48));
    wire.request(
        3,
        "mesh.vertices",
        json!({"rig": "figure", "transport": "attach"}),
    );
    attach["image"] = json!("rgba8");
    wire.request(4, "frame.render", attach);
    wire.request(5, "server.ping", json!({}));

    let reply = wire.reply();
    let blob = &reply["result"]["images"]["color"];
    let count = reply["attach_bytes"].as_u64().expect("a number") as usize;
    let wanted = json!({"encoding": "attach", "media": "image/png", "bytes": count, "offset": 0});
    assert_eq!(blob, &wanted);
    let attached = wire.bytes(count);
    assert_is_png(&attached, 48);
    let plain = wire.reply();
    assert!(
        plain.get("attach_bytes").is_none(),
        "nothing was asked to be attached"
    );
    assert!(
        png(&plain["result"]) == attached,
        "both ways carry the same picture"
    );

    let reply = wire.reply();
    let mesh = &reply["result"]["meshes"][0];
    let vertex_count = mesh["vertex_count"].as_u64().expect("a number");
    let blob = |offset| json!({"encoding": "attach", "dtype": "float32", "shape": [vertex_count, 3], "bytes": 12 * vertex_count, "offset": offset});
    assert_eq!(
        (&mesh["positions"], &mesh["normals"]),
        (&blob(0), &blob(12 * vertex_count))
    );
    assert_eq!(reply["attach_bytes"], 24 * vertex_count);
    wire.bytes(24 * vertex_count as usize);

    let reply = wire.reply();
    let blob = &reply["result"]["images"]["color"];
    let wanted = json!({"encoding": "attach", "dtype": "uint8", "shape": [48, 48, 4], "bytes": 48 * 48 * 4, "offset": 0});
    assert_eq!(blob, &wanted);
    wire.bytes(48 * 48 * 4);
    assert_eq!(wire.result(5), json!({}));
}

#[test]
fn attachments_that_cannot_be_skipped_end_the_connection() {
    let server = TestServer::start(&NARROW);
    let with = |attach_bytes: &str| {
        format!(
            "{{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"server.ping\",\"attach_bytes\":{attach_bytes}}}\n"
        )
    };
    let limit = |asked: u64| json!({"kind": "limit_exceeded", "retryable": false, "limit": "attachment_bytes", "maximum": 4096, "asked": asked});
    let unreadable = json!({"kind": "invalid_request", "retryable": false, "path": "attach_bytes"});
    for (line, wanted) in [
        (with("4097"), limit(4097)),
        (with("18446744073709551615"), limit(u64::MAX)),
        (with("18446744073709551616"), unreadable.clone()),
        (with("-1"), unreadable.clone()),
        (with("1.5"), unreadable.clone()),
        (with("\"many\""), unreadable.clone()),
        (with("null"), unreadable),
        // Cut short, so that it cannot be told where the line's bytes end.
        (
            "{\"id\":1,\"jsonrpc\":\"2.0\",\"attach_bytes\"\n".to_owned(),
            json!({"kind": "parse_error", "retryable": false}),
        ),
    ] {
        let mut wire = server.connect();
        // What follows is not taken for a request, nor the reason for a reset.
        wire.send(line.clone() + &ping(2).repeat(1000));
        assert_eq!(wire.error(1), wanted, "{line}");
        wire.assert_end();
    }
    // What can be counted is skipped, whatever else is wrong.
    let mut wire = server.connect();
    wire.send(with("4096").replace("ping", "pong"));
    wire.send(vec![b'\n'; 4096]);
    assert_eq!(wire.error(1)["kind"], "method_not_found");
    wire.send(with("5").replace("2.0", "2.1"));
    wire.send("{}\n{}");
    assert_eq!(wire.error(1)["path"], "jsonrpc");
    wire.assert_alive();
}

#[test]
fn http_is_not_answered() {
    let server = server();
    let call = ping(1);
    for line in [
        "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n",
        "POST / HTTP/1.1\r\n\r\n",
        "\r\nPOST /x HTTP/1.0\n",
        "OPTIONS * HTTP/1.1\r\n",
        "PROPFIND / HTTP/1.1\r\n",
    ] {
        let mut wire = server.connect();
        wire.send(format!("{line}{call}"));
        wire.assert_end();
    }
    // Only a first line is looked at in this way; later ones are bad requests like any other.
    let mut wire = server.connect();
    wire.send(ping(0));
    wire.send("GET / HTTP/1.1\r\n");
    assert_eq!(wire.result(0), json!({}));
    assert_eq!(wire.error(Value::Null)["kind"], "parse_error");
    wire.assert_alive();
}

#[test]
fn a_deadline_that_passed_is_said_so_and_changes_nothing() {
    let server = server();
    let mut wire = server.connect();
    load_bone(&mut wire, "late");
    let late = |id: u64, deadline_ms: u64, method: &str, params: Value| {
        let request = json!({"jsonrpc": "2.0", "id": id, "method": method, "params": params, "deadline_ms": deadline_ms});
        format!("{request}\n")
    };
    wire.send(late(1, 0, "server.ping", json!({})));
    wire.send(late(
        2,
        0,
        "pose.set",
        json!({"rig": "late", "pose": {"dofs": {"bone.rx": 1.0}}}),
    ));
    wire.send(late(3, 0, "frame.render", picture(16)));
    // Work of seconds before it, so that one millisecond is too little for certain.
    for id in 4..8 {
        wire.request(id, "frame.render", picture(512));
    }
    wire.send(late(8, 1, "frame.render", picture(16)));
    wire.send(late(9, 60_000, "frame.render", picture(16)));
    wire.send(late(10, u64::MAX, "pose.get", json!({"rig": "late"})));
    let wanted = json!({"kind": "deadline_exceeded", "retryable": true});
    for id in 1..=3 {
        assert_eq!(wire.error(id), wanted);
    }
    for id in 4..8 {
        wire.result(id);
    }
    assert_eq!(wire.error(8), wanted);
    assert_is_png(&png(&wire.result(9)), 16);
    assert_eq!(wire.result(10)["dofs"]["bone.rx"], 0.0);
}

#[test]
fn a_picture_in_the_making_is_left_at_its_deadline() {
    let service = support::service_on("cpu").expect("it needs nothing");
    let server = TestServer::start(&service);
    let mut wire = server.connect();
    // One on the other, each over the whole picture: minutes of work.
    let triangles = "f 1 2 3\n".repeat(100_000);
    let heap = format!("v -100 -100 0\nv 100 -100 0\nv 0 200 0\n{triangles}");
    let files = json!([{"name": "heap.obj", "text": heap}]);
    wire.request(1, "rig.load", json!({"files": files}));
    wire.result(1);
    let camera = json!({"kind": "look_at", "eye": [0, 0, 2], "target": [0, 0, 0]});
    let params = json!({"rig": "heap", "size": [4096, 4096], "camera": camera});
    let request = json!({"jsonrpc": "2.0", "id": 2, "method": "frame.render", "params": params, "deadline_ms": 100});
    wire.send(format!("{request}\n"));
    // Its client waits no longer than that, nor does anybody else's picture.
    assert_eq!(wire.error(2)["kind"], "deadline_exceeded");
    wire.request(3, "frame.render", picture(16));
    assert_is_png(&png(&wire.result(3)), 16);
}

#[test]
fn a_cancelled_picture_is_answered_in_its_place() {
    let server = server();
    let mut wire = server.connect();
    let cancel = |request: Value| {
        let params = json!({"request": request});
        format!(
            "{}\n",
            json!({"jsonrpc": "2.0", "method": "request.cancel", "params": params})
        )
    };
    let mut lines = String::new();
    for id in 0..4 {
        lines += &request(id, "frame.render", picture(512));
    }
    lines += &request("doomed", "frame.render", picture(512));
    lines += &request(4, "frame.render", picture(16));
    // Another connection's request of the same id is none of this one's business, nor is one that never was.
    lines += &cancel(json!("doomed"));
    lines += &cancel(json!(12345));
    lines += &ping(5);
    let mut other = server.connect();
    other.send(request("doomed", "frame.render", picture(16)));
    wire.send(lines);
    for id in 0..4 {
        assert_is_png(&png(&wire.result(id)), 512);
    }
    let wanted = json!({"kind": "cancelled", "retryable": false});
    assert_eq!(wire.error("doomed"), wanted);
    assert_is_png(&png(&wire.result(4)), 16);
    assert_eq!(wire.result(5), json!({}));
    assert_is_png(&png(&other.result("doomed")), 16);
    // Answered already: passed over.
    wire.send(cancel(json!(5)));
    wire.assert_alive();
}

/// How many pictures the server has drawn so far.
fn drawn(service: &Arc<Service>) -> usize {
    let stats = support::ask_ok(service, "server.stats", json!({}));
    stats["frames"].as_u64().expect("a number") as usize
}

/// How many pictures the server has drawn once it draws no more.
fn drawn_in_the_end(service: &Arc<Service>) -> usize {
    let mut settled = (0, Instant::now());
    while settled.0 == 0 || settled.1.elapsed() < Duration::from_millis(500) {
        std::thread::sleep(Duration::from_millis(20));
        let now = drawn(service);
        if now != settled.0 {
            settled = (now, Instant::now());
        }
    }
    settled.0
}

#[test]
fn a_client_that_does_not_read_leaves_room_for_the_pictures_of_others() {
    // Room for eight pictures of its kind altogether, half of it for one connection.
    let limits = Limits {
        in_flight_bytes: 8 * 10 * 1024 * 1024,
        in_flight_bytes_per_connection: 4 * 10 * 1024 * 1024,
        ..Limits::default()
    };
    let service = support::service_with(limits, Source::inline_only());
    let server = TestServer::start(&service);
    let mut greedy = server.connect();
    let mut large = picture(1024);
    large["image"] = json!("rgba8");
    for id in 0..20 {
        greedy.request(id, "frame.render", large.clone());
    }
    // Some 6 MB each as text: when nothing more is drawn, what lies between it and the server is full.
    assert!(drawn_in_the_end(&service) < 20, "nothing is full");
    let mut other = server.connect();
    for id in 0..3 {
        other.request(id, "frame.render", large.clone());
        let frame = other.result(id);
        assert_eq!(frame["images"]["color"]["bytes"], 1024 * 1024 * 4);
    }
}

#[test]
fn a_client_that_does_not_read_slows_nobody_but_itself_down() {
    const ASKED: usize = 1000;
    const AT_A_TIME: u64 = 4;
    let limits = Limits {
        in_flight_per_connection: AT_A_TIME,
        ..Limits::default()
    };
    // Its own, so that the count of pictures is of this test alone.
    let service = support::service_with(limits, Source::inline_only());
    let server = TestServer::start(&service);
    let mut greedy = server.connect();
    // Some 350 KiB each as text: a few dozen fill every buffer between the server and a client.
    let mut large = picture(256);
    large["image"] = json!("rgba8");
    for id in 0..ASKED {
        greedy.request(id, "frame.render", large.clone());
    }
    let mut other = server.connect();
    for id in 0..20 {
        other.request(id, "frame.render", picture(16));
        assert_is_png(&png(&other.result(id)), 16);
    }
    let depth = service.engine().admission().depth();
    assert!(depth <= AT_A_TIME + 1, "{depth} requests wait");
    // Left alone until nothing more is drawn for it, it has had what fits into the buffers and no more.
    let in_the_end = drawn_in_the_end(&service);
    assert!(
        in_the_end < ASKED / 4,
        "{in_the_end} pictures for somebody who reads none"
    );
    // As soon as it reads, it gets the rest.
    for id in 0..in_the_end + 10 {
        let frame = greedy.result(id);
        assert_eq!(frame["images"]["color"]["bytes"], 256 * 256 * 4);
    }
    // And gone with hundreds still asked for, it does no harm.
    drop(greedy);
    other.assert_alive();
    let end = Instant::now() + support::server::PATIENCE;
    while service.engine().admission().depth() > 0 {
        assert!(Instant::now() < end, "its requests are still worked on");
        std::thread::yield_now();
    }
    assert!(
        drawn(&service) < ASKED,
        "somebody who has gone was drawn for"
    );
}

#[test]
fn a_client_that_vanishes_does_no_harm() {
    let server = server();
    let mut witness = server.connect();
    for reads in [0, 1] {
        let mut wire = server.connect();
        for id in 0..10 {
            wire.request(id, "frame.render", picture(256));
        }
        for id in 0..reads {
            wire.result(id);
        }
        // With replies unread this is a reset, and no orderly end.
        drop(wire);
        witness.request(1, "frame.render", picture(32));
        assert_is_png(&png(&witness.result(1)), 32);
    }
    // In the middle of a line, and of raw bytes.
    for start in [
        "{\"jsonrpc\"",
        "{\"jsonrpc\":\"2.0\",\"attach_bytes\":9}\nx",
    ] {
        let mut wire = server.connect();
        wire.send(start);
        drop(wire);
        witness.assert_alive();
    }
}

#[test]
fn many_connections_at_once_each_get_their_own() {
    let server = server();
    std::thread::scope(|scope| {
        for client in 0..64 {
            let server = &server;
            scope.spawn(move || {
                let mut wire = server.connect();
                for round in 0..3 {
                    let id = |what: &str| format!("{client} {round} {what}");
                    let side = 8 + client % 8;
                    wire.send(ping(id("ping")));
                    wire.request(id("draw"), "frame.render", picture(side));
                    wire.request(id("where"), "joint.transforms", json!({"rig": "figure"}));
                    assert_eq!(wire.result(id("ping")), json!({}));
                    assert_is_png(&png(&wire.result(id("draw"))), side);
                    assert!(wire.result(id("where"))["joints"][0]["name"].is_string());
                }
            });
        }
    });
}

#[test]
fn a_connection_too_many_is_told_so_and_closed() {
    let server = TestServer::start(&NARROW);
    let mut open: Vec<Wire> = (0..3).map(|_| server.connect()).collect();
    for wire in &mut open {
        wire.assert_alive();
    }
    // Whether or not it has said something itself, it gets to read why.
    for says in [String::new(), ping(1), ping(1).repeat(1000)] {
        let mut wire = server.connect();
        // Refused already, perhaps.
        let _ = wire.writer().write_all(says.as_bytes());
        let data = wire.error(Value::Null);
        assert_eq!(
            (&data["kind"], &data["limit"], &data["maximum"]),
            (&json!("limit_exceeded"), &json!("connections"), &json!(3))
        );
        wire.assert_end();
    }
    for wire in &mut open {
        wire.assert_alive();
    }
    // A place that was given up can be had again, if perhaps not at once.
    open.pop();
    let end = Instant::now() + support::server::PATIENCE;
    loop {
        let mut wire = server.connect();
        let _ = wire.writer().write_all(ping(1).as_bytes());
        if wire.reply().get("result").is_some() {
            break;
        }
        assert!(Instant::now() < end, "there is no place again");
    }
}

#[test]
fn a_server_with_too_much_to_do_is_busy_and_says_until_when() {
    let server = TestServer::start(&NARROW);
    let mut wire = server.connect();
    for id in 0..8 {
        wire.request(id, "frame.render", picture(512));
    }
    wire.send(ping(8));
    assert_is_png(&png(&wire.result(0)), 512);
    let mut refused = 0;
    for id in 1..8 {
        let reply = wire.reply();
        assert_eq!(reply["id"], id);
        let error = &reply["error"];
        if error.is_null() {
            continue;
        }
        refused += 1;
        assert_eq!(error["code"], -32005);
        let data = &error["data"];
        assert_eq!(
            (&data["kind"], &data["retryable"]),
            (&json!("busy"), &json!(true))
        );
        assert_eq!(data["queue_depth"], 1);
        let wait = data["retry_after_ms"].as_u64().expect("a number");
        assert!((10..=5000).contains(&wait), "{wait} ms");
    }
    assert!(refused > 0, "one at a time was allowed, and all were taken");
    // What does not draw is answered all the same.
    assert_eq!(wire.result(8), json!({}));
    // Somebody who waits as long as told gets through.
    for _ in 0..100 {
        wire.request(9, "frame.render", picture(16));
        let reply = wire.reply();
        match reply["error"]["data"]["retry_after_ms"].as_u64() {
            Some(wait) => std::thread::sleep(Duration::from_millis(wait)),
            None => return assert_is_png(&png(&reply["result"]), 16),
        }
    }
    panic!("busy for ever");
}

#[test]
fn the_client_of_this_crate_speaks_to_it() {
    let server = server();
    let mut client = rigd::client::Client::connect(server.address).expect("the server listens");
    client
        .set_timeout(Some(support::server::PATIENCE))
        .expect("it is not zero");
    let mut params = picture(24);
    params["transport"] = json!("attach");
    let early = client.send("frame.render", &params).expect("it is sent");
    let (info, _) = client.call_raw("server.info", json!({})).expect("a result");
    assert_eq!(info["name"], "rigd");
    let received = client.receive().expect("a reply");
    assert_eq!(received.id, early);
    assert_is_png(&received.attached, 24);
    let error = client
        .call_raw("rig.describe", json!({"rig": "nowhere"}))
        .expect_err("there is no such rig");
    assert!(
        matches!(&error, rigd::client::ClientError::Server(error) if error.data.kind == "rig_not_loaded"),
        "{error}"
    );
}
