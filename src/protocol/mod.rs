//! What goes over the wire: requests, replies, parameters, results, errors, and the document that describes them.
//! Never lives here: sockets, and anything that answers a request.
//!
//! - [`Request`] and [`Reply`]: one line each; [`Id`] pairs them.
//! - [`params`](fn@params): the parameters of a request as a type, every fault with the path of the field.
//! - [`rig`], [`pose`], [`frame`], [`mesh`], [`batch`], [`server`]: parameters and results by family of methods.
//! - [`Blob`] and [`Attachments`]: pictures and arrays, in either direction.
//! - [`Fault`] and [`ErrorObject`]: what can go wrong; [`FieldPath`]: in which field.
//! - [`Method`]: every method; [`openrpc`](fn@openrpc) describes them all.

pub mod attach;
pub mod batch;
pub mod blob;
mod blob_wire;
pub mod camera;
pub mod envelope;
pub mod error;
mod field;
pub mod frame;
pub mod id;
pub mod lines;
pub mod mesh;
mod methods;
mod openrpc;
mod parse;
pub mod pick;
pub mod pose;
pub mod rig;
pub mod server;
mod strict;

pub use attach::{Attach, Attachments};
pub use blob::{Blob, BlobError};
pub use envelope::{BadRequest, Request};
pub use error::{ErrorKind, ErrorObject, Fault, InvalidRigFile, MissingRig};
pub use field::{FieldFault, FieldPath, Segment, shortened};
pub use id::Id;
pub use lines::{Incoming, Notification, Outgoing, Reply};
pub use methods::Method;
pub use openrpc::openrpc;
pub use parse::params;

/// The version of the contract, as `server.info` states it. It changes when something is renamed or removed, not when something is added.
pub const PROTOCOL_VERSION: u32 = 1;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// No parameters.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NoParams {}

/// Done; there is nothing to say about it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Done {}
