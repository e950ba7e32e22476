//! What the rooms' errors are called on the wire: one exhaustive match.

use super::names::LISTED;
use crate::engine::EngineError;
use crate::formats::LoadError;
use crate::limits::LimitExceeded;
use crate::protocol::{Fault, InvalidRigFile, MissingRig, nearest};
use crate::scene::SceneError;

impl From<EngineError> for Fault {
    fn from(error: EngineError) -> Self {
        match error {
            EngineError::RigNotLoaded { rig, mut loaded } => {
                let names = loaded.iter().map(String::as_str);
                let nearest = nearest(&rig, names).map(str::to_owned);
                loaded.truncate(LISTED);
                Self::RigNotLoaded(Box::new(MissingRig {
                    rig,
                    nearest,
                    loaded,
                }))
            }
            EngineError::RigNameTaken { rig } => Self::RigNameTaken { rig },
            EngineError::Load(error) => error.into(),
            EngineError::Limit(exceeded) => exceeded.into(),
            // The caller knows the renderer's pace and says it better.
            EngineError::Busy { queue_depth } => Self::Busy {
                retry_after_ms: 100,
                queue_depth,
            },
            EngineError::OutsideLimits(error) => Self::invalid_params("pose", error.to_string()),
            EngineError::PoseOutOfRange(error) => Self::invalid_params("pose", error.to_string()),
            EngineError::Scene(SceneError {
                field,
                expected,
                found,
            }) => Self::invalid_params(field, format!("expected {expected}, but found {found}")),
            EngineError::NoSuchPart { field, problem } => Self::invalid_params(field, problem),
            EngineError::DeviceLost { .. } => Self::DeviceLost,
            EngineError::Adapter(error) => Self::Internal {
                message: error.to_string(),
            },
            EngineError::DeadlineExceeded => Self::DeadlineExceeded,
            EngineError::Cancelled => Self::Cancelled,
            EngineError::ShuttingDown => Self::ShuttingDown,
            EngineError::Internal { reason } => Self::Internal { message: reason },
        }
    }
}

impl From<LimitExceeded> for Fault {
    fn from(
        LimitExceeded {
            limit,
            maximum,
            asked,
        }: LimitExceeded,
    ) -> Self {
        Self::LimitExceeded {
            limit: limit.to_owned(),
            maximum,
            asked,
        }
    }
}

impl From<LoadError> for Fault {
    fn from(error: LoadError) -> Self {
        let message = error.to_string();
        match error {
            LoadError::NoFiles | LoadError::SameName { .. } | LoadError::TwoSkeletons { .. } => {
                Self::invalid_params("files", message)
            }
            LoadError::FileNotFound { file } => Self::FileNotFound { file },
            LoadError::PathNotAllowed { file, reason } => Self::PathNotAllowed {
                file,
                reason: reason.to_owned(),
            },
            LoadError::Invalid(fault) => Self::RigFileInvalid(Box::new(InvalidRigFile {
                message,
                file: fault.file,
                line: Some(fault.line as u64),
                column: Some(fault.column as u64),
                expected: Some(fault.expected),
                found: Some(fault.found),
            })),
            LoadError::Limit(exceeded) => exceeded.into(),
            LoadError::Io { file, .. } => {
                let expected = Some("a file that can be read".to_owned());
                Self::RigFileInvalid(Box::new(InvalidRigFile {
                    message,
                    file,
                    expected,
                    ..InvalidRigFile::default()
                }))
            }
        }
    }
}

/// A fault of one light says which.
pub(super) fn of_light(index: usize, error: SceneError) -> Fault {
    let field = error.field.strip_prefix("lights").unwrap_or(error.field);
    let message = format!("expected {}, but found {}", error.expected, error.found);
    Fault::invalid_params(format!("lights[{index}]{field}"), message)
}
