//! From a [`Plan`] to [`Outputs`]. `gpu` and `cpu` are twins that never name each other.
//! Never lives here: sockets, files, encoders.

mod adapter;
mod coat;
pub mod cpu;
mod cull;
pub mod gpu;
mod order;
mod outputs;
mod outward;
mod plan;
mod renderer;
mod skeleton;
mod solids;
mod view;

pub use adapter::{AdapterChoice, AdapterError, AdapterInfo, AdapterKind, Backend, Capabilities};
pub use outputs::{Outputs, RenderError};
pub use outward::turn_outward;
pub use plan::{Instance, Picture, Plan, Wanted};
pub use renderer::{Renderer, adapters};
pub use skeleton::{Segment, SkeletonView};
pub use solids::{SolidVertex, Solids};
