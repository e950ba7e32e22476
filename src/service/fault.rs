//! What the rooms' errors are called on the wire: one exhaustive match.

use super::names::LISTED;
use crate::engine::EngineError;
use crate::formats::LoadError;
use crate::limits::LimitExceeded;
use crate::protocol::{Fault, FieldFault, FieldPath, InvalidRigFile, MissingRig};
use crate::scene::{CameraError, CameraField, InvalidValue, LightError, LightField, SizeError};
use crate::spelling::nearest;

impl From<EngineError> for Fault {
    fn from(error: EngineError) -> Self {
        match error {
            EngineError::RigNotLoaded { rig, loaded } => {
                let names = loaded.iter().map(|name| &**name);
                Self::RigNotLoaded(Box::new(MissingRig {
                    nearest: nearest(&rig, names.clone()).map(str::to_owned),
                    loaded: names.take(LISTED).map(str::to_owned).collect(),
                    rig,
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
            EngineError::Pose(error) => Self::invalid_params("pose", error.to_string()),
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

impl From<InvalidValue> for FieldFault {
    /// Of the value itself: whoever gave it knows its path.
    fn from(error: InvalidValue) -> Self {
        Self::new(FieldPath::default(), error.to_string())
    }
}

/// The fault of a value that the request has at `path`.
pub(super) fn at(path: impl Into<FieldPath>) -> impl FnOnce(InvalidValue) -> FieldFault {
    move |error| FieldFault::from(error).within(path)
}

/// The fault of a `size`.
pub(super) fn of_size(error: SizeError) -> Fault {
    match error {
        SizeError::Value(error) => at("size")(error).into(),
        SizeError::Limit(exceeded) => exceeded.into(),
    }
}

impl From<CameraError> for FieldFault {
    /// As seen from the camera.
    fn from(CameraError { field, problem }: CameraError) -> Self {
        at(match field {
            CameraField::Position => FieldPath::default(),
            CameraField::Distance => "distance".into(),
            CameraField::Eye => "eye".into(),
            CameraField::Up => "up".into(),
            CameraField::FovY => "fov_y".into(),
            CameraField::Height => "height".into(),
            CameraField::Near => "near".into(),
            CameraField::Fx => "fx".into(),
            CameraField::Fy => "fy".into(),
            CameraField::Cx => "cx".into(),
            CameraField::Cy => "cy".into(),
            CameraField::WorldFromCamera => "world_from_camera".into(),
        })(problem)
    }
}

impl From<LightError> for FieldFault {
    /// As seen from the light.
    fn from(LightError { field, problem }: LightError) -> Self {
        at(match field {
            LightField::Direction => "direction",
            LightField::Position => "position",
            LightField::Intensity => "intensity",
        })(problem)
    }
}
