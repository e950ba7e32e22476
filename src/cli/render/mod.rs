//! `rigd render`: a picture or a sequence of them, drawn by this process.
//! Never lives here: anything that a frame request cannot ask for.

mod args;
mod flags;
mod format;
mod framing;
mod output;
mod request;
mod shots;
mod typed;
mod view;

pub(super) use args::RenderArgs;

use super::exit::{Outcome, Stopped};
use super::files::Destination;
use super::local;
use super::terminal::{Warnings, print, printable};
use crate::encode::AnimatedGif;
use crate::engine::RigRef;
use crate::formats::Source;
use crate::limits::Limits;
use crate::scene::{Size, SizeError};
use crate::service::{Service, compression, description};
use anyhow::{anyhow, bail};
use format::Format;
use indicatif::{ProgressBar, ProgressStyle};
use output::{Reel, Terms};
use shots::{Motion, Shots};
use signal_hook::consts::{SIGINT, SIGTERM};
use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use typed::Clamps;

/// Frames that are drawn or wait for it while one is written: two keep the renderer busy, and three of the largest come to some 200 MB.
const IN_FLIGHT: usize = 3;

pub(super) fn run(args: &RenderArgs) -> anyhow::Result<Outcome> {
    let output = Destination::of(&args.output.output)?;
    let format = Format::of(&output)?;
    let [width, height] = args.output.size.0;
    let size = Size::new(width, height, &Limits::default()).map_err(|error| match error {
        SizeError::Value(error) => anyhow!("--size: {error}"),
        SizeError::Limit(error) => anyhow!("--size: {error}"),
    })?;
    let (motion, rate) = (args.motion(format)?, args.rate()?);
    if format == Format::Gif {
        AnimatedGif::<Vec<u8>>::accept(rate)?;
    }
    if output == Destination::StandardOutput && motion != Motion::Still {
        bail!("--output: a sequence needs a file that ends in .png, .gif or .apng, but found `-`");
    }
    let mut request = args.request("")?;
    let compression = compression(request.compression);

    let mut warnings = Warnings::default();
    let engine = args.renderer.open()?;
    request.rig = local::load(&engine, &args.files, &mut warnings)?
        .name
        .to_string();
    let service = Service::new(engine, Source::inline_only());
    let loaded = service.engine().rig(&request.rig)?;
    let rig = description(&loaded);
    args.check_numbers(&rig, &mut warnings)?;
    let clamps = Clamps::new(args, &rig);
    let draw = || {
        let shots = Shots::new(args, motion, rate, request, &rig, &service, &loaded)?;
        let terms = Terms {
            output,
            format,
            rate,
            compression,
            motion,
            frames: shots.count(),
        };
        let reel = Reel::new(terms, size);
        draw(&service, &loaded, &shots, reel, clamps, &mut warnings)
    };
    let written = draw().map_err(|error| flags::naming_the_option(error, args, &rig))?;
    if let Some(written) = written {
        print(&printable(&written))?;
    }
    Ok(Outcome::of(&warnings, args.strict))
}

/// Draws all frames, a few at a time, and writes them in order as they come.
fn draw(
    service: &Arc<Service>,
    loaded: &RigRef,
    shots: &Shots,
    mut reel: Reel,
    mut clamps: Clamps,
    warnings: &mut Warnings,
) -> anyhow::Result<Option<String>> {
    let mut to_draw = 0..shots.count();
    let mut begun = VecDeque::with_capacity(IN_FLIGHT);
    let progress = progress(shots.count());
    let stopped_by = Arc::new(AtomicUsize::new(0));
    for signal in [SIGINT, SIGTERM] {
        signal_hook::flag::register_usize(signal, Arc::clone(&stopped_by), signal as usize)?;
    }
    loop {
        // Here and not wherever it comes: what is half written is then cleared away.
        match stopped_by.load(Ordering::Relaxed) as i32 {
            0 => {}
            signal => return Err(Stopped { signal }.into()),
        }
        while begun.len() < IN_FLIGHT
            && let Some(index) = to_draw.next()
        {
            let mut subject = service.subject(&shots.request(index), loaded)?;
            let clamped = std::mem::take(&mut subject.clamped);
            let pack = reel.packing();
            let packed = move |frame, _| pack(frame);
            let drawing = local::draw(service.engine(), loaded, subject, packed)?;
            begun.push_back((clamped, drawing));
        }
        let Some((clamped, drawing)) = begun.pop_front() else {
            break;
        };
        let picture = drawing.wait()?;
        progress.suspend(|| clamps.tell(&clamped, warnings));
        reel.push(picture)?;
        progress.inc(1);
    }
    progress.finish_and_clear();
    reel.finish()
}

/// On standard error, and only where that is a terminal.
fn progress(frames: u32) -> ProgressBar {
    if frames == 1 {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(frames.into());
    let style = ProgressStyle::with_template("{bar:40} {pos} of {len} frames, {eta} left");
    match style {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
