//! Everything a use-case can fail with.

use crate::adapter::AdapterError;
use crate::formats::LoadError;
use crate::limits::LimitExceeded;
use crate::pose::{OutsideLimits, PoseOutOfRange};
use crate::render::RenderError;
use std::sync::Arc;

#[derive(Debug, thiserror::Error)]
pub enum EngineError {
    /// `loaded` are the names of those that are.
    #[error("no rig named `{rig}` is loaded")]
    RigNotLoaded { rig: String, loaded: Vec<Arc<str>> },
    #[error(
        "a rig named `{rig}` is loaded from other files; say `replace` to put this one in its place"
    )]
    RigNameTaken { rig: String },
    #[error(transparent)]
    Load(#[from] LoadError),
    #[error(transparent)]
    Limit(#[from] LimitExceeded),
    /// The server as a whole has all it can take.
    #[error("{queue_depth} requests are in hand already; try again soon")]
    Busy { queue_depth: u64 },
    #[error(transparent)]
    Pose(#[from] PoseError),
    #[error("the graphics device was lost: {reason}")]
    DeviceLost { reason: String },
    #[error(transparent)]
    Adapter(#[from] AdapterError),
    #[error("the deadline passed before the work was done")]
    DeadlineExceeded,
    #[error("the request was cancelled")]
    Cancelled,
    #[error("the server is shutting down")]
    ShuttingDown,
    #[error("{reason}")]
    Internal { reason: String },
}

/// Why a rig cannot be brought into a pose.
#[derive(Debug, thiserror::Error)]
pub enum PoseError {
    #[error(transparent)]
    OutsideLimits(#[from] OutsideLimits),
    #[error(transparent)]
    OutOfRange(#[from] PoseOutOfRange),
}

impl From<RenderError> for EngineError {
    fn from(error: RenderError) -> Self {
        match error {
            RenderError::DeviceLost { reason } => Self::DeviceLost { reason },
            RenderError::Limit(exceeded) => Self::Limit(exceeded),
            RenderError::OutOfMemory { .. } | RenderError::Refused { .. } => Self::Internal {
                reason: error.to_string(),
            },
        }
    }
}
