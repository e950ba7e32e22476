//! A service in this process, for subcommands that need no daemon.

use super::terminal::Warnings;
use super::{RendererArgs, builtin};
use crate::engine::{AdapterChoice, Engine, LoadedRig, RendererChoice};
use crate::formats::Source;
use crate::limits::Limits;
use crate::protocol::{ErrorObject, Id};
use crate::service::{Request, ResponseHandle, Service, Session};
use anyhow::Context;
use bytes::Bytes;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::value::to_raw_value;
use std::num::NonZeroUsize;
use std::sync::Arc;

impl RendererArgs {
    pub(super) fn threads(&self) -> Option<NonZeroUsize> {
        self.threads
            .and_then(|threads| NonZeroUsize::new(threads.into()))
    }

    /// Whether the machine's graphics libraries may be asked what there is.
    pub(super) fn may_ask_for_gpus(&self) -> bool {
        self.choice().adapter != AdapterChoice::Cpu
    }

    pub(super) fn open(&self) -> anyhow::Result<Engine> {
        Ok(Engine::open(self.choice(), Limits::default())?)
    }

    fn choice(&self) -> RendererChoice {
        let adapter = match self.adapter.parse() {
            Ok(adapter) => adapter,
            Err(never) => match never {},
        };
        RendererChoice {
            adapter,
            require_gpu: self.require_gpu,
            threads: self.threads(),
        }
    }
}

/// Loads what the user named, or the default, from wherever it lies.
pub(super) fn load(
    engine: &Engine,
    files: &[String],
    warnings: &mut Warnings,
) -> anyhow::Result<Arc<LoadedRig>> {
    let files = builtin::files_or_default(files);
    let loaded = engine.load(None, &files, &Source::local(), false)?;
    for warning in loaded.warnings() {
        warnings.tell(warning);
    }
    Ok(loaded)
}

/// Asks a service of this process; raw bytes that come with the response are given beside it.
pub(super) fn ask<P: Serialize, R: DeserializeOwned>(
    service: &Arc<Service>,
    method: &str,
    params: &P,
) -> anyhow::Result<(R, Bytes)> {
    read(begin(&mut service.session(), method, params)?)
}

/// Asks without waiting; several requests of one session may be on their way.
pub(super) fn begin<P: Serialize>(
    session: &mut Session,
    method: &str,
    params: &P,
) -> anyhow::Result<ResponseHandle> {
    let response = session.begin(Request {
        id: Some(Id::Null),
        method: method.to_owned(),
        params: Some(to_raw_value(params)?),
        deadline: None,
        attached: Bytes::new(),
    });
    response.context("a request with an id is answered")
}

/// Waits for what was asked.
pub(super) fn read<R: DeserializeOwned>(handle: ResponseHandle) -> anyhow::Result<(R, Bytes)> {
    let mut response = handle.wait();
    let result = response.outcome.map_err(ErrorObject::from)?;
    let attached = match response.attachments.as_mut_slice() {
        // The usual case, without a copy.
        [only] => std::mem::take(only),
        parts => parts.concat().into(),
    };
    Ok((serde_json::from_str(&result)?, attached))
}
