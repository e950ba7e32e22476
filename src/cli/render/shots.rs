//! Which frames a sequence has, and what each of them asks for. Never lives here: files.

use super::args::{MOST_FRAMES, RenderArgs};
use super::format::Format;
use super::framing::frame_clip;
use super::view::{View, rest_of};
use crate::cli::values::Seconds;
use crate::encode::FrameRate;
use crate::engine::RigRef;
use crate::protocol::frame::FrameParams;
use crate::protocol::pose::ClipAt;
use crate::protocol::rig::RigDescription;
use crate::scene::{Bounds, Orbit};
use crate::service::Service;
use anyhow::{Context, bail};
use std::f64::consts::TAU;
use std::sync::Arc;

/// What changes from frame to frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Motion {
    /// Nothing: there is one.
    Still,
    /// The camera goes around in so many, and a clip without a time is played meanwhile.
    Turntable(u32),
    /// A clip is played from its start to its end.
    Clip,
}

const DEFAULT_FPS: f64 = 24.0;

impl RenderArgs {
    pub(super) fn motion(&self, format: Format) -> anyhow::Result<Motion> {
        let has_fps = self.sequence.fps.is_some();
        match self.sequence.turntable {
            Some(frames) => Ok(Motion::Turntable(frames)),
            None if self.pose.plays_clip() && (format != Format::Png || has_fps) => {
                Ok(Motion::Clip)
            }
            None if has_fps => {
                bail!("--fps is for a sequence: give --turntable, or --clip without --time")
            }
            None => Ok(Motion::Still),
        }
    }

    pub(super) fn rate(&self) -> anyhow::Result<FrameRate> {
        let default = || FrameRate::new(DEFAULT_FPS);
        let rate = self.sequence.fps.map(|fps| fps.0).or_else(default);
        rate.context("24 frames a second are a rate")
    }
}

/// The frames to draw.
pub(super) struct Shots {
    /// But for the camera.
    request: FrameParams,
    view: View,
    /// What the rig takes up at rest.
    rest: Bounds,
    count: u32,
    turntable: Option<Turntable>,
    /// When the clip starts, where it is played.
    played_from: Option<f64>,
    rate: FrameRate,
}

#[derive(Clone, Copy)]
struct Turntable {
    from: f64,
    frames: u32,
}

impl Shots {
    pub(super) fn new(
        args: &RenderArgs,
        motion: Motion,
        rate: FrameRate,
        mut request: FrameParams,
        rig: &RigDescription,
        service: &Arc<Service>,
        loaded: &RigRef,
    ) -> anyhow::Result<Self> {
        let rest = rest_of(rig);
        let mut view = args.camera.view(&rest)?;
        let range = match (&args.pose.clip, args.pose.time) {
            (Some(clip), None) => clip_range(rig, clip),
            _ => [0.0; 2],
        };
        request.pose.clip = args.pose.clip.clone().map(|name| ClipAt {
            name,
            time: args.pose.time.map_or(range[0], |Seconds(time)| time),
        });
        let plays = args.pose.plays_clip() && motion != Motion::Still;
        if plays {
            frame_clip(&mut view, &request, range, service, loaded)?;
        }
        let (count, turntable) = match motion {
            Motion::Still => (1, None),
            Motion::Turntable(frames) => {
                let from = view.azimuth.unwrap_or(Orbit::AZIMUTH);
                (frames, Some(Turntable { from, frames }))
            }
            Motion::Clip => (frames_of(range[1] - range[0], rate)?, None),
        };
        Ok(Self {
            request,
            view,
            rest,
            count,
            turntable,
            played_from: plays.then_some(range[0]),
            rate,
        })
    }

    pub(super) fn count(&self) -> u32 {
        self.count
    }

    /// What to ask for the frame of that index.
    pub(super) fn request(&self, index: u32) -> FrameParams {
        let mut request = self.request.clone();
        let mut view = self.view.clone();
        if let Some(turntable) = self.turntable {
            let share = f64::from(index) / f64::from(turntable.frames);
            view.azimuth = Some(turntable.from + TAU * share);
        }
        request.camera = view.camera(&self.rest);
        if let (Some(from), Some(clip)) = (self.played_from, &mut request.pose.clip) {
            clip.time = from + self.rate.seconds(index);
        }
        request
    }
}

/// Frames of a clip: as many as its range has room for, so that the last one does not repeat the first of the next round.
fn frames_of(seconds: f64, rate: FrameRate) -> anyhow::Result<u32> {
    let frames = (seconds * rate.per_second()).round().max(1.0);
    if frames > f64::from(MOST_FRAMES) {
        bail!("the clip comes to {frames} frames, but at most {MOST_FRAMES} are drawn");
    }
    Ok(frames as u32)
}

fn clip_range(rig: &RigDescription, clip: &str) -> [f64; 2] {
    let found = rig.clips.iter().find(|found| found.name == clip);
    // What is wrong with the name of one that is not there, the frame request will be told.
    found.map_or([0.0; 2], |found| found.range)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clip_has_the_frames_that_fit_its_range() {
        let rate = FrameRate::new(24.0).unwrap();
        for (seconds, frames) in [(4.0, 96), (0.0, 1), (-1.0, 1), (1.0 / 24.0, 1), (0.0625, 2)] {
            assert_eq!(frames_of(seconds, rate).unwrap(), frames, "{seconds}");
        }
        assert!(frames_of(1e9, rate).is_err());
    }
}
