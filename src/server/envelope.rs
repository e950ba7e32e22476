//! Messages of the service as JSON-RPC. Never lives here: where one message ends and the next begins.

use crate::protocol::{ErrorObject, Fault, Id};
use crate::service::{Message, Notification, Permit, Response};
use bytes::Bytes;

/// One JSON-RPC message. Its text is in three pieces, so that what the service wrote is not copied into another text.
pub(super) struct Envelope {
    pub head: String,
    /// The result, the error or the parameters.
    pub body: String,
    pub tail: String,
    /// What follows the text, in whatever way the front sends raw bytes.
    pub attachments: Vec<Bytes>,
    /// Whether it is the response, and nothing that goes ahead of it.
    pub is_last: bool,
    /// Held until all of it is written.
    _permit: Option<Permit>,
}

impl From<Message> for Envelope {
    fn from(message: Message) -> Self {
        match message {
            Message::Notification(notification) => notification.into(),
            Message::Response(response) => response.into(),
        }
    }
}

impl From<Response> for Envelope {
    fn from(response: Response) -> Self {
        let Response {
            id,
            outcome,
            attachments,
            permit,
        } = response;
        let (member, body) = match outcome {
            Ok(result) => ("result", result),
            Err(fault) => ("error", error(fault)),
        };
        Self {
            head: format!("{{\"jsonrpc\":\"2.0\",\"id\":{},\"{member}\":", json(&id)),
            body,
            tail: tail(&attachments),
            attachments,
            is_last: true,
            _permit: permit,
        }
    }
}

impl From<Notification> for Envelope {
    fn from(notification: Notification) -> Self {
        let Notification {
            method,
            params,
            attachments,
            permit,
        } = notification;
        Self {
            head: format!("{{\"jsonrpc\":\"2.0\",\"method\":\"{method}\",\"params\":"),
            body: params,
            tail: tail(&attachments),
            attachments,
            is_last: false,
            _permit: permit,
        }
    }
}

/// The response to somebody who has not asked for anything yet.
pub(super) fn unasked(fault: Fault) -> Envelope {
    Envelope::from(Response {
        id: Id::Null,
        outcome: Err(fault),
        attachments: Vec::new(),
        permit: None,
    })
}

fn error(fault: Fault) -> String {
    json(&ErrorObject::from(fault))
}

fn json(value: &impl serde::Serialize) -> String {
    serde_json::to_string(value).expect("ids and errors have nothing that JSON cannot hold")
}

fn tail(attachments: &[Bytes]) -> String {
    match attachments.iter().map(Bytes::len).sum::<usize>() {
        0 => "}".to_owned(),
        count => format!(",\"attach_bytes\":{count}}}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(message: impl Into<Envelope>) -> String {
        let Envelope {
            head, body, tail, ..
        } = message.into();
        head + &body + &tail
    }

    fn response(id: Id, outcome: Result<&str, Fault>, attached: &'static [u8]) -> Response {
        Response {
            id,
            outcome: outcome.map(str::to_owned),
            attachments: vec![Bytes::from_static(attached)],
            permit: None,
        }
    }

    #[test]
    fn messages_look_as_json_rpc_says() {
        let ready = Notification {
            method: "frame.ready",
            params: "{\"index\":2}".to_owned(),
            attachments: vec![Bytes::from_static(b"ab"), Bytes::from_static(b"c")],
            permit: None,
        };
        for (text, wanted) in [
            (
                text(response(Id::Text("a\n".into()), Ok("{}"), b"")),
                r#"{"jsonrpc":"2.0","id":"a\n","result":{}}"#,
            ),
            (
                text(response(Id::Null, Ok("{}"), b"abc")),
                r#"{"jsonrpc":"2.0","id":null,"result":{},"attach_bytes":3}"#,
            ),
            (
                text(response(Id::from(1), Err(Fault::Cancelled), b"")),
                r#"{"jsonrpc":"2.0","id":1,"error":{"code":-32010,"message":"the request was cancelled","data":{"kind":"cancelled","retryable":false}}}"#,
            ),
            (
                text(ready),
                r#"{"jsonrpc":"2.0","method":"frame.ready","params":{"index":2},"attach_bytes":3}"#,
            ),
        ] {
            assert_eq!(text, wanted);
        }
    }
}
