//! Which renderers tests draw with, and what follows where one is missing. Never lives here: what they draw.

use super::note;
use rigd::adapter::AdapterError;
use rigd::engine::{Engine, EngineError, RendererChoice};
use rigd::limits::Limits;
use rigd::render::gpu::Gpu;

/// What tests draw with: rigd's own renderer, so that every machine sees the same pictures, or `RIGD_TEST_ADAPTER`.
pub fn adapter() -> String {
    std::env::var("RIGD_TEST_ADAPTER").unwrap_or_else(|_| "cpu".to_owned())
}

/// What rigd's own renderer is compared with: `RIGD_TEST_ADAPTER`, or Mesa's software driver.
pub fn wgpu_adapter() -> String {
    let asked = Some(adapter()).filter(|asked| asked != "cpu");
    asked.unwrap_or_else(|| "llvmpipe".to_owned())
}

/// An engine that draws with this adapter; `None`, and a line in the log, where there is no such adapter.
pub fn engine_on(adapter: &str, limits: Limits) -> Option<Engine> {
    let Ok(parsed) = adapter.parse();
    let choice = RendererChoice {
        adapter: parsed,
        ..RendererChoice::default()
    };
    let opened = Engine::open(choice, limits).map_err(|error| match error {
        EngineError::Adapter(error) => error,
        other => panic!("{adapter}: {other}"),
    });
    let engine = unless_missing(adapter, opened)?;
    note(&format!("drawing with {}", engine.adapter()));
    Some(engine)
}

/// wgpu's renderer by itself on this adapter; `None`, and a line in the log, where there is no such adapter.
pub fn gpu_on(adapter: &str) -> Option<Gpu> {
    let Ok(choice) = adapter.parse();
    unless_missing(adapter, Gpu::open(&choice, false))
}

/// # Panics
/// Where an adapter is there and does not open, and where none is while `RIGD_REQUIRE_ADAPTER=1` asks for one.
fn unless_missing<T>(adapter: &str, opened: Result<T, AdapterError>) -> Option<T> {
    let error = match opened {
        Ok(opened) => return Some(opened),
        Err(error) => error,
    };
    let is_missing = matches!(error, AdapterError::NoMatch { .. } | AdapterError::None);
    let is_required = std::env::var("RIGD_REQUIRE_ADAPTER").is_ok_and(|value| value == "1");
    assert!(is_missing && !is_required, "{adapter}: {error}");
    note(&format!(
        "SKIPPED: there is no adapter `{adapter}`; `make setup` installs what is missing"
    ));
    None
}
