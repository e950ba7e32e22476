//! A service in this process, for subcommands that need no daemon.

use super::terminal::Warnings;
use super::{RendererArgs, builtin};
use crate::engine::{AdapterChoice, Engine, LoadedRig, RendererChoice};
use crate::formats::Source;
use crate::limits::Limits;
use crate::protocol::{Id, Outgoing, Reply};
use crate::service::{Conversation, Message, Pending, Service};
use anyhow::Context;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Instant;

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

/// Asks a service of this process; raw bytes that come with the reply are given beside it.
pub(super) fn ask<P: Serialize, R: DeserializeOwned>(
    service: &Arc<Service>,
    method: &str,
    params: &P,
) -> anyhow::Result<(R, Vec<u8>)> {
    read(begin(&mut service.converse(), method, params)?)
}

/// Asks without waiting; several requests of one conversation may be on their way.
pub(super) fn begin<P: Serialize>(
    conversation: &mut Conversation,
    method: &str,
    params: &P,
) -> anyhow::Result<Pending> {
    let request = Outgoing {
        id: Some(&Id::Null),
        method,
        params,
        deadline_ms: None,
        attach_bytes: 0,
    };
    let message = Message::read(&request.line()?, Instant::now());
    conversation
        .begin(message, Vec::new())
        .context("a request with an id is answered")
}

/// Waits for what was asked.
pub(super) fn read<R: DeserializeOwned>(pending: Pending) -> anyhow::Result<(R, Vec<u8>)> {
    let mut reply = pending.wait();
    let result = Reply::parse(&reply.line)?.outcome?;
    let attached = match reply.attachments.as_mut_slice() {
        // The usual case, without a copy.
        [only] => std::mem::take(only).into_bytes(),
        parts => parts
            .iter()
            .flat_map(|part| part.bytes())
            .copied()
            .collect(),
    };
    Ok((serde_json::from_str(result.get())?, attached))
}
