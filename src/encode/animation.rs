//! What animated files have in common: how long a frame is shown, and what can go wrong. Never lives here: a format.

use crate::frame::Raster;
use crate::scene::Size;

/// Frames a second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameRate(f64);

/// Why a file of several frames cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum AnimationError {
    /// A GIF is asked for frames faster than viewers show them.
    #[error("a GIF shows at most {most} frames a second, but {asked} are wanted")]
    TooQuick {
        /// The highest rate, in frames a second.
        most: f64,
        /// The rate that was asked for, in frames a second.
        asked: f64,
    },
    /// A GIF is asked for a side that its 16 bits cannot hold.
    #[error("a GIF has at most 65535 pixels a side, but {width}x{height} are wanted")]
    TooLarge {
        /// In pixels, as asked for.
        width: u32,
        /// In pixels, as asked for.
        height: u32,
    },
    /// A frame is not of the size that the file was begun with.
    #[error("a frame is of {} pixels, but the animation is of {}", size(.found), size(.expected))]
    OtherSize {
        /// That of the file.
        expected: Size,
        /// That of the frame.
        found: Size,
    },
    /// The GIF encoder failed, or what it writes to.
    #[error(transparent)]
    Gif(#[from] gif::EncodingError),
    /// The PNG encoder failed, or what it writes to; also where frames are lacking or too many.
    #[error(transparent)]
    Png(#[from] png::EncodingError),
    /// The end of a GIF could not be written or flushed.
    #[error(transparent)]
    Io(#[from] std::io::Error),
}

fn size(size: &Size) -> String {
    format!("{}x{}", size.width, size.height)
}

/// All frames of a file are of one size.
pub(super) fn same_size(expected: Size, frame: &Raster) -> Result<(), AnimationError> {
    if frame.size == expected {
        return Ok(());
    }
    Err(AnimationError::OtherSize {
        expected,
        found: frame.size,
    })
}

impl FrameRate {
    /// A frame every 100 seconds; a GIF can hold one for 655.
    pub const LEAST: f64 = 0.01;
    /// A thousand to a second, more than any screen shows.
    pub const MOST: f64 = 1000.0;

    /// `None` below [`Self::LEAST`], past [`Self::MOST`], and for what is no number.
    pub fn new(per_second: f64) -> Option<Self> {
        (Self::LEAST..=Self::MOST)
            .contains(&per_second)
            .then_some(Self(per_second))
    }

    /// How many frames a second, from [`Self::LEAST`] to [`Self::MOST`].
    pub fn per_second(self) -> f64 {
        self.0
    }

    /// When a frame is shown, counted from the first one.
    pub fn seconds(self, frame: u32) -> f64 {
        f64::from(frame) / self.0
    }

    /// For how many hundredths of a second a frame is shown. Each starts at the hundredth nearest to its time, so that rounding does not
    /// add up.
    pub(super) fn hundredths(self, frame: u32) -> u16 {
        let start = |frame: f64| (100.0 * frame / self.0).round();
        // At most 100 seconds.
        (start(f64::from(frame) + 1.0) - start(f64::from(frame))) as u16
    }

    /// The time of a frame as a fraction of a second, exact wherever 16 bits can be: the last convergent of its continued fraction that
    /// fits.
    pub(super) fn fraction(self) -> (u16, u16) {
        let most = f64::from(u16::MAX);
        let (mut rest, mut before, mut best) = (1.0 / self.0, (0.0, 1.0), (1.0, 0.0));
        loop {
            let whole = f64::floor(rest);
            let next = (whole * best.0 + before.0, whole * best.1 + before.1);
            // Also where the rest was nothing, and its inverse is no number to go on with.
            if !(next.0 <= most && next.1 <= most) {
                break;
            }
            (before, best) = (best, next);
            let error = (best.0 / best.1 * self.0 - 1.0).abs();
            if error < 1e-9 {
                break;
            }
            rest = 1.0 / (rest - whole);
        }
        (best.0 as u16, best.1 as u16)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_that_no_file_can_hold_are_none() {
        for fps in [0.0, -24.0, f64::NAN, f64::INFINITY, 1e-3, 1001.0] {
            assert!(FrameRate::new(fps).is_none(), "{fps}");
        }
        assert!(FrameRate::new(FrameRate::LEAST).is_some());
        assert!(FrameRate::new(FrameRate::MOST).is_some());
    }

    #[test]
    fn rounding_to_hundredths_does_not_add_up() {
        for fps in [0.01, 7.0, 23.976, 24.0, 30.0, 50.0] {
            let rate = FrameRate::new(fps).unwrap();
            let total: u64 = (0..240)
                .map(|frame| u64::from(rate.hundredths(frame)))
                .sum();
            assert!(
                (total as f64 - 24_000.0 / fps).abs() <= 0.5,
                "{fps}: {total}"
            );
            assert!((0..240).all(|frame| rate.hundredths(frame) >= 2), "{fps}");
        }
    }

    #[test]
    fn a_frame_lasts_a_fraction_of_a_second() {
        for (fps, fraction) in [
            (24.0, (1, 24)),
            (12.5, (2, 25)),
            (0.01, (100, 1)),
            (1000.0, (1, 1000)),
            (24_000.0 / 1001.0, (1001, 24_000)),
        ] {
            assert_eq!(FrameRate::new(fps).unwrap().fraction(), fraction, "{fps}");
        }
        let (numerator, denominator) = FrameRate::new(std::f64::consts::PI).unwrap().fraction();
        let error = f64::from(numerator) / f64::from(denominator) * std::f64::consts::PI - 1.0;
        assert!(error.abs() < 1e-7, "{numerator}/{denominator}");
    }
}
