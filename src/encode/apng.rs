//! Frames as an animated PNG, exactly as they are. Never lives here: how long a frame is shown.

use super::animation::{AnimationError, FrameRate, same_size};
use super::png::Compression;
use crate::frame::Raster;
use crate::scene::Size;
use png::{BitDepth, ColorType, Encoder, Filter, SrgbRenderingIntent, Writer};
use std::io::Write;

/// An animated PNG in the making, RGBA8 and sRGB, that plays over and over. One frame is held at a time.
pub struct AnimatedPng<W: Write> {
    writer: Writer<W>,
    size: Size,
}

impl<W: Write> AnimatedPng<W> {
    /// # Errors
    /// Where `out` fails, or where there are to be no frames.
    pub fn new(
        out: W,
        size: Size,
        frames: u32,
        rate: FrameRate,
        compression: Compression,
    ) -> Result<Self, AnimationError> {
        let mut encoder = Encoder::new(out, size.width, size.height);
        encoder.set_color(ColorType::Rgba);
        encoder.set_depth(BitDepth::Eight);
        encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
        // As for a single picture.
        let (compression, filter) = match compression {
            Compression::Fast => (png::Compression::Fast, Filter::Paeth),
            Compression::Balanced => (png::Compression::Balanced, Filter::Adaptive),
            Compression::Best => (png::Compression::High, Filter::Adaptive),
        };
        encoder.set_compression(compression);
        encoder.set_filter(filter);
        // Without end.
        encoder.set_animated(frames, 0)?;
        let (numerator, denominator) = rate.fraction();
        encoder.set_frame_delay(numerator, denominator)?;
        // A file that lacks a frame that its header promises is not finished as if it were whole.
        encoder.validate_sequence(true);
        let writer = encoder.write_header()?;
        Ok(Self { writer, size })
    }

    /// # Errors
    /// Where the frame is not of the size of the file, there are more than promised, or `out` fails.
    pub fn push(&mut self, frame: &Raster) -> Result<(), AnimationError> {
        same_size(self.size, frame)?;
        Ok(self.writer.write_image_data(&frame.bytes)?)
    }

    /// Writes the end of the file, and flushes it.
    ///
    /// # Errors
    /// Where frames are lacking, or `out` fails.
    pub fn finish(self) -> Result<(), AnimationError> {
        Ok(self.writer.finish()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::ImageKind;

    const SIZE: Size = Size {
        width: 7,
        height: 5,
    };

    fn frame(seed: usize) -> Raster {
        let pixels = (0..SIZE.pixels() * 4).map(|i| ((i + seed) * 37 % 251) as u8);
        Raster {
            size: SIZE,
            kind: ImageKind::Color,
            bytes: pixels.collect::<Vec<u8>>().into(),
        }
    }

    fn file(
        frames: &[Raster],
        promised: u32,
        compression: Compression,
    ) -> Result<Vec<u8>, AnimationError> {
        let mut file = Vec::new();
        let rate = FrameRate::new(24.0).unwrap();
        let mut apng = AnimatedPng::new(&mut file, SIZE, promised, rate, compression)?;
        for frame in frames {
            apng.push(frame)?;
        }
        apng.finish()?;
        Ok(file)
    }

    #[test]
    fn every_frame_comes_back_as_it_was() {
        let frames = [frame(0), frame(1), frame(2)];
        for compression in [Compression::Fast, Compression::Balanced, Compression::Best] {
            let file = file(&frames, 3, compression).unwrap();
            let mut reader = png::Decoder::new(std::io::Cursor::new(&file))
                .read_info()
                .unwrap();
            let control = reader.info().animation_control.unwrap();
            assert_eq!((control.num_frames, control.num_plays), (3, 0));
            for frame in &frames {
                let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
                reader.next_frame(&mut pixels).unwrap();
                assert_eq!(pixels[..], frame.bytes[..]);
                let control = reader.info().frame_control.unwrap();
                assert_eq!((control.delay_num, control.delay_den), (1, 24));
                assert_eq!(control.blend_op, png::BlendOp::Source);
            }
        }
    }

    #[test]
    fn a_file_with_other_frames_than_promised_is_not_finished() {
        assert!(file(&[frame(0)], 2, Compression::Fast).is_err());
        assert!(file(&[frame(0), frame(1)], 1, Compression::Fast).is_err());
        assert!(file(&[], 0, Compression::Fast).is_err());
        let mut other = frame(0);
        other.size.width = 5;
        assert!(matches!(
            file(&[other], 1, Compression::Fast),
            Err(AnimationError::OtherSize { .. })
        ));
    }
}
