//! From a [`Plan`] to [`Outputs`](crate::frame::Outputs). `gpu` and `cpu` draw the same picture and never name each other.
//! Never lives here: sockets, files, encoders.

mod capabilities;
#[cfg(not(feature = "test-support"))]
pub(crate) mod cpu;
#[cfg(feature = "test-support")]
pub mod cpu;
mod cull;
mod error;
#[cfg(test)]
pub(crate) mod fixtures;
#[cfg(not(feature = "test-support"))]
pub(crate) mod gpu;
#[cfg(feature = "test-support")]
pub mod gpu;
mod instance;
mod instance_params;
mod material_params;
mod order;
mod outward;
mod plan;
mod renderer;
mod skeleton;
mod solids;
mod view;

pub use capabilities::Capabilities;
pub use error::RenderError;
pub use instance::{Instance, Skin};
pub use outward::turn_outward;
pub use plan::{ImagePlan, Plan};
pub use renderer::{Renderer, adapters};
use skeleton::{Segment, SkeletonView};
use solids::{SolidVertex, Solids};
