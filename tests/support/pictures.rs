//! Pictures as tests see them: asked for, decoded, projected onto, and compared with those that were accepted before.
//! Never lives here: what a picture should show.

use super::oracle::Vector;
use rigd::service::Service;
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;

/// A request's result and the raw bytes that follow it.
pub fn ask_attached(service: &Arc<Service>, method: &str, params: &Value) -> (Value, Vec<u8>) {
    super::ask_attached(service, method, params)
        .unwrap_or_else(|error| panic!("{method} of {params}: {error}"))
}

/// A request with the fields of `changes` in place of its own.
pub fn over(mut request: Value, changes: Value) -> Value {
    let changes: serde_json::Map<String, Value> = serde_json::from_value(changes).expect("fields");
    request.as_object_mut().expect("an object").extend(changes);
    request
}

/// The part of the attached bytes that a blob speaks of.
pub fn attached_bytes<'a>(blob: &Value, attached: &'a [u8]) -> &'a [u8] {
    let number = |field: &str| blob[field].as_u64().expect("a whole number") as usize;
    let start = number("offset");
    &attached[start..start + number("bytes")]
}

/// RGBA8, sRGB, straight alpha, rows from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    pub width: usize,
    pub height: usize,
    pub pixels: Vec<[u8; 4]>,
}

impl Image {
    pub fn from_bytes([width, height]: [usize; 2], bytes: &[u8]) -> Self {
        let (pixels, rest) = bytes.as_chunks::<4>();
        assert!(rest.is_empty() && pixels.len() == width * height);
        Self {
            width,
            height,
            pixels: pixels.to_vec(),
        }
    }

    pub fn from_png(file: &[u8]) -> Self {
        let decoded = image::load_from_memory_with_format(file, image::ImageFormat::Png);
        let decoded = decoded.expect("a PNG file").into_rgba8();
        let size = [decoded.width() as usize, decoded.height() as usize];
        Self::from_bytes(size, &decoded)
    }

    pub fn at(&self, x: usize, y: usize) -> [u8; 4] {
        self.pixels[y * self.width + x]
    }

    pub fn center(&self) -> [u8; 4] {
        self.at(self.width / 2, self.height / 2)
    }

    /// Each pixel with its column and row.
    pub fn iter(&self) -> impl Iterator<Item = (usize, usize, [u8; 4])> {
        let width = self.width;
        let place = move |(i, &pixel)| (i % width, i / width, pixel);
        self.pixels.iter().enumerate().map(place)
    }

    /// Largest difference of a channel between two pictures of the same size.
    pub fn worst_difference(&self, other: &Self) -> u8 {
        assert_eq!((self.width, self.height), (other.width, other.height));
        let pairs = self.pixels.as_flattened().iter();
        let pairs = pairs.zip(other.pixels.as_flattened());
        pairs.map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)
    }

    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    pub fn write(&self, path: &Path) {
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).expect("a folder to write to");
        }
        let (width, height) = (self.width as u32, self.height as u32);
        let (bytes, format) = (self.pixels.as_flattened(), image::ColorType::Rgba8);
        image::save_buffer(path, bytes, width, height, format).expect("a picture written");
    }
}

/// A picture and what its reply says beside it.
pub struct Drawn {
    pub image: Image,
    pub frame: Value,
}

/// What `frame.render` makes of a request.
pub fn draw(service: &Arc<Service>, request: &Value) -> Drawn {
    let mut request = request.clone();
    request["image"] = json!("rgba8");
    request["transport"] = json!("attach");
    let (frame, attached) = ask_attached(service, "frame.render", &request);
    let size = ["width", "height"].map(|side| frame[side].as_u64().expect("a side") as usize);
    let image = Image::from_bytes(size, attached_bytes(&frame["images"]["color"], &attached));
    Drawn { image, frame }
}

impl Drawn {
    fn matrix(&self, name: &str) -> [f64; 16] {
        let entries = self.frame["camera"][name].as_array().expect("a matrix");
        let numbers: Vec<f64> = entries.iter().filter_map(Value::as_f64).collect();
        numbers.try_into().expect("16 numbers")
    }

    /// Of the intrinsics: `fx`, `fy`, `cx` or `cy`.
    pub fn intrinsic(&self, name: &str) -> f64 {
        self.frame["camera"][name].as_f64().expect("a number")
    }

    /// Where a point falls, in pixels, by `clip_from_world`.
    pub fn pixel_by_clip(&self, point: Vector) -> [f64; 2] {
        let [x, y, _, w] = times(&self.matrix("clip_from_world"), point, 1.0);
        let [width, height] = [self.image.width, self.image.height].map(|side| side as f64);
        [(x / w + 1.0) / 2.0 * width, (1.0 - y / w) / 2.0 * height]
    }

    /// A point in the camera's own space: +X right, +Y up, −Z ahead.
    pub fn in_camera(&self, point: Vector) -> Vector {
        let world_from_camera = self.matrix("world_from_camera");
        let eye = [12, 13, 14].map(|i| world_from_camera[i]);
        // The inverse of a rotation is its transpose.
        [0, 1, 2].map(|column| {
            (0..3)
                .map(|row| world_from_camera[4 * column + row] * (point[row] - eye[row]))
                .sum()
        })
    }

    /// Where a point falls by the intrinsics; `is_orthographic` leaves distance out of it.
    pub fn pixel_by_intrinsics(&self, point: Vector, is_orthographic: bool) -> [f64; 2] {
        let [x, y, z] = self.in_camera(point);
        let depth = if is_orthographic { 1.0 } else { -z };
        [
            self.intrinsic("fx") * x / depth + self.intrinsic("cx"),
            -self.intrinsic("fy") * y / depth + self.intrinsic("cy"),
        ]
    }
}

/// A column-major matrix times a column vector.
pub fn times(matrix: &[f64; 16], [x, y, z]: Vector, w: f64) -> [f64; 4] {
    [0, 1, 2, 3].map(|row| {
        matrix[row] * x + matrix[4 + row] * y + matrix[8 + row] * z + matrix[12 + row] * w
    })
}

/// IEC 61966-2-1, from 0..1 to 0..255, not rounded.
pub fn encoded(linear: f64) -> f64 {
    let linear = linear.clamp(0.0, 1.0);
    let curved = if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    };
    255.0 * curved
}

/// The other way.
pub fn linear(byte: u8) -> f64 {
    let encoded = f64::from(byte) / 255.0;
    if encoded <= 0.040_45 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

/// How a picture may differ from another.
#[derive(Debug, Clone, Copy)]
pub struct Tolerance {
    /// Channels that differ by no more than this are the same.
    pub channel: u8,
    /// Share of all channels that may differ by more.
    pub share: f64,
    /// What no channel may exceed.
    pub most: u8,
}

/// Why a picture is not the other.
#[derive(Debug, Clone, PartialEq)]
pub enum Mismatch {
    Size {
        wanted: [usize; 2],
        found: [usize; 2],
    },
    Channels {
        differing: usize,
        allowed: usize,
        /// Column, row, wanted and found color of the worst pixel.
        worst: (usize, usize, [u8; 4], [u8; 4]),
    },
}

pub fn matches(wanted: &Image, found: &Image, tolerance: Tolerance) -> Result<(), Mismatch> {
    if wanted.size() != found.size() {
        return Err(Mismatch::Size {
            wanted: wanted.size(),
            found: found.size(),
        });
    }
    let off = |a: [u8; 4], b: [u8; 4]| [0, 1, 2, 3].map(|i| a[i].abs_diff(b[i]));
    let most = |a: [u8; 4], b: [u8; 4]| off(a, b).into_iter().max().unwrap_or(0);
    let mut worst = (0, 0, wanted.at(0, 0), found.at(0, 0));
    let mut differing = 0;
    for (x, y, pixel) in found.iter() {
        let other = wanted.at(x, y);
        let channels = off(other, pixel).into_iter();
        differing += channels.filter(|off| *off > tolerance.channel).count();
        if most(other, pixel) > most(worst.2, worst.3) {
            worst = (x, y, other, pixel);
        }
    }
    let allowed = (tolerance.share * (4 * found.pixels.len()) as f64) as usize;
    if differing > allowed || most(worst.2, worst.3) > tolerance.most {
        return Err(Mismatch::Channels {
            differing,
            allowed,
            worst,
        });
    }
    Ok(())
}

/// Four times as strong as it is, so that it can be seen.
pub fn difference(a: &Image, b: &Image) -> Image {
    let channel = |a: u8, b: u8| a.abs_diff(b).saturating_mul(4);
    let pixel = |(a, b): (&[u8; 4], &[u8; 4])| {
        let alpha = channel(a[3], b[3]);
        [0, 1, 2]
            .map(|i| channel(a[i], b[i]).max(alpha))
            .into_iter()
            .chain([255])
            .collect::<Vec<u8>>()
    };
    let bytes: Vec<u8> = a.pixels.iter().zip(&b.pixels).flat_map(pixel).collect();
    Image::from_bytes([a.width, a.height], &bytes)
}
