//! An engine in this process, for subcommands that need no daemon. Never lives here: what is drawn.

use super::terminal::Warnings;
use super::{RendererArgs, builtin};
use crate::engine::{
    AdapterChoice, Engine, LoadedRig, RendererChoice, RigRef, Terms, Timings, Urgency,
};
use crate::formats::Source;
use crate::frame::Frame;
use crate::limits::Limits;
use crate::protocol::Fault;
use crate::service::Subject;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver};

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

/// Begins to draw. What `then` makes of the picture, on a thread of the engine's pool, is received once.
pub(super) fn draw<T: Send + 'static>(
    engine: &Engine,
    rig: &RigRef,
    subject: Subject,
    then: impl FnOnce(Frame, Timings) -> Result<T, Fault> + Send + 'static,
) -> Result<Drawing<T>, Fault> {
    let Subject {
        scene,
        posed,
        skinning,
        ..
    } = subject;
    let terms = terms(engine)?;
    let (sender, receiver) = mpsc::sync_channel(1);
    engine.render(&rig.loaded, posed, skinning, scene, terms, move |drawn| {
        let drawn = drawn.map_err(Fault::from);
        let made = drawn.and_then(|(frame, timings)| then(frame, timings));
        // Nobody receives it where an earlier picture failed.
        let _ = sender.send(made);
    });
    Ok(Drawing(receiver))
}

/// Something of the engine's that is still on its way.
pub(super) struct Drawing<T>(pub Receiver<Result<T, Fault>>);

impl<T> Drawing<T> {
    pub fn wait(self) -> Result<T, Fault> {
        self.0.recv().unwrap_or_else(|_| {
            let message = "the renderer failed at this picture".to_owned();
            Err(Fault::Internal { message })
        })
    }
}

/// Those of work that nobody cancels.
pub(super) fn terms(engine: &Engine) -> Result<Terms, Fault> {
    Ok(Terms {
        urgency: Urgency::default(),
        ticket: engine.admission().admit()?,
    })
}
