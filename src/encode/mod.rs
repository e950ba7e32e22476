//! From frames to files, and the threads that do it. Never on the renderer's thread, and it never asks what a frame shows.

mod animation;
mod apng;
mod gif;
mod palette;
mod png;
mod pool;

pub use self::animation::{AnimationError, FrameRate};
pub use self::apng::AnimatedPng;
pub use self::gif::AnimatedGif;
pub use self::png::{Compression, png};
pub use self::pool::Pool;
