//! A frame as a PNG file. Never lives here: several frames in one file.

use crate::frame::Frame;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, ImageError};

/// How much time to spend on how small a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Compression {
    #[default]
    Fast,
    Default,
    Best,
}

/// A PNG of the frame: RGBA8, sRGB.
///
/// # Errors
/// Where the encoder cannot make one, which a frame within the limits does not bring about.
pub fn png(frame: &Frame, compression: Compression) -> Result<Vec<u8>, ImageError> {
    let (compression, filter) = match compression {
        // On pictures of characters as small as choosing a filter for each row makes it, in a fifth of the time.
        Compression::Fast => (CompressionType::Fast, FilterType::Paeth),
        Compression::Default => (CompressionType::Default, FilterType::Adaptive),
        Compression::Best => (CompressionType::Best, FilterType::Adaptive),
    };
    // Pictures of characters shrink to well below a quarter; growing once from here is cheap.
    let mut file = Vec::with_capacity(frame.pixels.len() / 8 + 1024);
    let encoder = PngEncoder::new_with_quality(&mut file, compression, filter);
    encoder.write_image(
        &frame.pixels,
        frame.size.width,
        frame.size.height,
        ExtendedColorType::Rgba8,
    )?;
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;
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
        let frame = Frame { size, pixels };
        for level in [Compression::Fast, Compression::Default, Compression::Best] {
            let file = png(&frame, level).unwrap();
            let decoded = image::load_from_memory(&file).unwrap().into_rgba8();
            assert_eq!((decoded.width(), decoded.height()), (17, 5));
            assert_eq!(decoded.into_raw(), frame.pixels, "{level:?}");
        }
    }
}
