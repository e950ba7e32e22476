//! From frames to files. Never on the renderer's thread, and it never asks what a frame shows.

#[cfg(feature = "cli")]
mod animation;
#[cfg(feature = "cli")]
mod apng;
#[cfg(feature = "cli")]
mod gif;
#[cfg(feature = "cli")]
mod palette;
mod png;

pub use self::png::{Compression, png};
#[cfg(feature = "cli")]
pub use self::{
    animation::{AnimationError, FrameRate},
    apng::AnimatedPng,
    gif::AnimatedGif,
};
