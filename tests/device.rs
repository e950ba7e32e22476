//! Does the graphics device do what only it can: take memory, and go away? Where there is no Vulkan adapter, these tests say so and pass.

mod support;

use serde_json::json;
use support::{ask, ask_ok};

#[test]
fn a_lost_device_is_opened_again() {
    let Some(service) = support::service_on("vulkan") else {
        return;
    };
    let draw = || {
        ask(
            &service,
            "frame.render",
            json!({"rig": "figure", "size": [16, 16]}),
        )
    };
    let wanted = draw().expect("a picture")["images"]["color"]["data"].take();
    let mut lost = 0;
    for _ in 0..3 {
        service.engine().lose_device();
        // The next request may be the one that finds out.
        if let Err(error) = draw() {
            assert_eq!(
                (error.code, error.data.kind.as_str()),
                (-32006, "device_lost")
            );
            assert!(error.data.retryable);
            lost += 1;
        }
        let again = draw().expect("the device is there again");
        assert!(
            again["images"]["color"]["data"] == wanted,
            "another picture than before"
        );
        ask_ok(&service, "mesh.vertices", json!({"rig": "figure"}));
    }
    println!("{lost} of 3 losses were noticed by a request");
}

#[test]
fn memory_of_the_device_is_told() {
    let Some(service) = support::service_on("vulkan") else {
        return;
    };
    ask_ok(&service, "frame.render", json!({"rig": "figure"}));
    let stats = ask_ok(&service, "server.stats", json!({}));
    let held = stats["memory"]["gpu_bytes"].as_u64().expect("a number");
    assert!(held > 0);
}
