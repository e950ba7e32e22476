//! `rigd render`: a picture or a sequence of them, drawn by this process.
//! Never lives here: anything that is not asked of the service by a request.

mod args;
mod framing;
mod output;
mod request;
mod shots;

pub(super) use args::RenderArgs;

use super::{local, print, printable};
use crate::encode::{AnimatedGif, Compression};
use crate::formats::Source;
use crate::protocol::frame as wire;
use crate::protocol::pose::Clamped;
use crate::scene::Size;
use crate::service::Service;
use anyhow::{Context, bail};
use indicatif::{ProgressBar, ProgressStyle};
use output::{Format, Reel, Terms};
use shots::{Motion, Shots};
use signal_hook::consts::{SIGINT, SIGTERM};
use std::collections::{BTreeSet, VecDeque};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Frames that are drawn or wait for it while one is written: two keep the renderer busy, and three of the largest stay within what one
/// client may have in flight.
const IN_FLIGHT: usize = 3;

pub(super) fn run(args: &RenderArgs) -> anyhow::Result<()> {
    let format = Format::of(&args.output.output)?;
    let [width, height] = args.output.size.0;
    let (motion, rate) = (args.motion(format)?, args.rate()?);
    if format == Format::Gif {
        AnimatedGif::<Vec<u8>>::accept(rate)?;
    }
    let mut request = args.request("")?;
    request.image = format.image();
    let compression = of_compression(request.compression);

    let engine = args.renderer.open()?;
    request.rig = local::load(&engine, &args.files)?.name.clone();
    let service = Service::new(engine, Source::inline_only());
    let shots = Shots::new(args, motion, rate, request, &service)?;
    let terms = Terms {
        path: args.output.output.clone(),
        format,
        rate,
        compression,
        frames: (motion != Motion::Still).then(|| shots.count()),
    };
    let reel = Reel::new(terms, Size { width, height });
    let written = draw(&service, &shots, reel)?;
    print(&printable(&written))
}

/// Asks for all frames, a few at a time, and writes them in order as they come.
fn draw(service: &Arc<Service>, shots: &Shots, mut reel: Reel) -> anyhow::Result<String> {
    let mut conversation = service.converse();
    let mut to_ask = 0..shots.count();
    let mut asked = VecDeque::with_capacity(IN_FLIGHT);
    let mut clamped = BTreeSet::new();
    let progress = progress(shots.count());
    let stopped = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        signal_hook::flag::register(signal, Arc::clone(&stopped))?;
    }
    loop {
        // Here and not wherever it comes: what is half written is then cleared away.
        if stopped.load(Ordering::Relaxed) {
            bail!("stopped");
        }
        while asked.len() < IN_FLIGHT
            && let Some(index) = to_ask.next()
        {
            let request = shots.request(index);
            asked.push_back(local::begin(&mut conversation, "frame.render", &request)?);
        }
        let Some(next) = asked.pop_front() else { break };
        let (frame, attached) = local::read::<wire::Frame>(next)?;
        progress.suspend(|| warn(&frame.clamped, &mut clamped));
        let picture = frame.images.get("color");
        let picture = picture.context("a frame has a color picture")?;
        reel.push(picture.bytes(&attached)?.into())?;
        progress.inc(1);
    }
    progress.finish_and_clear();
    reel.finish()
}

/// Once for each degree of freedom, however many frames clamp it.
fn warn(found: &[Clamped], told: &mut BTreeSet<String>) {
    for Clamped { dof, asked, used } in found {
        if told.insert(dof.clone()) {
            let dof = printable(dof);
            eprintln!("warning: {dof} of {asked} is past its limit; used {used}");
        }
    }
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
