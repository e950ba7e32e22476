//! Fronts: how requests and responses travel. Knows no method. Never lives here: what a request means.
//!
//! A front turns its own framing into requests of the service and its messages into bytes. There is one, `lines`. Another is a sibling
//! of it: `shutdown` and `envelope` know of no framing.

mod envelope;
mod lines;
mod shutdown;

pub use lines::{Server, Stopper};
pub use shutdown::Timeouts;
