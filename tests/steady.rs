//! Does the thousandth picture cost as much memory as the hundredth?

mod support;

use rigd::service::Service;
use serde_json::{Value, json};
use std::sync::Arc;

/// Pictures after which everything that is kept for reuse has been made.
const WARM: usize = 200;
const ALL: usize = 2_000;
/// As many as it takes to keep the device, the pool and the queue at work at once.
const AT_A_TIME: usize = 4;

/// What resident memory may grow by from picture 200 to picture 2,000. Where nothing leaks it is less than 1 MB, which is what allocators
/// keep more or less of from one moment to the next. One picture kept of each, 16 KB as bare pixels, would come to 29 MB.
const TOLERANCE: usize = 4 << 20;

/// Every way of skinning and every view of the skeleton comes again and again, in a pose that never does.
fn request(index: usize) -> Value {
    let turn = (index as f64 * 0.1).sin();
    let dofs = json!({"spine.ry": 0.4 * turn, "morph.smile": turn});
    let pose = json!({"clip": {"name": "walk", "time": index as f64 * 0.01}, "dofs": dofs});
    let views = ["none", "wireframe", "boxes", "sticks", "cylinders"];
    let show = json!({"skeleton": views[index % 5], "skin_opacity": if index.is_multiple_of(3) { 0.5 } else { 1.0 }});
    json!({
        "rig": "figure", "size": [64, 64], "pose": pose, "show": show,
        "samples": if index.is_multiple_of(4) { 4 } else { 1 },
        "skinning": if index.is_multiple_of(2) { "linear" } else { "dual_quaternion" },
    })
}

fn draw(service: &Arc<Service>, count: usize) {
    std::thread::scope(|scope| {
        for thread in 0..AT_A_TIME {
            scope.spawn(move || {
                for index in (thread..count).step_by(AT_A_TIME) {
                    let params = request(index);
                    let frame = support::ask_ok(service, "frame.render", params);
                    assert_eq!(frame["width"], 64);
                }
            });
        }
    });
}

fn gpu_bytes(service: &Arc<Service>) -> u64 {
    let stats = support::ask_ok(service, "server.stats", json!({}));
    stats["memory"]["gpu_bytes"].as_u64().expect("a number")
}

fn resident() -> usize {
    memory_stats::memory_stats().map_or(0, |memory| memory.physical_mem)
}

#[test]
fn memory_does_not_grow_with_the_number_of_pictures() {
    let service = support::service();
    draw(&service, WARM);
    let (before, on_device) = (resident(), gpu_bytes(&service));
    draw(&service, ALL - WARM);
    let after = resident();
    println!("{before} bytes after {WARM} pictures, {after} after {ALL}");
    // How many requests happen to share a submission decides how large its buffers have to be.
    let on_device_after = gpu_bytes(&service);
    assert!(
        on_device_after <= on_device + TOLERANCE as u64,
        "{on_device_after} bytes on the device, {on_device} before"
    );
    assert!(after <= before + TOLERANCE, "{} bytes more", after - before);
}
