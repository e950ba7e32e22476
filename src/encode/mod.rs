//! From frames to files. Never on the renderer's thread, and it never asks what a frame shows.

mod animation;
mod apng;
mod gif;
mod palette;
mod png;

pub use self::animation::{AnimationError, FrameRate};
pub use self::apng::AnimatedPng;
pub use self::gif::AnimatedGif;
pub use self::png::{Compression, png};
