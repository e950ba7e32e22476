//! What the service says to a connection, in no framing yet. Never lives here: whom it is said to, and when.

use crate::protocol::{Attachments, Fault, Id};
use bytes::Bytes;
use serde::Serialize;
use std::fmt;

/// What a request comes to.
#[derive(Debug)]
pub struct Response {
    pub id: Id,
    /// The result as JSON, or why there is none.
    pub outcome: Result<String, Fault>,
    /// Raw bytes that the result refers to. Its offsets count from the first byte of the first of them.
    pub attachments: Vec<Bytes>,
    pub permit: Option<Permit>,
}

/// What goes ahead of a response: one item of a streamed batch.
#[derive(Debug)]
pub struct Notification {
    pub method: &'static str,
    /// As JSON.
    pub params: String,
    /// As those of a [`Response`].
    pub attachments: Vec<Bytes>,
    pub permit: Option<Permit>,
}

/// What comes of a request: any number of notifications, then its response.
#[derive(Debug)]
pub enum Message {
    Notification(Notification),
    Response(Response),
}

/// Memory that a message takes, given back on drop: to be kept until the message is written.
pub struct Permit(#[expect(dead_code, reason = "held to be dropped")] Box<dyn Send>);

impl Permit {
    pub(super) fn new(held: impl Send + 'static) -> Self {
        Self(Box::new(held))
    }
}

impl fmt::Debug for Permit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Permit")
    }
}

/// A result, ready to be sent.
pub(super) struct Payload {
    pub json: String,
    pub attachments: Vec<Bytes>,
    pub permit: Option<Permit>,
}

impl Payload {
    /// # Errors
    /// Where the result cannot be JSON: a map with keys that are no strings.
    pub(super) fn new<R: Serialize>(
        result: &R,
        attachments: Attachments,
        permit: Option<Permit>,
    ) -> Result<Self, Fault> {
        let json = serde_json::to_string(result).map_err(|error| Fault::Internal {
            message: error.to_string(),
        })?;
        Ok(Self {
            json,
            attachments: attachments.into_parts(),
            permit,
        })
    }
}
