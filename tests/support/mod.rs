//! What several tests need: a service to ask, a server to connect to, an oracle to compare with. Each test file asks one question.

// Every test file is a crate of its own and uses a part of this.
#![allow(dead_code, reason = "each test uses a part")]

pub mod adapters;
pub mod alike;
pub mod everything;
pub mod gltf;
pub mod oracle;
pub mod pictures;
pub mod places;
pub mod quads;
pub mod random;
pub mod rules;
pub mod server;
pub mod shot;
pub mod suite;

use adapters::{adapter, engine_on};

use bytes::Bytes;
use rigd::engine::Engine;
use rigd::formats::Source;
use rigd::limits::Limits;
use rigd::protocol::{self, ErrorObject};
use rigd::service::{Request, Response, Service};
use serde_json::{Value, json};
use std::io::Write;
use std::path::PathBuf;
use std::sync::{Arc, LazyLock};
use std::time::{Duration, Instant};

/// A service that draws with this adapter, the built-in figure loaded as `figure`; `None`, and a line in the log, where there is no such
/// adapter.
pub fn service_on(adapter: &str) -> Option<Arc<Service>> {
    let engine = engine_on(adapter, Limits::default())?;
    Some(with_figure(engine, Source::inline_only()))
}

/// How long this thread has been on a processor, where the system tells: what else the machine has to do does not count.
pub fn time_at_work() -> Duration {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|told| told.split(' ').next()?.parse().ok());
    nanoseconds.map_or_else(|| START.elapsed(), Duration::from_nanos)
}

/// A line in the test's log also where the test passes: what `println!` prints is then thrown away.
pub fn note(line: &str) {
    // A log that is closed misses nothing.
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// A renderer of its own, named in the test's log.
pub fn engine(limits: Limits) -> Engine {
    engine_on(&adapter(), limits).expect("the adapter that tests draw with")
}

fn with_figure(engine: Engine, source: Source) -> Arc<Service> {
    engine
        .load(None, &rigd::cli::figure(), &Source::inline_only(), false)
        .expect("the built-in figure loads");
    Service::new(engine, source)
}

/// A service with the built-in figure loaded as `figure`.
pub fn service() -> Arc<Service> {
    service_with(Limits::default(), Source::inline_only())
}

pub fn service_with(limits: Limits, source: Source) -> Arc<Service> {
    with_figure(engine(limits), source)
}

/// The first three channels of the course's `sample.anim` at moments before, between and after its keys, in seconds, by an
/// independent program.
pub const SAMPLE_ANIM: [(f64, [f64; 3]); 7] = [
    (-0.7, [0.1, -0.025, 0.648]),
    (-0.25, [0.1, -0.083594, 0.5]),
    (0.25, [-0.15, 0.374219, 0.5]),
    (0.6, [-0.1592, 0.3, 0.896]),
    (0.9, [-0.173236, 0.34375, 0.104]),
    (1.3, [0.356, 0.76875, 0.0]),
    (2.5, [0.092, 1.16875, 0.0]),
];

/// Where real rigs lie, which the project may not ship. `None`, and a line in the log, where they are absent.
pub fn real_rigs() -> Option<PathBuf> {
    let folder = places::repository("../shared/rigs");
    if !folder.is_dir() {
        note(&format!("SKIPPED: no real rigs in {}", folder.display()));
        return None;
    }
    Some(folder)
}

/// What comes of a request's text; `None` for a notification.
pub fn answer(service: &Arc<Service>, text: &str) -> Option<Response> {
    match protocol::Request::parse(text.as_bytes()) {
        Ok(request) => {
            let due = |ms| Instant::now().checked_add(Duration::from_millis(ms));
            service.answer(Request {
                id: request.id,
                method: request.method,
                params: request.params,
                deadline: request.deadline_ms.and_then(due),
                attached: Bytes::new(),
            })
        }
        Err(bad) => Some(service.session().refuse(bad.id, bad.fault).wait()),
    }
}

/// The same as JSON-RPC has it, and what is attached to it.
pub fn reply(response: Response) -> (Value, Vec<u8>) {
    let mut reply = json!({"jsonrpc": "2.0", "id": response.id});
    match response.outcome {
        Ok(result) => reply["result"] = serde_json::from_str(&result).expect("JSON"),
        Err(fault) => reply["error"] = json!(ErrorObject::from(fault)),
    }
    let attached = response.attachments.concat();
    if !attached.is_empty() {
        reply["attach_bytes"] = json!(attached.len());
    }
    (reply, attached)
}

/// A request's result and what is attached to it, or its error.
pub fn ask_attached(
    service: &Arc<Service>,
    method: &str,
    params: &Value,
) -> Result<(Value, Vec<u8>), ErrorObject> {
    let request = json!({"jsonrpc": "2.0", "id": 1, "method": method, "params": params});
    let response = answer(service, &request.to_string()).expect("a request is answered");
    let result = serde_json::from_str(&response.outcome?).expect("JSON");
    Ok((result, response.attachments.concat()))
}

/// A request's result, or its error; whatever was attached is dropped.
pub fn ask(service: &Arc<Service>, method: &str, params: Value) -> Result<Value, ErrorObject> {
    ask_attached(service, method, &params).map(|(result, _)| result)
}

/// As [`ask`], for what is meant to succeed.
pub fn ask_ok(service: &Arc<Service>, method: &str, params: Value) -> Value {
    ask(service, method, params).unwrap_or_else(|error| panic!("{method}: {error}"))
}

/// The `kind` of the error of what is meant to fail.
pub fn ask_kind(service: &Arc<Service>, method: &str, params: Value) -> String {
    match ask(service, method, params) {
        Ok(result) => panic!("{method} succeeded with {result}"),
        Err(error) => error.data.kind,
    }
}

/// A file of any bytes, as a request carries it.
pub fn with_base64(name: &str, bytes: &[u8]) -> Value {
    json!({"name": name, "base64": rigd::protocol::attach::Base64(bytes.to_vec())})
}

/// Where a file or folder of `tests/cases` is.
pub fn case_path(path: &str) -> PathBuf {
    places::repository("tests/cases").join(path)
}

pub fn case_bytes(path: &str) -> Vec<u8> {
    std::fs::read(case_path(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// A file of `tests/cases`, e.g. `gltf/lights_required.gltf`, as a request carries it.
pub fn case(path: &str) -> Value {
    let bytes = case_bytes(path);
    let name = path.rsplit('/').next().expect("a name");
    with_base64(name, &bytes)
}
