//! What can go wrong: [`Fault`] with its facts, and the [`ErrorObject`] a client gets for it.
//! Never lives here: the errors of the rooms that do the work; the service turns those into faults.

use super::field::{FieldFault, FieldPath, shortened};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

/// A request that gets an error instead of a result. `Display` is the message for people.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Fault {
    /// The line is not JSON.
    #[error("{message}")]
    ParseError {
        /// What is wrong with it, and at which byte or column of the line.
        message: String,
    },
    /// The line is JSON and not a request.
    #[error("{message}")]
    InvalidRequest {
        /// What was expected, and what the line is instead.
        message: String,
    },
    /// A member of the line beside its parameters is not what a request has there.
    #[error(transparent)]
    InvalidMember(FieldFault),
    /// `nearest` is the method that may have been meant.
    #[error("there is no method `{method}`{}", did_you_mean(.nearest.as_deref()))]
    MethodNotFound {
        /// As the request spells it.
        method: String,
        /// `None` where no method has a similar name.
        nearest: Option<String>,
    },
    /// A parameter is missing, unknown, or has a value that cannot be worked with.
    #[error(transparent)]
    InvalidParams(#[from] FieldFault),
    /// The server's own mistake.
    #[error("{message}")]
    Internal {
        /// What went wrong inside; no request is to blame.
        message: String,
    },
    /// Boxed, since a fault travels in the error of every result.
    #[error("rig `{}` is not loaded{}", shortened(&.0.rig), did_you_mean(.0.nearest.as_deref()))]
    RigNotLoaded(Box<MissingRig>),
    /// Boxed as well.
    #[error("{}", .0.message)]
    RigFileInvalid(Box<InvalidRigFile>),
    /// `rig.load` was given other files than those loaded under that name, without `replace`.
    #[error("another rig is loaded as `{rig}`; `\"replace\": true` puts this one in its place")]
    RigNameTaken {
        /// The name that was to be given.
        rig: String,
    },
    /// The request comes to more than one of the ceilings that `server.info` lists; raised before anything of that size is allocated.
    #[error("{asked} exceeds the limit `{limit}` of {maximum}")]
    LimitExceeded {
        /// Name of the ceiling in `limits` of `server.info`.
        limit: String,
        /// The ceiling, in the unit that its name tells.
        maximum: u64,
        /// How much the request came to, in the same unit; `u64::MAX` where it is more than 64 bits hold.
        asked: u64,
    },
    /// The connection should have sent a token first; no server of this version asks for one.
    #[error("authentication required: this connection has not sent the right token")]
    Unauthorized,
    /// Too many requests of all connections wait, or their results take up too much memory.
    #[error("the server has more work than it takes on; ask again in {retry_after_ms} ms")]
    Busy {
        /// Milliseconds after which there may be room, an estimate.
        retry_after_ms: u64,
        /// Requests of all connections that are admitted and not answered yet.
        queue_depth: u64,
    },
    /// The device failed, or its driver reset it, while the request was in hand.
    #[error("the graphics device was lost and is being opened again")]
    DeviceLost,
    /// The request was not done `deadline_ms` after its arrival.
    #[error("the deadline of the request has passed")]
    DeadlineExceeded,
    /// The request came, or was still waiting, while the server stops.
    #[error("the server is shutting down")]
    ShuttingDown,
    /// A path of `rig.load` leads to no file.
    #[error("there is no file `{file}` below the server's root")]
    FileNotFound {
        /// The path, as the request spells it.
        file: String,
    },
    /// A file of `rig.load` has a path or name that the server does not open, e.g. a path out of its root.
    #[error("`{file}` may not be opened: {reason}")]
    PathNotAllowed {
        /// The path or name, as the request spells it; shortened where it is too long.
        file: String,
        /// Which rule it breaks, as the end of a sentence.
        reason: String,
    },
    /// A `request.cancel` named the request, or its connection ended.
    #[error("the request was cancelled")]
    Cancelled,
    /// Any fault but that of a parameter, and which of many parts of the request it is of: `path` leads there, e.g. `frames[3]`.
    #[error("{path}: {fault}")]
    Within {
        /// From the parameters of the request to the part.
        path: FieldPath,
        /// The fault that the part has by itself.
        fault: Box<Fault>,
    },
}

/// A rig that a request names and nobody has loaded.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct MissingRig {
    /// The name or digest, as the request spells it.
    pub rig: String,
    /// The one that may have been meant.
    pub nearest: Option<String>,
    /// A few of those there are.
    pub loaded: Vec<String>,
}

/// A file of a rig that cannot be read. `message` is the reader's sentence, with file and place; the other fields say the same to programs,
/// as far as it is known.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct InvalidRigFile {
    /// For people, ready to be shown.
    pub message: String,
    /// The path or name of the file, as the request or the file that names it spells it.
    pub file: String,
    /// From 1.
    pub line: Option<u64>,
    /// From 1.
    pub column: Option<u64>,
    /// What should stand there, in words.
    pub expected: Option<String>,
    /// What stands there instead, in words.
    pub found: Option<String>,
}

impl Fault {
    /// A field that cannot be worked with, found after the parameters were parsed.
    pub fn invalid_params(path: impl Into<FieldPath>, message: impl Into<String>) -> Self {
        Self::InvalidParams(FieldFault::new(path, message))
    }

    /// That of the part of the request that `path` leads to: a parameter at fault is one of that part.
    #[must_use]
    pub fn within(self, path: impl Into<FieldPath>) -> Self {
        match self {
            Self::InvalidParams(fault) => Self::InvalidParams(fault.within(path)),
            other => Self::Within {
                path: path.into(),
                fault: Box::new(other),
            },
        }
    }

    /// What the wire says as `data.kind`; [`Fault::Within`] has that of the fault in it.
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::Within { fault, .. } => fault.kind(),
            Self::ParseError { .. } => ErrorKind::ParseError,
            Self::InvalidRequest { .. } | Self::InvalidMember(_) => ErrorKind::InvalidRequest,
            Self::MethodNotFound { .. } => ErrorKind::MethodNotFound,
            Self::InvalidParams(_) => ErrorKind::InvalidParams,
            Self::Internal { .. } => ErrorKind::Internal,
            Self::RigNotLoaded(_) => ErrorKind::RigNotLoaded,
            Self::RigFileInvalid(_) => ErrorKind::RigFileInvalid,
            Self::RigNameTaken { .. } => ErrorKind::RigNameTaken,
            Self::LimitExceeded { .. } => ErrorKind::LimitExceeded,
            Self::Unauthorized => ErrorKind::Unauthorized,
            Self::Busy { .. } => ErrorKind::Busy,
            Self::DeviceLost => ErrorKind::DeviceLost,
            Self::DeadlineExceeded => ErrorKind::DeadlineExceeded,
            Self::ShuttingDown => ErrorKind::ShuttingDown,
            Self::FileNotFound { .. } => ErrorKind::FileNotFound,
            Self::PathNotAllowed { .. } => ErrorKind::PathNotAllowed,
            Self::Cancelled => ErrorKind::Cancelled,
        }
    }

    /// The members of `data` beside `kind` and `retryable`. What is not known is left out.
    fn details(self) -> Map<String, Value> {
        let details = match self {
            Self::Within { path, fault } => {
                let mut members = fault.details();
                members.insert("path".to_owned(), path.to_string().into());
                return members;
            }
            Self::ParseError { .. }
            | Self::InvalidRequest { .. }
            | Self::Internal { .. }
            | Self::Unauthorized
            | Self::DeviceLost
            | Self::DeadlineExceeded
            | Self::ShuttingDown
            | Self::Cancelled => json!({}),
            Self::MethodNotFound { nearest, .. } => json!({ "path": "method", "nearest": nearest }),
            Self::InvalidMember(fault) | Self::InvalidParams(fault) => {
                json!({ "path": fault.path.to_string() })
            }
            Self::RigNotLoaded(missing) => json!({
                "rig": missing.rig,
                "nearest": missing.nearest,
                "loaded": missing.loaded,
            }),
            Self::RigNameTaken { rig } => json!({ "rig": rig }),
            Self::RigFileInvalid(invalid) => json!({
                "file": invalid.file,
                "line": invalid.line,
                "column": invalid.column,
                "expected": invalid.expected,
                "found": invalid.found,
            }),
            Self::LimitExceeded {
                limit,
                maximum,
                asked,
            } => json!({ "limit": limit, "maximum": maximum, "asked": asked }),
            Self::Busy {
                retry_after_ms,
                queue_depth,
            } => json!({ "retry_after_ms": retry_after_ms, "queue_depth": queue_depth }),
            Self::FileNotFound { file } | Self::PathNotAllowed { file, .. } => {
                json!({ "file": file })
            }
        };
        match details {
            Value::Object(members) => members.into_iter().filter(|m| !m.1.is_null()).collect(),
            _ => Map::new(),
        }
    }
}

fn did_you_mean(nearest: Option<&str>) -> String {
    nearest.map_or_else(String::new, |name| format!("; did you mean `{name}`?"))
}

macro_rules! kinds {
    ($($(#[doc = $doc:literal])* $variant:ident $name:literal $code:literal $retryable:literal,)*) => {
        /// What went wrong, in one word. Clients branch on this and not on the code, since two kinds may share one.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum ErrorKind { $($(#[doc = $doc])* $variant,)* }

        impl ErrorKind {
            /// In the order of declaration.
            pub const ALL: &[Self] = &[$(Self::$variant,)*];

            /// As the wire spells it.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }

            /// The `code` of the error by JSON-RPC's rules; two kinds may share one.
            pub fn code(self) -> i64 {
                match self { $(Self::$variant => $code,)* }
            }

            /// Whether the same request may well succeed later.
            pub fn retryable(self) -> bool {
                match self { $(Self::$variant => $retryable,)* }
            }

            /// What it means, and which members `data` has for it.
            pub fn summary(self) -> &'static str {
                match self { $(Self::$variant => concat!($($doc),*).trim_start(),)* }
            }
        }
    };
}

kinds! {
    /// The line is not JSON in UTF-8.
    ParseError "parse_error" -32700 false,
    /// The line is JSON and not a request. `path` names the member at fault.
    InvalidRequest "invalid_request" -32600 false,
    /// There is no such method. `nearest` is the one that may have been meant.
    MethodNotFound "method_not_found" -32601 false,
    /// A parameter is missing, unknown, or not what was expected. `path` leads to it.
    InvalidParams "invalid_params" -32602 false,
    /// The server made a mistake of its own.
    Internal "internal" -32603 false,
    /// No rig of that name or digest is loaded: load `rig`, then ask again. `nearest` is the one that may have been meant, `loaded` a few of those there are.
    RigNotLoaded "rig_not_loaded" -32000 true,
    /// A rig's file is wrong at `file`, `line`, `column`: `expected` and `found` say how.
    RigFileInvalid "rig_file_invalid" -32001 false,
    /// Another rig is loaded under the name `rig`, and `replace` was not given.
    RigNameTaken "rig_name_taken" -32002 false,
    /// The request `asked` for more than the `maximum` of one `limit` of those that `server.info` lists.
    LimitExceeded "limit_exceeded" -32003 false,
    /// The connection has not sent the right token.
    Unauthorized "unauthorized" -32004 false,
    /// The server as a whole has too much to do, or its results take up too much memory: `queue_depth` requests are in flight. Ask again after `retry_after_ms`.
    Busy "busy" -32005 true,
    /// The graphics device went away while the request was in hand; it is being opened again.
    DeviceLost "device_lost" -32006 true,
    /// The request's own `deadline_ms` went by.
    DeadlineExceeded "deadline_exceeded" -32007 true,
    /// The server is about to stop.
    ShuttingDown "shutting_down" -32008 true,
    /// The request names a `file` that is not there.
    FileNotFound "file_not_found" -32009 false,
    /// The request names a `file` outside the folder that the server reads from.
    PathNotAllowed "path_not_allowed" -32009 false,
    /// `request.cancel` named this request.
    Cancelled "cancelled" -32010 false,
}

impl ErrorKind {
    /// The kind that the wire spells so; `None` for a word that this version does not know.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|kind| kind.name() == name)
    }
}

/// The `error` of a reply.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, thiserror::Error)]
#[error("{message} ({})", .data.kind)]
pub struct ErrorObject {
    /// A number by JSON-RPC's rules. Several kinds may share one.
    pub code: i64,
    /// A sentence for people: where, what was expected, what was found.
    pub message: String,
    /// The same for programs: its `kind`, and what else is known of this kind.
    pub data: ErrorData,
}

/// What a program can know about an error.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ErrorData {
    /// What went wrong, in one word. A server newer than its client may send one that the client has never heard of.
    pub kind: String,
    /// Whether the same request may well succeed later.
    pub retryable: bool,
    /// More about this kind, e.g. `path` or `retry_after_ms`.
    #[serde(flatten)]
    pub details: Map<String, Value>,
}

impl ErrorObject {
    /// `None` for a kind that this version does not know.
    pub fn kind(&self) -> Option<ErrorKind> {
        ErrorKind::named(&self.data.kind)
    }

    /// The member of `data` of that name.
    pub fn detail(&self, name: &str) -> Option<&Value> {
        self.data.details.get(name)
    }
}

impl From<Fault> for ErrorObject {
    fn from(fault: Fault) -> Self {
        let kind = fault.kind();
        Self {
            code: kind.code(),
            message: fault.to_string(),
            data: ErrorData {
                kind: kind.name().to_owned(),
                retryable: kind.retryable(),
                details: fault.details(),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_and_kinds_are_those_of_the_contract() {
        let table = [
            (-32700, "parse_error", false),
            (-32600, "invalid_request", false),
            (-32601, "method_not_found", false),
            (-32602, "invalid_params", false),
            (-32603, "internal", false),
            (-32000, "rig_not_loaded", true),
            (-32001, "rig_file_invalid", false),
            (-32002, "rig_name_taken", false),
            (-32003, "limit_exceeded", false),
            (-32004, "unauthorized", false),
            (-32005, "busy", true),
            (-32006, "device_lost", true),
            (-32007, "deadline_exceeded", true),
            (-32008, "shutting_down", true),
            (-32009, "file_not_found", false),
            (-32009, "path_not_allowed", false),
            (-32010, "cancelled", false),
        ];
        let kinds: Vec<_> = ErrorKind::ALL
            .iter()
            .map(|kind| (kind.code(), kind.name(), kind.retryable()))
            .collect();
        assert_eq!(kinds, table);
        for (_, name, _) in table {
            assert_eq!(ErrorKind::named(name).map(ErrorKind::name), Some(name));
        }
    }

    #[test]
    fn data_adds_what_the_contract_says() {
        let text = String::from;
        let invalid = InvalidRigFile {
            message: text("wasp.skel:41:9: expected a number, but found `abc`"),
            file: text("wasp.skel"),
            line: Some(41),
            column: Some(9),
            expected: Some(text("a number")),
            found: Some(text("abc")),
        };
        let nowhere = InvalidRigFile {
            file: text("wasp.skel"),
            ..InvalidRigFile::default()
        };
        let cases = [
            (
                Fault::invalid_params(["camera", "fov_y"], "expected a number"),
                json!({"path": "camera.fov_y"}),
            ),
            (
                Fault::RigNotLoaded(Box::new(MissingRig {
                    rig: text("wsap"),
                    nearest: Some(text("wasp")),
                    loaded: vec![text("fly"), text("wasp")],
                })),
                json!({"rig": "wsap", "nearest": "wasp", "loaded": ["fly", "wasp"]}),
            ),
            (
                Fault::RigFileInvalid(Box::new(invalid)),
                json!({"file": "wasp.skel", "line": 41, "column": 9, "expected": "a number", "found": "abc"}),
            ),
            (
                Fault::RigFileInvalid(Box::new(nowhere)),
                json!({"file": "wasp.skel"}),
            ),
            (Fault::RigNameTaken { rig: text("a") }, json!({"rig": "a"})),
            (
                Fault::LimitExceeded {
                    limit: text("pixels"),
                    maximum: 1,
                    asked: 2,
                },
                json!({"limit": "pixels", "maximum": 1, "asked": 2}),
            ),
            (
                Fault::Busy {
                    retry_after_ms: 50,
                    queue_depth: 0,
                },
                json!({"retry_after_ms": 50, "queue_depth": 0}),
            ),
            (Fault::DeviceLost, json!({})),
            (
                Fault::RigNotLoaded(Box::default()).within(("frames", 3)),
                json!({"rig": "", "loaded": [], "path": "frames[3]"}),
            ),
            (
                Fault::invalid_params("size", "expected two").within(("frames", 3)),
                json!({"path": "frames[3].size"}),
            ),
            (
                Fault::FileNotFound { file: text("f") },
                json!({"file": "f"}),
            ),
            (
                Fault::PathNotAllowed {
                    file: text("f"),
                    reason: text("r"),
                },
                json!({"file": "f"}),
            ),
        ];
        for (fault, details) in cases {
            let kind = fault.kind();
            let message = fault.to_string();
            let error = ErrorObject::from(fault);
            let mut data = details;
            data["kind"] = kind.name().into();
            data["retryable"] = kind.retryable().into();
            let expected = json!({ "code": kind.code(), "message": message, "data": data });
            let written = json!(error);
            assert_eq!(written, expected);
            let read: ErrorObject = serde_json::from_value(written).unwrap();
            assert_eq!((read.kind(), &read), (Some(kind), &error));
        }
    }
}
