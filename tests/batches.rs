//! Does a batch come to what its parts come to one by one, in order, within bounds, and is it over when nobody wants it any more?

mod support;

use rigd::limits::Limits;
use rigd::service::Service;
use serde_json::{Value, json};
use std::sync::{Arc, LazyLock};
use std::time::{Duration, Instant};
use support::server::{PATIENCE, TestServer, Wire};
use support::{ask, ask_ok};

static SERVICE: LazyLock<Arc<Service>> = LazyLock::new(support::service);

/// Laid over a common part: another pose, camera, look, size and rig.
fn changes() -> Vec<Value> {
    vec![
        json!({}),
        json!({"pose": {"dofs": {"upper_arm_l.rz": 0.5}}}),
        json!({"camera": {"kind": "orbit", "azimuth": 2.0}}),
        json!({"pose": {"dofs": {"upper_arm_l.rz": 0.5}}, "camera": {"kind": "orbit", "azimuth": 3.0}}),
        json!({"size": [40, 30], "samples": 1, "background": [1, 1, 1, 0]}),
        json!({"show": {"skeleton": "sticks", "skin_opacity": 0.5}, "lights": [], "ambient": [1, 1, 1]}),
        json!({"rig": "bone", "pose": {"base": "rest"}, "material": {"shininess": 3.0}, "cull": "never"}),
        json!({"skinning": "dual_quaternion", "compression": "best"}),
    ]
}

fn common() -> Value {
    json!({"rig": "figure", "size": [64, 48], "pose": {"base": "rest", "dofs": {"head.ry": 0.3}}})
}

fn over(common: &Value, change: &Value) -> Value {
    let mut whole = common.clone();
    let members = whole.as_object_mut().expect("an object");
    members.extend(change.as_object().expect("an object").clone());
    whole
}

fn load_bone(service: &Arc<Service>) {
    let text = "balljoint bone { offset 0 1 0 balljoint tip { offset 0 1 0 } }";
    let files = json!([{"name": "bone.skel", "text": text}]);
    ask_ok(service, "rig.load", json!({"files": files}));
}

/// What it is, whatever it took.
fn without_timings(mut item: Value) -> Value {
    let members = item.as_object_mut().expect("an object");
    assert!(members.remove("timings_ms").is_some(), "{members:?}");
    item
}

#[test]
fn every_picture_of_a_batch_is_the_one_that_it_would_be_alone() {
    load_bone(&SERVICE);
    let mut batch = common();
    batch["frames"] = json!(changes());
    let result = ask_ok(&SERVICE, "frame.batch", batch);
    assert_eq!(result["frame_count"], changes().len());
    let frames = result["frames"].as_array().expect("a list").clone();
    assert_eq!(frames.len(), changes().len());
    for (frame, change) in frames.into_iter().zip(changes()) {
        let alone = ask_ok(&SERVICE, "frame.render", over(&common(), &change));
        assert!(
            without_timings(frame) == without_timings(alone),
            "{change} is another one alone"
        );
    }
}

/// The items of a streamed batch, each with the bytes that followed it, and the reply.
fn streamed(wire: &mut Wire, method: &str, item: &str) -> (Vec<(Value, Vec<u8>)>, Value) {
    let mut items = Vec::new();
    loop {
        let mut message = wire.reply();
        let attached = message["attach_bytes"].as_u64().unwrap_or(0);
        let attached = wire.bytes(attached as usize);
        if message.get("method").is_none() {
            return (items, message);
        }
        assert_eq!(message["method"], method);
        let params = &mut message["params"];
        assert_eq!(params["index"], items.len());
        assert_eq!(params["request"], "many");
        items.push((params[item].take(), attached));
    }
}

fn content(frame: &Value, attached: &[u8]) -> Vec<u8> {
    let blob = &frame["images"]["color"];
    let blob: rigd::protocol::Blob = serde_json::from_value(blob.clone()).expect("a blob");
    blob.bytes(attached).expect("it is there").into_owned()
}

#[test]
fn a_streamed_batch_comes_in_order_ahead_of_its_reply() {
    load_bone(&SERVICE);
    let server = TestServer::start(&SERVICE);
    for (transport, count) in [("attach", 60), ("base64", 20), ("attach", 0)] {
        let frames: Vec<Value> = changes().into_iter().cycle().take(count).collect();
        let mut batch = common();
        batch["frames"] = json!(frames);
        batch["transport"] = json!(transport);
        let mut wire = server.connect();
        wire.request(0, "server.ping", json!({}));
        let mut stream = batch.clone();
        stream["stream"] = json!(true);
        wire.request("many", "frame.batch", stream);
        // Asked behind it, answered behind it.
        wire.request(2, "server.ping", json!({}));
        wire.result(0);
        let (items, reply) = streamed(&mut wire, "frame.ready", "frame");
        assert_eq!(reply["result"], json!({"frame_count": count}));
        wire.result(2);
        wire.request(3, "frame.batch", batch);
        let whole = wire.reply();
        let attached = wire.bytes(whole["attach_bytes"].as_u64().unwrap_or(0) as usize);
        let together = whole["result"]["frames"].as_array().expect("a list");
        assert_eq!((items.len(), together.len()), (count, count));
        for ((frame, own), other) in items.iter().zip(together) {
            assert!(content(frame, own) == content(other, &attached));
        }
    }
}

#[test]
fn what_is_wrong_with_a_picture_is_told_before_any_is_drawn() {
    load_bone(&SERVICE);
    let frames = |service: &Arc<Service>| {
        let stats = ask_ok(service, "server.stats", json!({}));
        stats["frames"].as_u64()
    };
    let service = support::service();
    load_bone(&service);
    let before = frames(&service);
    for (change, path) in [
        (
            json!({"camera": {"kind": "orbit", "fov_y": -1}}),
            "frames[1].camera.fov_y",
        ),
        (
            json!({"camera": {"kind": "orbit", "fovy": 1}}),
            "frames[1].camera.fovy",
        ),
        (json!({"colour": 1}), "frames[1].colour"),
        (json!({"frames": []}), "frames[1].frames"),
        (
            json!({"pose": {"dofs": {"head.rq": 1}}}),
            "frames[1].pose.dofs.head.rq",
        ),
        (
            json!({"pose": {"dofs": {"head.rx": 9}, "limits": "reject"}}),
            "frames[1].pose.dofs.head.rx",
        ),
        (json!({"outputs": []}), "frames[1].outputs"),
        (json!([]), "frames[1]"),
        (
            json!({"lights": [{"kind": "sun"}]}),
            "frames[1].lights[0].kind",
        ),
        // The pose is that of the common part, which suits the rig there.
        (json!({"rig": "bone"}), "frames[1].pose.dofs.head.ry"),
        (json!({"rig": "nobody"}), "frames[1]"),
        (json!({"size": [5000, 5000]}), "frames[1]"),
    ] {
        let mut batch = common();
        batch["frames"] = json!([{}, change]);
        for streams in [false, true] {
            batch["stream"] = json!(streams);
            let error = ask(&service, "frame.batch", batch.clone()).expect_err("it is wrong");
            assert_eq!(
                error.detail("path"),
                Some(&json!(path)),
                "{change}: {error}"
            );
        }
    }
    let mut batch = common();
    batch["frames"] = json!([{}, {"rig": "nobody"}]);
    let error = ask(&service, "frame.batch", batch).expect_err("there is no such rig");
    assert_eq!(error.detail("rig"), Some(&json!("nobody")));
    assert_eq!(error.message, "frames[1]: rig `nobody` is not loaded");
    // What is wrong with the common part is its own, also where there is no picture.
    for frames in [json!([]), json!([{}, {"ambient": [1, 1, 1]}])] {
        let mut batch = common();
        batch["frames"] = frames;
        batch["camera"] = json!({"kind": "orbit", "fov_y": -1});
        let error = ask(&service, "frame.batch", batch).expect_err("it is wrong");
        assert_eq!(error.detail("path"), Some(&json!("camera.fov_y")));
    }
    let error = ask(&service, "frame.batch", common()).expect_err("it has no frames");
    assert_eq!(error.detail("path"), Some(&json!("frames")));
    assert_eq!(frames(&service), before);
}

#[test]
fn a_batch_is_of_the_rigs_and_poses_that_were_there_when_it_came() {
    let service = support::service();
    load_bone(&service);
    let server = TestServer::start(&service);
    let mut wire = server.connect();
    let frame = json!({"rig": "bone", "size": [32, 32], "transport": "attach", "image": "rgba8"});
    wire.request(1, "frame.render", frame.clone());
    let alone = wire.reply();
    let wanted = wire.bytes(alone["attach_bytes"].as_u64().expect("bytes") as usize);
    let mut batch = frame;
    batch["frames"] = json!(vec![json!({}); 40]);
    batch["stream"] = json!(true);
    wire.request("many", "frame.batch", batch);
    let pose = json!({"dofs": {"bone.rz": 1.0}});
    wire.request(2, "pose.set", json!({"rig": "bone", "pose": pose}));
    wire.request(3, "rig.unload", json!({"rig": "bone"}));
    let (items, _) = streamed(&mut wire, "frame.ready", "frame");
    assert_eq!(items.len(), 40);
    for (_, pixels) in items {
        assert!(pixels == wanted);
    }
    wire.result(2);
    wire.result(3);
}

#[test]
fn a_batch_keeps_to_its_limits() {
    let limits = Limits {
        batch_items: 30,
        batch_bytes: 100_000,
        ..Limits::default()
    };
    let service = support::service_with(limits, rigd::formats::Source::inline_only());
    let pixels = |count: usize, streams: bool| {
        let mut batch =
            json!({"rig": "figure", "size": [64, 64], "image": "rgba8", "stream": streams});
        batch["frames"] = json!(vec![json!({}); count]);
        ask(&service, "frame.batch", batch)
    };
    let exceeded = |outcome: Result<Value, rigd::protocol::ErrorObject>| {
        outcome
            .expect_err("it is too much")
            .detail("limit")
            .cloned()
    };
    assert_eq!(exceeded(pixels(31, true)), Some(json!("batch_items")));
    assert_eq!(exceeded(pixels(30, false)), Some(json!("batch_bytes")));
    assert_eq!(drawn(&service), 0, "its size was known beforehand");
    assert!(pixels(30, true).is_ok());
    assert!(pixels(2, false).is_ok());
    let joints = |count: usize| {
        let poses = vec![json!({}); count];
        let params = json!({"rig": "figure", "poses": poses, "attributes": ["joints"], "transport": "attach"});
        ask(&service, "mesh.batch", params)
    };
    assert_eq!(exceeded(joints(31)), Some(json!("batch_items")));
    assert!(joints(30).is_ok());
    let vertices = |count: usize| {
        let poses = vec![json!({}); count];
        ask(
            &service,
            "mesh.batch",
            json!({"rig": "figure", "poses": poses, "transport": "attach"}),
        )
    };
    assert_eq!(exceeded(vertices(30)), Some(json!("batch_bytes")));
    // How small a PNG comes out is found by drawing it; what was given up on holds nothing.
    for _ in 0..20 {
        let mut batch = json!({"rig": "figure", "size": [256, 256]});
        batch["frames"] = json!(vec![json!({}); 30]);
        let outcome = ask(&service, "frame.batch", batch);
        assert_eq!(exceeded(outcome), Some(json!("batch_bytes")));
    }
    assert_idle(&service);
}

/// What is being drawn when a batch ends is left soon, and not drawn to the end.
fn assert_idle(service: &Arc<Service>) {
    let until = Instant::now() + PATIENCE;
    while ask_ok(service, "server.stats", json!({}))["queue_depth"] != 0 {
        assert!(Instant::now() < until, "something is still in hand");
        std::thread::sleep(Duration::from_millis(10));
    }
}

fn drawn(service: &Arc<Service>) -> u64 {
    let stats = ask_ok(service, "server.stats", json!({}));
    stats["frames"].as_u64().expect("a number")
}

/// Asks for more than fits into sockets' buffers and takes nothing in.
fn ask_without_reading(server: &TestServer, count: usize) -> Wire {
    let mut wire = server.connect();
    let mut batch = json!({"rig": "figure", "size": [256, 256], "image": "rgba8", "transport": "attach", "stream": true});
    batch["frames"] = json!(vec![json!({}); count]);
    wire.request("many", "frame.batch", batch);
    wire
}

/// How many pictures were drawn once that no longer changes.
fn settled(service: &Arc<Service>) -> u64 {
    let (mut last, mut since) = (drawn(service), Instant::now());
    while since.elapsed() < Duration::from_millis(500) {
        std::thread::sleep(Duration::from_millis(20));
        let now = drawn(service);
        if now != last {
            (last, since) = (now, Instant::now());
        }
    }
    last
}

#[test]
fn a_client_that_does_not_read_slows_nobody_but_itself() {
    const COUNT: usize = 1000;
    let service = support::service();
    let server = TestServer::start(&service);
    let mut wire = ask_without_reading(&server, COUNT);
    let stuck = settled(&service);
    assert!((1..COUNT as u64 / 2).contains(&stuck), "{stuck} were drawn");
    // Others are served meanwhile.
    let mut other = server.connect();
    other.request(1, "frame.render", support::server::picture(16));
    other.result(1);
    let (items, reply) = streamed(&mut wire, "frame.ready", "frame");
    assert_eq!(items.len(), COUNT);
    assert_eq!(reply["result"]["frame_count"], COUNT);
}

#[test]
fn a_batch_is_over_once_its_client_is_gone_or_gives_up() {
    const COUNT: usize = 5000;
    let service = support::service();
    let server = TestServer::start(&service);
    let wire = ask_without_reading(&server, COUNT);
    settled(&service);
    drop(wire);
    let gone = settled(&service);
    assert!(gone < COUNT as u64 / 2, "{gone} were drawn for nobody");

    let mut wire = ask_without_reading(&server, COUNT);
    settled(&service);
    let cancel =
        json!({"jsonrpc": "2.0", "method": "request.cancel", "params": {"request": "many"}});
    wire.send(format!("{cancel}\n"));
    let (items, reply) = streamed(&mut wire, "frame.ready", "frame");
    assert!(items.len() < COUNT / 2);
    assert_eq!(reply["error"]["data"]["kind"], "cancelled");
    wire.assert_alive();
    assert_idle(&service);
}

#[test]
fn a_batch_that_is_late_ends_with_what_is_done() {
    let service = support::service();
    let server = TestServer::start(&service);
    let mut wire = server.connect();
    let frames = vec![json!({}); 20_000];
    let params = json!({"rig": "figure", "size": [128, 128], "stream": true, "transport": "attach", "frames": frames});
    let request = json!({"jsonrpc": "2.0", "id": "many", "method": "frame.batch", "params": params, "deadline_ms": 1500});
    wire.send(format!("{request}\n"));
    let (items, reply) = streamed(&mut wire, "frame.ready", "frame");
    assert!(items.len() < 20_000);
    assert_eq!(reply["error"]["data"]["kind"], "deadline_exceeded");
    wire.assert_alive();
}

#[test]
fn the_poses_of_a_mesh_batch_are_those_that_they_would_be_alone() {
    let poses = [
        json!({"base": "rest"}),
        json!({"base": "rest", "dofs": {"head.ry": 0.4, "morph.smile": 1}}),
        json!({"base": "rest", "clip": {"name": "walk", "time": 0.3}}),
        json!({"base": "rest", "dofs": {"head.rx": 9}}),
    ];
    let whole = json!({"rig": "figure", "poses": poses, "mesh": "mesh_0", "range": {"start": 5, "count": 7}, "transport": "base64"});
    for attributes in [
        json!(["positions", "normals"]),
        json!(["normals"]),
        json!(["positions"]),
    ] {
        let mut batch = whole.clone();
        batch["attributes"] = attributes.clone();
        let result = ask_ok(&SERVICE, "mesh.batch", batch.clone());
        assert_eq!(result["item_count"], poses.len());
        for (item, pose) in result["items"]
            .as_array()
            .expect("a list")
            .iter()
            .zip(&poses)
        {
            let mut alone = batch.clone();
            let members = alone.as_object_mut().expect("an object");
            members.remove("poses");
            members.insert("pose".to_owned(), pose.clone());
            let alone = ask_ok(&SERVICE, "mesh.vertices", alone);
            assert_eq!(
                without_timings(item.clone()),
                without_timings(alone),
                "{pose}"
            );
        }
    }
}

#[test]
fn joints_come_in_arrays_and_need_no_skin() {
    let service = support::service();
    let dofs = ask_ok(&service, "rig.describe", json!({"rig": "figure"}))["dofs"].take();
    let dofs = dofs.as_array().expect("a list").clone();
    let rest: Vec<f64> = dofs
        .iter()
        .map(|dof| dof["rest"].as_f64().expect("a number"))
        .collect();
    let turned = |by: f64| {
        let values = dofs
            .iter()
            .zip(&rest)
            .map(|(dof, rest)| match dof["name"].as_str() {
                Some("head.ry" | "upper_arm_l.rz") => rest + by,
                _ => *rest,
            });
        values.collect::<Vec<f64>>()
    };
    let rows = [turned(0.0), turned(0.125), turned(0.25)];
    let vertices = || ask_ok(&service, "server.stats", json!({}))["vertices"].take();
    let before = vertices();
    let params = json!({"rig": "figure", "attributes": ["joints"], "dof_values": rows.concat()});
    let result = ask_ok(&service, "mesh.batch", params);
    assert_eq!(vertices(), before);
    let items = result["items"].as_array().expect("a list");
    assert_eq!(items.len(), 3);
    for (item, row) in items.iter().zip(&rows) {
        assert_eq!(item["meshes"], json!([]));
        let pose = json!({"base": "rest", "dof_values": row});
        let alone = ask_ok(
            &service,
            "joint.transforms",
            json!({"rig": "figure", "pose": pose}),
        );
        let joints = alone["joints"].as_array().expect("a list");
        assert_eq!(item["joints"]["shape"], json!([joints.len(), 16]));
        let wanted = joints
            .iter()
            .flat_map(|joint| joint["world_from_joint"].as_array().expect("a list"));
        let found = item["joints"]["data"].as_array().expect("a list");
        for (wanted, found) in wanted.zip(found) {
            let (wanted, found) = (wanted.as_f64().expect("f64"), found.as_f64().expect("f64"));
            assert!((wanted - found).abs() <= 1e-6 * wanted.abs().max(1.0));
        }
    }
    for (params, path) in [
        (json!({"dof_values": rows.concat()[1..]}), "dof_values"),
        (
            json!({"poses": [{"dofs": {"nose.rx": 1}}]}),
            "poses[0].dofs.nose.rx",
        ),
        (json!({"poses": [{}], "dof_values": rows[0]}), "poses"),
        (json!({}), "poses"),
        (json!({"poses": [{}], "pose": {}}), "pose"),
        (
            json!({"poses": [], "attributes": ["colors"]}),
            "attributes[0]",
        ),
        (
            json!({"dof_values": {"attach": {"offset": 0, "bytes": 8}}}),
            "dof_values.attach",
        ),
    ] {
        let error = ask(
            &service,
            "mesh.batch",
            over(&json!({"rig": "figure"}), &params),
        );
        let error = error.expect_err("it is wrong");
        assert_eq!(error.detail("path"), Some(&json!(path)), "{error}");
    }
}

#[test]
fn a_mesh_batch_is_streamed_and_takes_its_rows_attached() {
    let server = TestServer::start(&SERVICE);
    let mut wire = server.connect();
    wire.request(1, "rig.describe", json!({"rig": "figure"}));
    let dofs = wire.result(1)["dofs"].as_array().expect("a list").clone();
    let rows: Vec<u8> = (0..50)
        .flat_map(|row| {
            let values = dofs.iter().map(move |dof| {
                let rest = dof["rest"].as_f64().expect("a number") as f32;
                if dof["name"] == "head.ry" {
                    0.01 * row as f32
                } else {
                    rest
                }
            });
            values.collect::<Vec<f32>>()
        })
        .flat_map(f32::to_le_bytes)
        .collect();
    let params = json!({
        "rig": "figure", "dof_values": {"attach": {"offset": 0, "bytes": rows.len()}},
        "attributes": ["positions", "joints"], "transport": "attach", "stream": true,
    });
    let request = json!({"jsonrpc": "2.0", "id": "many", "method": "mesh.batch", "params": params, "attach_bytes": rows.len()});
    wire.send(format!("{request}\n"));
    wire.send(&rows);
    let (items, reply) = streamed(&mut wire, "mesh.ready", "item");
    assert_eq!(reply["result"], json!({"item_count": 50}));
    assert_eq!(items.len(), 50);
    let (first, last) = (&items[0].1, &items[49].1);
    assert_eq!(first.len(), last.len());
    assert!(first != last);
}

#[test]
fn whoever_asks_for_one_picture_does_not_wait_for_a_stream_to_end() {
    let service = support::service();
    let server = TestServer::start(&service);
    let mut many = server.connect();
    let frames = vec![json!({}); 2000];
    let batch = json!({"rig": "figure", "size": [256, 256], "transport": "attach", "stream": true, "frames": frames});
    many.request("many", "frame.batch", batch);
    // It is read all the time.
    let reading = std::thread::spawn(move || streamed(&mut many, "frame.ready", "frame").0.len());
    let mut one = server.connect();
    for id in 0..10 {
        one.request(id, "frame.render", support::server::picture(16));
        one.result(id);
    }
    assert!(drawn(&service) < 1500, "they were answered at its end");
    assert_eq!(reading.join().expect("it is read"), 2000);
}

#[test]
fn what_is_heavy_beside_others_does_not_let_all_of_them_go_first() {
    let service = support::service();
    // Each vertex follows enough joints for its skin to be worth sharing out among the cores.
    let (joints, vertices) = (64, 40_000);
    let mut skeleton = String::new();
    for _ in 0..joints {
        skeleton += "balljoint b { offset 0 0.1 0 ";
    }
    skeleton += &"}".repeat(joints);
    let list = |item: &dyn Fn(usize) -> String| (0..vertices).map(item).collect::<String>();
    let all_joints: String = (0..joints).map(|joint| format!("{joint} 1 ")).collect();
    let bindings: String = (0..joints)
        .map(|joint| {
            format!(
                "matrix {{ 1 0 0 0 1 0 0 0 1 0 {} 0 }} ",
                joint as f64 / 10.0
            )
        })
        .collect();
    let skin = format!(
        "positions {vertices} {{ {} }} normals {vertices} {{ {} }} skinweights {vertices} {{ {} }} triangles 1 {{ 0 1 2 }} \
         bindings {joints} {{ {bindings} }}",
        list(&|vertex| format!("{} {} 0 ", vertex % 7, vertex % 11)),
        list(&|_| "0 0 1 ".to_owned()),
        list(&|_| format!("{joints} {all_joints}")),
    );
    let files =
        json!([{"name": "heavy.skel", "text": skeleton}, {"name": "heavy.skin", "text": skin}]);
    ask_ok(&service, "rig.load", json!({"files": files}));
    let server = TestServer::start(&service);
    let mut clients: Vec<Wire> = (0..15).map(|_| server.connect()).collect();
    for (client, wire) in clients.iter_mut().enumerate() {
        for id in 0..32 {
            let pose = json!({"dofs": {"b.rz": (32 * client + id) as f64 / 1000.0}});
            let picture = json!({"rig": "heavy", "size": [8, 8], "pose": pose, "transport": "attach", "image": "rgba8"});
            wire.request(id, "frame.render", picture);
        }
    }
    let mut when_the_first_was_there = None;
    for wire in &mut clients {
        for id in 0..32 {
            assert_eq!(wire.result(id)["width"], 8);
            wire.bytes(4 * 8 * 8);
            when_the_first_was_there.get_or_insert_with(|| drawn(&service));
        }
    }
    assert!(
        when_the_first_was_there < Some(240),
        "each gave way to the next: {when_the_first_was_there:?}"
    );
}

#[test]
fn a_connection_is_heard_while_the_items_of_its_batch_are_being_checked() {
    let service = support::service();
    load_bone(&service);
    let before = drawn(&service);
    let server = TestServer::start(&service);
    let mut wire = server.connect();
    // Held against limits, a pose takes many times as long to check as to read. The last one is wrong, so that none is drawn.
    let pose = |index: usize| {
        let clip = json!({"name": "walk", "time": index as f64 * 1e-4});
        json!({"pose": {"clip": clip, "limits": "reject"}})
    };
    let mut frames: Vec<Value> = (0..65_535).map(pose).collect();
    frames.push(json!({"size": [0, 0]}));
    wire.request(
        "many",
        "frame.batch",
        json!({"rig": "figure", "frames": frames}),
    );
    let turn = json!({"rig": "bone", "pose": {"dofs": {"bone.rx": 0.5}}});
    let notify = |method: &str, params: Value| {
        let notification = json!({"jsonrpc": "2.0", "method": method, "params": params});
        format!("{notification}\n")
    };
    wire.send(notify("pose.set", turn));
    let until = Instant::now() + PATIENCE;
    while ask_ok(&service, "pose.get", json!({"rig": "bone"}))["dofs"]["bone.rx"] != 0.5 {
        assert!(Instant::now() < until, "it is not heard");
        std::thread::sleep(Duration::from_millis(1));
    }
    let requests = ask_ok(&service, "server.stats", json!({}))["requests"].take();
    assert_eq!(
        requests["frame.batch"],
        Value::Null,
        "it is answered already"
    );
    wire.send(notify("request.cancel", json!({"request": "many"})));
    assert_eq!(wire.error("many")["kind"], "cancelled");
    wire.assert_alive();
    assert_idle(&service);
    assert_eq!(drawn(&service), before);
}
