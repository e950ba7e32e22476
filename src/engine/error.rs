//! Everything a use-case can fail with.

use crate::adapter::AdapterError;
use crate::formats::LoadError;
use crate::limits::LimitExceeded;
use crate::pose::{OutsideLimits, PoseOutOfRange};
use crate::render::RenderError;
use std::sync::Arc;

/// Why a request to the engine has no result.
#[derive(Debug, thiserror::Error)]
pub enum EngineError {
    /// Neither the name nor the digest of any loaded rig was given.
    #[error("no rig named `{rig}` is loaded")]
    RigNotLoaded {
        /// As the request named it.
        rig: String,
        /// The names of all loaded rigs, sorted.
        loaded: Vec<Arc<str>>,
    },
    #[error(
        "a rig named `{rig}` is loaded from other files; say `replace` to put this one in its place"
    )]
    /// A load without `replace` gave a name that is taken by a rig of another digest.
    RigNameTaken {
        /// The name, given or from the first file's stem.
        rig: String,
    },
    /// Files could not be read as a rig.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A rig, a picture or an array is larger than the server or its renderer takes.
    #[error(transparent)]
    Limit(#[from] LimitExceeded),
    /// The server as a whole has all it can take.
    #[error(
        "no more requests, or no more memory for results, can be taken on now: {queue_depth} requests are in flight; try again soon"
    )]
    Busy {
        /// Requests of all connections that are admitted at the moment.
        queue_depth: u64,
    },
    /// The rig cannot be brought into the pose that was asked for.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// The device went away with the work on it; the next request opens it anew.
    #[error("the graphics device was lost: {reason}")]
    DeviceLost {
        /// In the words of the driver, as far as it has any.
        reason: String,
    },
    /// No renderer of the kind asked for could be opened.
    #[error(transparent)]
    Adapter(#[from] AdapterError),
    /// [`Cancellation::deadline`](super::Cancellation::deadline) came first.
    #[error("the deadline passed before the work was done")]
    DeadlineExceeded,
    /// [`Cancellation::cancelled`](super::Cancellation::cancelled) was set first.
    #[error("the request was cancelled")]
    Cancelled,
    /// The engine was dropped while the work waited or was under way.
    #[error("the server is shutting down")]
    ShuttingDown,
    /// What no request should bring about: a panic, a refusal of the driver, too little memory of the device, no threads.
    #[error("{reason}")]
    Internal {
        /// What went wrong, as a sentence for whoever runs the server.
        reason: String,
    },
}

/// Why a rig cannot be brought into a pose.
#[derive(Debug, thiserror::Error)]
pub enum PoseError {
    /// A value is past its limits, and the edit said to reject such.
    #[error(transparent)]
    OutsideLimits(#[from] OutsideLimits),
    /// A joint, or what is bound to it, would be further off than numbers reach, or a morph weight be too large.
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
