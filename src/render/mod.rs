//! From a [`Plan`] to [`Outputs`]. `gpu` and `cpu` are twins that never name each other.
//! Never lives here: sockets, files, encoders.

pub mod cpu;
pub mod gpu;
mod outputs;
mod plan;
mod skeleton;
mod solids;

pub use outputs::{Outputs, RenderError};
pub use plan::{Instance, Picture, Plan, Wanted};
pub use skeleton::{Segment, SkeletonView};
pub use solids::{SolidVertex, Solids};
