//! `rigd render`: a picture or a sequence of them, drawn by this process.
//! Never lives here: anything that is not asked of the service by a request.

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
use crate::encode::{AnimatedGif, Compression};
use crate::formats::Source;
use crate::limits::Limits;
use crate::protocol::frame as wire;
use crate::protocol::rig::{RigDescription, RigParams};
use crate::scene::{Size, SizeError};
use crate::service::Service;
use anyhow::{Context, anyhow, bail};
use format::Format;
use indicatif::{ProgressBar, ProgressStyle};
use output::{Reel, Terms};
use shots::{Motion, Shots};
use signal_hook::consts::{SIGINT, SIGTERM};
use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use typed::Clamps;

/// Frames that are drawn or wait for it while one is written: two keep the renderer busy, and three of the largest stay within what one
/// client may have in flight.
const IN_FLIGHT: usize = 3;

pub(super) fn run(args: &RenderArgs) -> anyhow::Result<Outcome> {
    let output = Destination::of(&args.output.output)?;
    let format = Format::of(&output)?;
    let [width, height] = args.output.size.0;
    let size = Size::new(width, height, &Limits::default()).map_err(|error| match error {
        SizeError::Scene(error) => anyhow!("--size: expected {error}"),
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
    request.image = format.image();
    let compression = of_compression(request.compression);

    let mut warnings = Warnings::default();
    let engine = args.renderer.open()?;
    request.rig = local::load(&engine, &args.files, &mut warnings)?
        .name
        .clone();
    let service = Service::new(engine, Source::inline_only());
    let params = RigParams {
        rig: request.rig.clone(),
    };
    let (rig, _) = local::ask::<_, RigDescription>(&service, "rig.describe", &params)?;
    args.check_numbers(&rig, &mut warnings)?;
    let clamps = Clamps::new(args, &rig);
    let draw = || {
        let shots = Shots::new(args, motion, rate, request, &rig, &service)?;
        let terms = Terms {
            output,
            format,
            rate,
            compression,
            motion,
            frames: shots.count(),
        };
        draw(
            &service,
            &shots,
            Reel::new(terms, size),
            clamps,
            &mut warnings,
        )
    };
    let written = draw().map_err(|error| flags::told_by_option(error, args, &rig))?;
    if let Some(written) = written {
        print(&printable(&written))?;
    }
    Ok(Outcome::of(&warnings, args.strict))
}

/// Asks for all frames, a few at a time, and writes them in order as they come.
fn draw(
    service: &Arc<Service>,
    shots: &Shots,
    mut reel: Reel,
    mut clamps: Clamps,
    warnings: &mut Warnings,
) -> anyhow::Result<Option<String>> {
    let mut conversation = service.converse();
    let mut to_ask = 0..shots.count();
    let mut asked = VecDeque::with_capacity(IN_FLIGHT);
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
        while asked.len() < IN_FLIGHT
            && let Some(index) = to_ask.next()
        {
            let request = shots.request(index);
            asked.push_back(local::begin(&mut conversation, "frame.render", &request)?);
        }
        let Some(next) = asked.pop_front() else { break };
        let (frame, attached) = local::read::<wire::Frame>(next)?;
        progress.suspend(|| clamps.tell(&frame.clamped, warnings));
        let picture = frame.images.get("color");
        let picture = picture.context("a frame has a color picture")?;
        reel.push(picture.bytes(&attached)?.into())?;
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

fn of_compression(compression: wire::Compression) -> Compression {
    match compression {
        wire::Compression::Fast => Compression::Fast,
        wire::Compression::Default => Compression::Default,
        wire::Compression::Best => Compression::Best,
    }
}
