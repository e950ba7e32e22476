//! From an encoded picture to texels. Never lives here: who refers to it.

use crate::limits::{LimitExceeded, Limits};
use crate::rig::TextureLevel;
use image::ImageReader;
use std::io::Cursor;

/// Why an encoded picture gives no texels, to follow a colon. No picture is worth refusing a rig for: it is drawn without.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{0}")]
pub(super) struct BadPicture(String);

impl From<LimitExceeded> for BadPicture {
    fn from(exceeded: LimitExceeded) -> Self {
        Self(exceeded.to_string())
    }
}

impl From<image::ImageError> for BadPicture {
    fn from(error: image::ImageError) -> Self {
        Self(error.to_string())
    }
}

impl From<std::io::Error> for BadPicture {
    fn from(error: std::io::Error) -> Self {
        Self(error.to_string())
    }
}

/// Decodes the pictures of one rig: all of them together are held to what rigs may take in memory.
#[derive(Debug)]
pub(super) struct Decoder<'a> {
    limits: &'a Limits,
    /// Of the textures so far.
    bytes: u64,
}

impl<'a> Decoder<'a> {
    pub(super) fn new(limits: &'a Limits) -> Self {
        Self { limits, bytes: 0 }
    }

    pub(super) fn decode(
        &mut self,
        encoded: &[u8],
        alpha: Alpha,
    ) -> Result<TextureLevel, BadPicture> {
        let [width, height] = dimensions(encoded, self.limits)?;
        // A small file can hold many pixels, and a rig many such files, also broken ones: neither memory nor time must be gone before the
        // rig is weighed. The halvings come to a third of the full picture.
        let bytes = self.bytes + u64::from(width) * u64::from(height) * 16 / 3;
        self.limits.rig_bytes(bytes)?;
        self.bytes = bytes;
        decode(encoded, [width, height], alpha, self.limits)
    }
}

/// What becomes of a picture's alpha.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Alpha {
    Keep,
    /// All is opaque.
    Drop,
}

/// Width and height, neither of them 0, of a picture that may be decoded: BMP, PNG or JPEG, recognised by content.
fn dimensions(encoded: &[u8], limits: &Limits) -> Result<[u32; 2], BadPicture> {
    let reader = reader(encoded)?;
    if reader.format().is_none() {
        let reason = "it is neither a BMP nor a PNG nor a JPEG picture";
        return Err(BadPicture(reason.to_owned()));
    }
    let (width, height) = reader.into_dimensions()?;
    limits.side(width.max(height))?;
    limits.pixels(u64::from(width) * u64::from(height))?;
    if width == 0 || height == 0 {
        return Err(BadPicture("it has no pixels".to_owned()));
    }
    Ok([width, height])
}

fn reader(encoded: &[u8]) -> Result<ImageReader<Cursor<&[u8]>>, BadPicture> {
    Ok(ImageReader::new(Cursor::new(encoded)).with_guessed_format()?)
}

/// What has these [`dimensions`].
fn decode(
    encoded: &[u8],
    [width, height]: [u32; 2],
    alpha: Alpha,
    limits: &Limits,
) -> Result<TextureLevel, BadPicture> {
    let mut reader = reader(encoded)?;
    let mut ceilings = image::Limits::default();
    // Sixteen bits of four channels, and as much again for the decoder's own needs.
    ceilings.max_alloc = Some(2 * 8 * limits.pixels);
    reader.limits(ceilings);
    let decoded = reader.decode()?;
    let texels = match alpha {
        Alpha::Keep => decoded.into_rgba8().pixels().map(|pixel| pixel.0).collect(),
        Alpha::Drop => {
            let opaque = |[r, g, b]: [u8; 3]| [r, g, b, 255];
            decoded
                .into_rgb8()
                .pixels()
                .map(|pixel| opaque(pixel.0))
                .collect()
        }
    };
    Ok(TextureLevel {
        width,
        height,
        texels,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{DynamicImage, ImageFormat, Rgba, RgbaImage};

    fn encoded(format: ImageFormat) -> Vec<u8> {
        let picture = RgbaImage::from_fn(3, 2, |x, y| Rgba([x as u8 * 100, y as u8 * 200, 7, 128]));
        let mut file = Cursor::new(Vec::new());
        let picture = DynamicImage::from(picture);
        picture
            .write_to(&mut file, format)
            .expect("it can be encoded");
        file.into_inner()
    }

    #[test]
    fn both_formats_come_out_from_the_top_and_opaque() {
        for format in [ImageFormat::Bmp, ImageFormat::Png] {
            let level = Decoder::new(&Limits::default())
                .decode(&encoded(format), Alpha::Drop)
                .expect("it can be decoded");
            assert_eq!((level.width, level.height), (3, 2));
            assert_eq!(level.texels[1], [100, 0, 7, 255], "{format:?}");
            assert_eq!(level.texels[3], [0, 200, 7, 255], "{format:?}");
        }
    }

    #[test]
    fn what_is_no_picture_or_too_large_says_so() {
        let png = encoded(ImageFormat::Png);
        let limits = |side, pixels| Limits {
            side,
            pixels,
            ..Limits::default()
        };
        for (bytes, limits, reason) in [
            (&b"positions 3 {"[..], limits(3, 6), "neither"),
            (&png[..40], limits(3, 6), ""),
            (&png, limits(3, 5), "`pixels` of 5"),
            (&png, limits(2, 6), "`side` of 2"),
        ] {
            let bad = Decoder::new(&limits).decode(bytes, Alpha::Drop);
            let found = bad.map(|_| ()).map_err(|bad| bad.to_string());
            assert!(found.is_err_and(|found| found.contains(reason)), "{reason}");
        }
    }

    #[test]
    fn all_pictures_together_are_held_to_the_memory_of_rigs() {
        let png = encoded(ImageFormat::Png);
        // Six pixels of four bytes, and their halvings.
        let limits = Limits {
            rig_bytes: 2 * 32,
            ..Limits::default()
        };
        let mut decoder = Decoder::new(&limits);
        let mut is_decoded = |bytes: &[u8]| decoder.decode(bytes, Alpha::Keep).is_ok();
        // A broken one counts as well, for the time that it took.
        assert_eq!(
            [&png, &png[..60], &png].map(&mut is_decoded),
            [true, false, false]
        );
        assert!(!is_decoded(&png));
    }
}
