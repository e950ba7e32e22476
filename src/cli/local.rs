//! An engine in this process, for subcommands that need no daemon. Never lives here: what is drawn.

use super::terminal::Warnings;
use super::{RendererArgs, builtin};
use crate::adapter::AdapterChoice;
use crate::engine::{Cancellation, Engine, JobContext, LoadedRig, RendererChoice, RigRef, Timings};
use crate::formats::Source;
use crate::frame::{ImageKind, Raster};
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

/// Begins to draw. What `then` makes of the color picture, on a thread of the engine's pool, is received once.
pub(super) fn draw<T: Send + 'static>(
    engine: &Engine,
    rig: &RigRef,
    subject: Subject,
    then: impl FnOnce(Raster, Timings) -> Result<T, Fault> + Send + 'static,
) -> Result<Drawing<T>, Fault> {
    let context = job_context(engine)?;
    let (sender, receiver) = mpsc::sync_channel(1);
    engine.render(subject.query(&rig.loaded), context, move |drawn| {
        let made = drawn.map_err(Fault::from).and_then(|(outputs, timings)| {
            let mut images = outputs.images.into_iter();
            let color = images.find(|raster| raster.kind == ImageKind::Color);
            let message = "the renderer drew no color picture".to_owned();
            then(color.ok_or(Fault::Internal { message })?, timings)
        });
        // Nobody receives it where an earlier picture failed.
        let _ = sender.send(made);
    });
    Ok(Drawing(receiver))
}

/// Something of the engine's that is still on its way.
pub(super) struct Drawing<T>(pub Receiver<Result<T, Fault>>);

impl<T> Drawing<T> {
    pub(super) fn wait(self) -> Result<T, Fault> {
        self.0.recv().unwrap_or_else(|_| {
            let message = "the renderer failed at this picture".to_owned();
            Err(Fault::Internal { message })
        })
    }
}

/// That of work that nobody cancels.
pub(super) fn job_context(engine: &Engine) -> Result<JobContext, Fault> {
    Ok(JobContext {
        cancellation: Cancellation::default(),
        ticket: engine.admission().admit()?,
    })
}
