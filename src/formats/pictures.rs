//! From an encoded picture to texels. Never lives here: who refers to it.

use crate::limits::{LimitExceeded, Limits};
use crate::rig::TextureLevel;
use image::ImageReader;
use std::io::Cursor;

/// Why an encoded picture gives no texels.
#[derive(Debug, PartialEq)]
pub(super) enum BadPicture {
    /// With the reason, to follow a colon.
    Undecodable(String),
    Limit(LimitExceeded),
}

impl From<LimitExceeded> for BadPicture {
    fn from(exceeded: LimitExceeded) -> Self {
        Self::Limit(exceeded)
    }
}

impl From<image::ImageError> for BadPicture {
    fn from(error: image::ImageError) -> Self {
        Self::Undecodable(error.to_string())
    }
}

/// What becomes of a picture's alpha.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Alpha {
    Keep,
    /// All is opaque.
    Drop,
}

/// Width and height, neither of them 0, of a picture that may be decoded: BMP, PNG or JPEG, told apart by content.
pub(super) fn dimensions(encoded: &[u8], limits: &Limits) -> Result<[u32; 2], BadPicture> {
    let reader = reader(encoded)?;
    if reader.format().is_none() {
        return Err(BadPicture::Undecodable(
            "it is neither a BMP nor a PNG nor a JPEG picture".to_owned(),
        ));
    }
    let (width, height) = reader.into_dimensions()?;
    limits.side(width.max(height))?;
    limits.pixels(u64::from(width) * u64::from(height))?;
    if width == 0 || height == 0 {
        return Err(BadPicture::Undecodable("it has no pixels".to_owned()));
    }
    Ok([width, height])
}

fn reader(encoded: &[u8]) -> Result<ImageReader<Cursor<&[u8]>>, BadPicture> {
    let reader = ImageReader::new(Cursor::new(encoded)).with_guessed_format();
    reader.map_err(|error| BadPicture::Undecodable(error.to_string()))
}

/// As [`dimensions`] allows.
pub(super) fn decode(
    encoded: &[u8],
    alpha: Alpha,
    limits: &Limits,
) -> Result<TextureLevel, BadPicture> {
    // Asked before anything of that size is allocated.
    let [width, height] = dimensions(encoded, limits)?;
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
            let level = decode(&encoded(format), Alpha::Drop, &Limits::default())
                .expect("it can be decoded");
            assert_eq!((level.width, level.height), (3, 2));
            assert_eq!(level.texels[1], [100, 0, 7, 255], "{format:?}");
            assert_eq!(level.texels[3], [0, 200, 7, 255], "{format:?}");
        }
    }

    #[test]
    fn what_is_no_picture_or_too_large_says_so() {
        let bad =
            |bytes: &[u8]| decode(bytes, Alpha::Drop, &Limits::default()).expect_err("it is bad");
        assert!(
            matches!(bad(b"positions 3 {"), BadPicture::Undecodable(reason) if reason.contains("neither"))
        );
        let png = encoded(ImageFormat::Png);
        assert!(matches!(bad(&png[..40]), BadPicture::Undecodable(_)));
        let limits = Limits {
            pixels: 5,
            ..Limits::default()
        };
        assert!(
            matches!(decode(&png, Alpha::Drop, &limits), Err(BadPicture::Limit(exceeded)) if exceeded.limit == "pixels")
        );
    }
}
