//! A frame as a PNG file. Never lives here: several frames in one file.

use crate::frame::Raster;
use png::{BitDepth, ColorType, Encoder, EncodingError, Filter};

/// How much time to spend on how small a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Compression {
    /// The least time and the largest file.
    #[default]
    Fast,
    /// Between the two others in time and size.
    Balanced,
    /// The smallest file, whatever time it takes.
    Best,
}

/// A PNG of the frame: RGBA8, sRGB.
///
/// # Errors
/// Where the encoder cannot make one, which a frame within the limits does not bring about.
pub fn png(frame: &Raster, compression: Compression) -> Result<Vec<u8>, EncodingError> {
    let (compression, filter) = match compression {
        // On pictures of characters a sixth larger than with Paeth's filter, in two thirds of the time.
        Compression::Fast => (png::Compression::Fastest, Filter::Up),
        Compression::Balanced => (png::Compression::Balanced, Filter::Adaptive),
        Compression::Best => (png::Compression::High, Filter::Adaptive),
    };
    // Pictures of characters shrink to well below a quarter; growing once from here is cheap.
    let mut file = Vec::with_capacity(frame.bytes.len() / 8 + 1024);
    let mut encoder = Encoder::new(&mut file, frame.size.width, frame.size.height);
    encoder.set_color(ColorType::Rgba);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(compression);
    encoder.set_filter(filter);
    encoder.write_header()?.write_image_data(&frame.bytes)?;
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::ImageKind;
    use crate::scene::Size;

    #[test]
    fn every_level_gives_back_the_same_pixels() {
        let size = Size {
            width: 17,
            height: 5,
        };
        let pixels: Vec<u8> = (0..size.pixels() * 4)
            .map(|i| (i * 37 % 251) as u8)
            .collect();
        let frame = Raster {
            size,
            kind: ImageKind::Color,
            bytes: pixels.into(),
        };
        for level in [Compression::Fast, Compression::Balanced, Compression::Best] {
            let file = png(&frame, level).unwrap();
            let decoded = image::load_from_memory(&file).unwrap().into_rgba8();
            assert_eq!((decoded.width(), decoded.height()), (17, 5));
            assert_eq!(decoded.into_raw()[..], frame.bytes[..], "{level:?}");
        }
    }
}
