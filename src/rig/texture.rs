//! Pictures of materials, with their mipmaps: made once at load, so that every renderer samples the same texels.
//! Never lives here: decoding a file.

use std::sync::LazyLock;

/// A picture and its halvings down to a single texel.
#[derive(Debug)]
pub struct Texture {
    file: String,
    encoding: Encoding,
    levels: Vec<TextureLevel>,
}

/// What the bytes of red, green and blue mean. Those of alpha are linear in any case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Encoding {
    /// Colors.
    #[default]
    Srgb,
    /// Numbers.
    Linear,
}

/// Texels, rows from the top.
#[derive(Debug, PartialEq, Eq)]
pub struct TextureLevel {
    /// In texels, at least 1.
    pub width: u32,
    /// In texels, at least 1.
    pub height: u32,
    /// Red, green, blue and straight alpha.
    pub texels: Vec<[u8; 4]>,
}

impl Texture {
    /// `file` is the base name of its file. Each level has half the sides of the one before, rounded down; its texels
    /// are the mean of the area that they cover: of colors in linear light, each as much as it is opaque.
    ///
    /// # Panics
    /// Where the level has no texels, or not as many as its sides say.
    pub fn new(file: String, encoding: Encoding, full: TextureLevel) -> Self {
        assert!(
            full.width > 0
                && full.height > 0
                && full.texels.len() == full.width as usize * full.height as usize
        );
        let mut levels = vec![full];
        while let Some(next) = levels.last().and_then(|last| last.halved(encoding)) {
            levels.push(next);
        }
        Self {
            file,
            encoding,
            levels,
        }
    }

    /// The base name of its file.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// What the bytes of its texels mean.
    pub fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// From the full picture to a single texel.
    pub fn levels(&self) -> &[TextureLevel] {
        &self.levels
    }

    /// Of all levels.
    pub fn memory_bytes(&self) -> usize {
        self.levels
            .iter()
            .map(|level| size_of_val(level.texels.as_slice()))
            .sum()
    }
}

impl TextureLevel {
    fn halved(&self, encoding: Encoding) -> Option<Self> {
        if (self.width, self.height) == (1, 1) {
            return None;
        }
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        let (columns, rows) = (shares(self.width, width), shares(self.height, height));
        let is_opaque = self.texels.iter().all(|texel| texel[3] == 255);
        let mut texels = Vec::with_capacity(width as usize * height as usize);
        for row in &rows {
            for column in &columns {
                let mut mean = Mean::default();
                for &(y, of_row) in row.iter().filter(|(_, share)| *share > 0.0) {
                    for &(x, of_column) in column.iter().filter(|(_, share)| *share > 0.0) {
                        let texel = self.texels[y * self.width as usize + x];
                        let share = of_row * of_column;
                        if is_opaque {
                            mean.add_opaque(texel, share, encoding);
                        } else {
                            mean.add(texel, share, encoding);
                        }
                    }
                }
                texels.push(mean.texel(encoding));
            }
        }
        Some(Self {
            width,
            height,
            texels,
        })
    }
}

/// Of texels, each with its share.
#[derive(Default)]
struct Mean {
    /// As if all were opaque.
    color: [f32; 3],
    /// Each as much as it is opaque.
    opaque_color: [f32; 3],
    alpha: f32,
    /// Whether any is not opaque.
    is_translucent: bool,
}

impl Mean {
    /// Of a picture without any that is not.
    fn add_opaque(&mut self, [r, g, b, _]: [u8; 4], share: f32, encoding: Encoding) {
        for (channel, byte) in [r, g, b].into_iter().enumerate() {
            self.color[channel] += share * number(byte, encoding);
        }
    }

    fn add(&mut self, [r, g, b, alpha]: [u8; 4], share: f32, encoding: Encoding) {
        let opacity = f32::from(alpha) / 255.0;
        self.alpha += share * opacity;
        self.is_translucent |= alpha < 255;
        for (channel, byte) in [r, g, b].into_iter().enumerate() {
            let number = number(byte, encoding);
            self.color[channel] += share * number;
            self.opaque_color[channel] += share * opacity * number;
        }
    }

    fn texel(self, encoding: Encoding) -> [u8; 4] {
        let byte = |number: f32| (number * 255.0 + 0.5) as u8;
        // Nobody sees the colors of what is transparent throughout, but its neighbours are mixed with them.
        let color = if self.is_translucent && self.alpha > 0.0 {
            self.opaque_color.map(|channel| channel / self.alpha)
        } else {
            self.color
        };
        let [r, g, b] = color.map(|channel| match encoding {
            Encoding::Srgb => srgb(channel),
            Encoding::Linear => byte(channel),
        });
        [
            r,
            g,
            b,
            if self.is_translucent {
                byte(self.alpha)
            } else {
                255
            },
        ]
    }
}

fn number(byte: u8, encoding: Encoding) -> f32 {
    match encoding {
        Encoding::Srgb => LINEAR_FROM_SRGB[byte as usize],
        Encoding::Linear => f32::from(byte) / 255.0,
    }
}

/// Of each of `to` places, up to three of the `from` ones that it covers, and how much of it each one makes up.
fn shares(from: u32, to: u32) -> Vec<[(usize, f32); 3]> {
    let scale = f64::from(from) / f64::from(to);
    let share = |place: u32| {
        let (start, end) = (f64::from(place) * scale, f64::from(place + 1) * scale);
        let first = start as usize;
        [first, first + 1, first + 2].map(|at| {
            let covered = (end.min(at as f64 + 1.0) - start.max(at as f64)).max(0.0);
            (at, (covered / scale) as f32)
        })
    };
    (0..to).map(share).collect()
}

/// Of a channel from 0 to 1 (IEC 61966-2-1).
pub fn linear_from_srgb(encoded: f64) -> f32 {
    let linear = if encoded <= 0.04045 {
        encoded / 12.92
    } else {
        libm::pow((encoded + 0.055) / 1.055, 2.4)
    };
    linear as f32
}

/// Of each of the 256 values of a channel (IEC 61966-2-1).
pub static LINEAR_FROM_SRGB: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|encoded| linear_from_srgb(encoded as f64 / 255.0)));

/// The nearest of the 256 values: the middle between two neighbours is where one gives way to the next.
fn srgb(linear: f32) -> u8 {
    static MIDDLES: LazyLock<[f32; 255]> = LazyLock::new(|| {
        std::array::from_fn(|below| linear_from_srgb((below as f64 + 0.5) / 255.0))
    });
    MIDDLES.partition_point(|middle| *middle <= linear) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texture(width: u32, height: u32, texel: impl Fn(u32, u32) -> [u8; 3]) -> Texture {
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let texels = places
            .map(|(x, y)| {
                let [r, g, b] = texel(x, y);
                [r, g, b, 255]
            })
            .collect();
        Texture::new(
            "t.png".to_owned(),
            Encoding::Srgb,
            TextureLevel {
                width,
                height,
                texels,
            },
        )
    }

    #[test]
    fn every_side_is_halved_until_one_texel_is_left() {
        let sides: Vec<_> = texture(13, 4, |_, _| [9, 99, 199])
            .levels
            .iter()
            .map(|l| (l.width, l.height))
            .collect();
        assert_eq!(sides, [(13, 4), (6, 2), (3, 1), (1, 1)]);
    }

    #[test]
    fn a_plain_color_stays_itself_on_every_level() {
        for value in 0..=255u8 {
            for level in texture(7, 5, |_, _| [value, 255 - value, 128]).levels {
                assert!(
                    level
                        .texels
                        .iter()
                        .all(|texel| *texel == [value, 255 - value, 128, 255])
                );
            }
        }
    }

    #[test]
    fn black_and_white_mix_in_linear_light() {
        let checkered = texture(4, 4, |x, y| [if (x + y) % 2 == 0 { 255 } else { 0 }; 3]);
        // Half the light is 188 in sRGB, not 128.
        assert_eq!(checkered.levels[1].texels, [[188, 188, 188, 255]; 4]);
    }

    #[test]
    fn an_odd_side_is_covered_evenly() {
        // Three columns, one of them white, in one: a third of the light.
        let third = texture(3, 1, |x, _| [if x == 1 { 255 } else { 0 }; 3]).levels[1].texels[0][0];
        assert_eq!(third, 156);
    }

    #[test]
    fn transparent_texels_lend_no_color_and_numbers_are_averaged_as_they_are() {
        let level = |texels: [[u8; 4]; 2]| TextureLevel {
            width: 2,
            height: 1,
            texels: texels.to_vec(),
        };
        let one = |encoding, texels| {
            Texture::new(String::new(), encoding, level(texels)).levels[1].texels[0]
        };
        let leaf = [[10, 200, 30, 255], [255, 0, 255, 0]];
        assert_eq!(one(Encoding::Srgb, leaf), [10, 200, 30, 128]);
        let numbers = [[0, 100, 255, 255], [100, 200, 255, 255]];
        assert_eq!(one(Encoding::Linear, numbers), [50, 150, 255, 255]);
        let clear = [[40, 40, 40, 0], [40, 40, 40, 0]];
        assert_eq!(one(Encoding::Srgb, clear), [40, 40, 40, 0]);
    }
}
