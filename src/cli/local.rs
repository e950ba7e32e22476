//! A service in this process, for subcommands that need no daemon.

use super::{RendererArgs, builtin, printable};
use crate::engine::{Engine, LoadedRig, RendererChoice};
use crate::formats::Source;
use crate::limits::Limits;
use crate::protocol::{Id, Outgoing, Reply};
use crate::service::Service;
use anyhow::Context;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::sync::Arc;

impl RendererArgs {
    pub(super) fn open(&self) -> anyhow::Result<Engine> {
        let adapter = match self.adapter.parse() {
            Ok(adapter) => adapter,
            Err(never) => match never {},
        };
        let choice = RendererChoice {
            adapter,
            require_gpu: self.require_gpu,
        };
        Ok(Engine::open(choice, Limits::default())?)
    }
}

/// Loads what the user named, or the default, from wherever it lies.
pub(super) fn load(engine: &Engine, files: &[String]) -> anyhow::Result<Arc<LoadedRig>> {
    let files = builtin::files_or_default(files);
    let loaded = engine.load(None, &files, &Source::local(), false)?;
    for warning in loaded.warnings() {
        eprintln!("warning: {}", printable(warning));
    }
    Ok(loaded)
}

/// Asks a service of this process; raw bytes that come with the reply are given beside it.
pub(super) fn ask<P: Serialize, R: DeserializeOwned>(
    service: &Arc<Service>,
    method: &str,
    params: &P,
) -> anyhow::Result<(R, Vec<u8>)> {
    let request = Outgoing {
        id: Some(&Id::Null),
        method,
        params,
        deadline_ms: None,
        attach_bytes: 0,
    };
    let reply = service.answer(&request.line()?, Vec::new());
    let reply = reply.context("a request with an id is answered")?;
    let result = Reply::parse(&reply.line)?.outcome?;
    Ok((
        serde_json::from_str(result.get())?,
        reply.attachments.concat(),
    ))
}
