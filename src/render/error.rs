//! Why a renderer gives nothing back. Never lives here: what it gives.

use crate::limits::LimitExceeded;

/// Why a plan has no outputs.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RenderError {
    /// The device went away with the work on it; the same plan may succeed on the next one.
    #[error("the graphics device was lost: {reason}")]
    DeviceLost {
        /// In the words of the driver, as far as it has any.
        reason: String,
    },
    /// The device has too little free memory for this at the moment.
    #[error("the graphics device is out of memory: {reason}")]
    OutOfMemory {
        /// In the words of wgpu.
        reason: String,
    },
    /// Larger than this adapter can do at all.
    #[error(transparent)]
    Limit(#[from] LimitExceeded),
    /// The adapter refused what should be valid.
    #[error("the graphics device refused the work: {reason}")]
    Refused {
        /// In the words of wgpu.
        reason: String,
    },
}
