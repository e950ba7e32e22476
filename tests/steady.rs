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

fn draw(service: &Arc<Service>, count: usize) {
    std::thread::scope(|scope| {
        for thread in 0..AT_A_TIME {
            scope.spawn(move || {
                for index in (thread..count).step_by(AT_A_TIME) {
                    let pose = json!({"dofs": {"spine.ry": (index as f64 * 0.1).sin() * 0.4}});
                    let samples = if index % 4 == 0 { 4 } else { 1 };
                    let params = json!({"rig": "figure", "size": [64, 64], "samples": samples, "pose": pose});
                    let frame = support::ask_ok(service, "frame.render", params);
                    assert_eq!(frame["width"], 64);
                }
            });
        }
    });
}

fn gpu_bytes(service: &Arc<Service>) -> Value {
    support::ask_ok(service, "server.stats", json!({}))["memory"]["gpu_bytes"].take()
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
    assert_eq!(gpu_bytes(&service), on_device);
    assert!(after <= before + TOLERANCE, "{} bytes more", after - before);
}
