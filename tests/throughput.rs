//! How many frames and vertices a second does the service give? The log tells; no figure is demanded, for that is a fact about the machine.

mod support;

use rigd::service::Service;
use serde_json::{Value, json};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};
use support::pictures::{ask_attached, over};
use support::suite::{load_reed, load_samples};
use support::{adapters, ask_ok, note, service_on};

const IN_FLIGHT: u64 = 8;

/// How long each rate is measured, and pictures of how many pixels a side. Without `RIGD_MEASURE_SECONDS` just enough to see that it works.
fn effort() -> (Duration, u32) {
    let seconds = std::env::var("RIGD_MEASURE_SECONDS").ok();
    let seconds = seconds.map(|it| it.parse().expect("RIGD_MEASURE_SECONDS: seconds"));
    seconds.map_or((Duration::ZERO, 32), |seconds| {
        (Duration::from_secs_f64(seconds), 512)
    })
}

/// Requests a second, each in a pose of its own: the same pose is skinned once.
fn rate(
    service: &Arc<Service>,
    method: &str,
    request: &Value,
    dof: &str,
    duration: Duration,
) -> f64 {
    let next = AtomicU64::new(0);
    let asked = || {
        let index = next.fetch_add(1, Ordering::Relaxed);
        let value = 1e-4 * (index % 1000) as f64;
        let pose = json!({"pose": {"base": "rest", "dofs": {dof: value}}});
        ask_attached(service, method, &over(request.clone(), pose));
    };
    // The first one uploads what the others find.
    asked();
    let start = Instant::now();
    std::thread::scope(|scope| {
        for _ in 0..IN_FLIGHT {
            scope.spawn(|| {
                asked();
                while start.elapsed() < duration {
                    asked();
                }
            });
        }
    });
    let answered = next.into_inner() - 1;
    answered as f64 / start.elapsed().as_secs_f64()
}

#[test]
fn frames_and_vertices_come_at_some_rate() {
    let Some(service) = service_on(&adapters::adapter()) else {
        return;
    };
    load_reed(&service);
    load_samples(&service);
    let (duration, side) = effort();
    for rig in ["figure", "drake", "bear", "reed"] {
        let described = ask_ok(&service, "rig.describe", json!({ "rig": rig }));
        let dof = described["dofs"][0]["name"].as_str().expect("a name");
        let vertices = described["vertex_count"].as_f64().expect("a number");
        let frame =
            json!({"rig": rig, "size": [side, side], "image": "rgba8", "transport": "attach"});
        let frames = rate(&service, "frame.render", &frame, dof, duration);
        let query =
            json!({"rig": rig, "attributes": ["positions", "normals"], "transport": "attach"});
        let queries = rate(&service, "mesh.vertices", &query, dof, duration);
        note(&format!(
            "{rig}: {frames:.1} frames/s of {side}x{side}, {:.3e} vertices/s, {vertices} at a time",
            queries * vertices
        ));
        assert!(frames > 0.0 && queries > 0.0);
    }
}
