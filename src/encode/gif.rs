//! Frames as an animated GIF. Never lives here: which 256 colors a frame gets.

use super::animation::{AnimationError, FrameRate, same_size};
use super::palette::Indexed;
use super::png::Compression;
use crate::frame::Raster;
use crate::scene::Size;
use gif::{DisposalMethod, Encoder, Repeat};
use std::borrow::Cow;
use std::io::Write;

/// An animated GIF in the making that plays over and over: 256 colors for each frame, pixels opaque or not there at all. One frame is
/// held at a time.
pub struct AnimatedGif<W: Write> {
    encoder: Encoder<W>,
    size: Size,
    rate: FrameRate,
    compression: Compression,
    written: u32,
}

impl<W: Write> AnimatedGif<W> {
    /// Viewers take a frame of less than two hundredths of a second for a mistake and show it for ten.
    pub const MOST_PER_SECOND: f64 = 50.0;

    /// `compression` is how long to look for good colors.
    ///
    /// # Errors
    /// Where the rate or the size is past what a GIF can be, or `out` fails.
    pub fn new(
        out: W,
        size: Size,
        rate: FrameRate,
        compression: Compression,
    ) -> Result<Self, AnimationError> {
        Self::accept(rate)?;
        let Size { width, height } = size;
        let (Ok(across), Ok(down)) = (width.try_into(), height.try_into()) else {
            return Err(AnimationError::TooLarge { width, height });
        };
        let mut encoder = Encoder::new(out, across, down, &[])?;
        encoder.set_repeat(Repeat::Infinite)?;
        Ok(Self {
            encoder,
            size,
            rate,
            compression,
            written: 0,
        })
    }

    /// Whether frames can follow each other so quickly.
    ///
    /// # Errors
    /// [`AnimationError::TooQuick`] where they cannot.
    pub fn accept(rate: FrameRate) -> Result<(), AnimationError> {
        let (most, asked) = (Self::MOST_PER_SECOND, rate.per_second());
        if asked > most {
            return Err(AnimationError::TooQuick { most, asked });
        }
        Ok(())
    }

    /// # Errors
    /// Where the frame is not of the size of the file, or `out` fails.
    pub fn push(&mut self, frame: &Raster) -> Result<(), AnimationError> {
        same_size(self.size, frame)?;
        let Indexed {
            palette,
            transparent,
            indices,
        } = Indexed::new(&frame.bytes, self.compression);
        let written = gif::Frame {
            delay: self.rate.hundredths(self.written),
            // What is not there in the next frame must not show this one.
            dispose: DisposalMethod::Background,
            transparent,
            // Both fitted when the file was begun.
            width: self.size.width as u16,
            height: self.size.height as u16,
            palette: Some(palette),
            buffer: Cow::Owned(indices),
            ..gif::Frame::default()
        };
        self.encoder.write_frame(&written)?;
        self.written += 1;
        Ok(())
    }

    /// Writes the end of the file, and flushes it.
    ///
    /// # Errors
    /// Where `out` fails.
    pub fn finish(self) -> Result<(), AnimationError> {
        Ok(self.encoder.into_inner()?.flush()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::ImageKind;

    const SIZE: Size = Size {
        width: 40,
        height: 30,
    };

    /// A ramp of more colors than a GIF has, on a plain ground with a hole in it.
    fn frame(blue: u8) -> Raster {
        let pixel = |i: u32| {
            let (x, y) = (i % SIZE.width, i / SIZE.width);
            match (x, y) {
                (0..4, 0..4) => [200, 10, 10, 100],
                (_, 0..10) => [19, 23, 31, 255],
                _ => [(x * 6) as u8, (y * 8) as u8, blue, 255],
            }
        };
        Raster {
            size: SIZE,
            kind: ImageKind::Color,
            bytes: (0..SIZE.width * SIZE.height)
                .flat_map(pixel)
                .collect::<Vec<u8>>()
                .into(),
        }
    }

    fn file(
        frames: &[Raster],
        fps: f64,
        compression: Compression,
    ) -> Result<Vec<u8>, AnimationError> {
        let mut file = Vec::new();
        let mut gif = AnimatedGif::new(&mut file, SIZE, FrameRate::new(fps).unwrap(), compression)?;
        for frame in frames {
            gif.push(frame)?;
        }
        gif.finish()?;
        Ok(file)
    }

    #[test]
    fn frames_come_back_nearly_as_they_were_and_at_their_time() {
        let frames = [frame(0), frame(120), frame(240)];
        for compression in [Compression::Fast, Compression::Balanced, Compression::Best] {
            let file = file(&frames, 24.0, compression).unwrap();
            let mut options = gif::DecodeOptions::new();
            options.set_color_output(gif::ColorOutput::RGBA);
            let mut decoder = options.read_info(&*file).unwrap();
            let mut delays = Vec::new();
            for frame in &frames {
                let read = decoder.read_next_frame().unwrap().unwrap();
                delays.push(read.delay);
                let mut sum = 0;
                for (was, is) in frame.bytes.chunks(4).zip(read.buffer.chunks(4)) {
                    assert_eq!(is[3], if was[3] < 128 { 0 } else { 255 });
                    if was == [19, 23, 31, 255] {
                        assert_eq!(was, is, "the ground keeps its color");
                    }
                    if was[3] == 255 {
                        sum += (0..3)
                            .map(|c| was[c].abs_diff(is[c]) as usize)
                            .sum::<usize>();
                    }
                }
                let mean = sum as f64 / (3.0 * SIZE.pixels() as f64);
                assert!(mean < 4.0, "{compression:?}: off by {mean}");
            }
            assert!(decoder.read_next_frame().unwrap().is_none());
            assert_eq!(delays, [4, 4, 5]);
            assert_eq!(decoder.repeat(), Repeat::Infinite);
        }
    }

    #[test]
    fn what_a_gif_cannot_be_is_an_error() {
        assert!(matches!(
            file(&[], 50.1, Compression::Fast),
            Err(AnimationError::TooQuick { .. })
        ));
        let huge = Size {
            width: 65_536,
            height: 1,
        };
        let rate = FrameRate::new(24.0).unwrap();
        assert!(matches!(
            AnimatedGif::new(Vec::new(), huge, rate, Compression::Fast),
            Err(AnimationError::TooLarge { .. })
        ));
        let mut other = frame(0);
        other.size.width = 30;
        assert!(matches!(
            file(&[other], 24.0, Compression::Fast),
            Err(AnimationError::OtherSize { .. })
        ));
    }
}
