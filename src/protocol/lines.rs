//! The client's half of the envelope: replies on their way in and requests on their way out.
//! Never lives here: requests on their way in; they come from strangers and have a file of their own.

use super::error::ErrorObject;
use super::id::Id;
use serde::de::Error;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

/// A reply as a client reads it: either a result or an error.
#[derive(Debug, Clone)]
pub struct Reply {
    /// That of the request; null also where the server could not read it.
    pub id: Id,
    /// The text of `result`, or else `error`.
    pub outcome: Result<Box<RawValue>, ErrorObject>,
    /// Raw bytes that follow the line.
    pub attach_bytes: u64,
}

impl Reply {
    /// # Errors
    /// Where the line is no reply.
    pub fn parse(line: &[u8]) -> Result<Self, serde_json::Error> {
        match Incoming::parse(line)? {
            Incoming::Reply(reply) => Ok(reply),
            Incoming::Notification(_) => Err(Error::custom("expected a reply")),
        }
    }
}

/// What goes ahead of a reply, as a client reads it.
#[derive(Debug, Clone)]
pub struct Notification {
    /// `frame.ready` or `mesh.ready`.
    pub method: String,
    /// The text of a JSON object, with the `id` of the batch as its `request`.
    pub params: Box<RawValue>,
    /// Raw bytes that follow the line.
    pub attach_bytes: u64,
}

/// A line from a server.
#[derive(Debug, Clone)]
pub enum Incoming {
    /// A line with an `id` and either a `result` or an `error`.
    Reply(Reply),
    /// A line with a `method` and `params`: an item of a streamed batch.
    Notification(Notification),
}

impl Incoming {
    /// # Errors
    /// Where the line is neither.
    pub fn parse(line: &[u8]) -> Result<Self, serde_json::Error> {
        let Members {
            id,
            result,
            error,
            method,
            params,
            attach_bytes,
        } = serde_json::from_slice(line)?;
        let outcome = match (result, error, method, params) {
            (None, None, Some(method), Some(params)) => {
                return Ok(Self::Notification(Notification {
                    method,
                    params,
                    attach_bytes,
                }));
            }
            (Some(result), None, None, None) => Ok(result),
            (None, Some(error), None, None) => Err(error),
            _ => {
                return Err(Error::custom("expected either a `result` or an `error`"));
            }
        };
        Ok(Self::Reply(Reply {
            id: id.ok_or_else(|| Error::missing_field("id"))?,
            outcome,
            attach_bytes,
        }))
    }
}

#[derive(Deserialize)]
struct Members {
    /// Of a reply: present, if only as null.
    #[serde(default, deserialize_with = "present")]
    id: Option<Id>,
    result: Option<Box<RawValue>>,
    error: Option<ErrorObject>,
    method: Option<String>,
    params: Option<Box<RawValue>>,
    #[serde(default)]
    attach_bytes: u64,
}

fn present<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Option<Id>, D::Error> {
    Id::deserialize(deserializer).map(Some)
}

/// A request as a client writes it. Without an `id` it is a notification.
#[derive(Debug, Clone, Copy)]
pub struct Outgoing<'a, P: ?Sized> {
    /// `None` for a notification, which is never answered.
    pub id: Option<&'a Id>,
    /// As the wire spells it, e.g. `frame.render`.
    pub method: &'a str,
    /// What the server is to read as a JSON object; it refuses anything else.
    pub params: &'a P,
    /// Milliseconds from the request's arrival, past which it is answered with `deadline_exceeded`. `None` for no such bound.
    pub deadline_ms: Option<u64>,
    /// Raw bytes that will follow the line.
    pub attach_bytes: u64,
}

impl<P: Serialize + ?Sized> Outgoing<'_, P> {
    /// The line, with its end.
    ///
    /// # Errors
    /// Where the parameters cannot be JSON: a map with keys that are no strings.
    pub fn line(&self) -> Result<Vec<u8>, serde_json::Error> {
        line_of(&RequestLine {
            jsonrpc: "2.0",
            id: self.id,
            method: self.method,
            params: self.params,
            deadline_ms: self.deadline_ms,
            attach_bytes: (self.attach_bytes > 0).then_some(self.attach_bytes),
        })
    }
}

fn line_of(message: &impl Serialize) -> Result<Vec<u8>, serde_json::Error> {
    let mut line = serde_json::to_vec(message)?;
    line.push(b'\n');
    Ok(line)
}

#[derive(Serialize)]
struct RequestLine<'a, P: ?Sized> {
    jsonrpc: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    id: Option<&'a Id>,
    method: &'a str,
    params: &'a P,
    #[serde(skip_serializing_if = "Option::is_none")]
    deadline_ms: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    attach_bytes: Option<u64>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::protocol::{ErrorKind, Fault, Request};
    use serde_json::json;

    #[test]
    fn replies_are_told_from_what_goes_ahead_of_them() {
        let error =
            json!({"jsonrpc": "2.0", "id": 1, "error": ErrorObject::from(Fault::Cancelled)});
        let Incoming::Reply(read) = Incoming::parse(error.to_string().as_bytes()).unwrap() else {
            panic!("it has an outcome");
        };
        assert_eq!(read.outcome.unwrap_err().kind(), Some(ErrorKind::Cancelled));
        let ahead =
            br#"{"jsonrpc":"2.0","method":"frame.ready","params":{"index":2},"attach_bytes":3}"#;
        let Incoming::Notification(read) = Incoming::parse(ahead).unwrap() else {
            panic!("it has a method");
        };
        assert_eq!(
            (read.method.as_str(), read.attach_bytes),
            ("frame.ready", 3)
        );
    }

    #[test]
    fn a_request_is_read_as_it_was_written() {
        let id = Id::Integer(-4);
        let params = json!({ "rig": "wasp" });
        let mut outgoing = Outgoing {
            id: Some(&id),
            method: "rig.describe",
            params: &params,
            deadline_ms: Some(20),
            attach_bytes: 7,
        };
        let request = Request::parse(&outgoing.line().unwrap()).unwrap();
        assert_eq!((request.id.as_ref(), request.attach_bytes), (Some(&id), 7));
        assert_eq!(request.deadline_ms, Some(20));
        assert_eq!(request.params.unwrap().get(), params.to_string());
        outgoing.id = None;
        let notification = Request::parse(&outgoing.line().unwrap()).unwrap();
        assert_eq!(notification.id, None);
    }
}
