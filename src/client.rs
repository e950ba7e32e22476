//! A blocking client: typed calls, pipelining, and raw bytes in both directions.
//! Never lives here: what any one method takes or gives; its types are in [`protocol`](crate::protocol).

use crate::protocol::{ErrorObject, Id, Incoming, Outgoing};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use serde_json::value::RawValue;
use std::collections::VecDeque;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::Duration;

/// Bytes of one reply's line, and as many again of what follows it. The largest honest answer is eight million vertices with normals written
/// out as numbers, some 600 MiB; what is longer comes from something that is no rigd.
pub const MAX_REPLY_BYTES: u64 = 1 << 30;

/// One connection.
#[derive(Debug)]
pub struct Client {
    reader: BufReader<TcpStream>,
    writer: TcpStream,
    next_id: u64,
    deadline_ms: Option<u64>,
    /// Replies that came while a call waited for a later one, and what went ahead of them.
    early: VecDeque<Message>,
}

/// A reply with the raw bytes that followed its line.
#[derive(Debug)]
pub struct Received {
    /// That of the request; [`Id::Null`] where the server could not tell which request it was.
    pub id: Id,
    /// The result as the server wrote it in JSON, or its error.
    pub outcome: Result<Box<RawValue>, ErrorObject>,
    /// Blobs with the encoding `attach` lie in here.
    pub attached: Vec<u8>,
}

/// What goes ahead of a reply: an item of a streamed batch.
#[derive(Debug)]
pub struct Notification {
    /// `frame.ready` or `mesh.ready`.
    pub method: String,
    /// A [`FrameReady`](crate::protocol::batch::FrameReady) or a [`MeshReady`](crate::protocol::batch::MeshReady).
    pub params: Box<RawValue>,
    /// Blobs with the encoding `attach` lie in here.
    pub attached: Vec<u8>,
}

/// One message of the server's.
#[derive(Debug)]
pub enum Message {
    /// An item of a streamed batch, ahead of the batch's reply.
    Notification(Notification),
    /// The one answer to a request.
    Reply(Received),
}

/// Why there is no result.
#[derive(Debug, thiserror::Error)]
pub enum ClientError {
    /// The server answered with an error. The connection is as good as before.
    #[error("{0}")]
    Server(Box<ErrorObject>),
    /// The parameters cannot be written as JSON; nothing was sent.
    #[error("the parameters cannot be sent: {0}")]
    Params(#[source] serde_json::Error),
    /// The result is not of the type that was asked for. The connection is as good as before.
    #[error("the result is not what was expected: {0}")]
    Result(#[source] serde_json::Error),
    /// The connection failed or ran into its timeout; it is of no more use.
    #[error("the connection failed: {0}")]
    Connection(#[from] io::Error),
    /// The server closed the connection before it answered.
    #[error("the server closed the connection before it answered")]
    Closed,
    /// What came is no reply; the connection is of no more use.
    #[error("the server sent something that is no reply: {0}")]
    NotAReply(#[source] serde_json::Error),
    /// More came than [`MAX_REPLY_BYTES`]; the connection is of no more use.
    #[error("a reply is longer than {MAX_REPLY_BYTES} bytes")]
    TooLong,
}

impl Client {
    /// # Errors
    /// [`ClientError::Connection`] where nobody listens there.
    pub fn connect(address: impl ToSocketAddrs) -> Result<Self, ClientError> {
        let writer = TcpStream::connect(address)?;
        // A request is written in one piece; waiting for more of it would only delay it.
        writer.set_nodelay(true)?;
        Ok(Self {
            reader: BufReader::new(writer.try_clone()?),
            writer,
            next_id: 1,
            deadline_ms: None,
            early: VecDeque::new(),
        })
    }

    /// How long to wait for the server to send or to take something; `None` is for ever.
    ///
    /// # Errors
    /// Where the duration is zero.
    pub fn set_timeout(&mut self, timeout: Option<Duration>) -> Result<(), ClientError> {
        self.writer.set_read_timeout(timeout)?;
        self.writer.set_write_timeout(timeout)?;
        Ok(())
    }

    /// The `deadline_ms` of every request from now on.
    pub fn set_deadline_ms(&mut self, deadline_ms: Option<u64>) {
        self.deadline_ms = deadline_ms;
    }

    /// Asks and waits for the answer.
    ///
    /// # Errors
    /// [`ClientError::Server`] for an error of the server's; see there for the others.
    pub fn call<P, R>(&mut self, method: &str, params: &P) -> Result<R, ClientError>
    where
        P: Serialize + ?Sized,
        R: DeserializeOwned,
    {
        Ok(self.call_with_attachments(method, params, &[])?.0)
    }

    /// Asks with raw bytes beside the parameters, and gives those beside the result: what blobs with the encoding `attach` refer to.
    ///
    /// # Errors
    /// As [`Client::call`].
    pub fn call_with_attachments<P, R>(
        &mut self,
        method: &str,
        params: &P,
        attached: &[u8],
    ) -> Result<(R, Vec<u8>), ClientError>
    where
        P: Serialize + ?Sized,
        R: DeserializeOwned,
    {
        let id = self.send_with_attachments(method, params, attached)?;
        let received = self.receive_for(&id)?;
        let result = received
            .outcome
            .map_err(|error| ClientError::Server(Box::new(error)))?;
        let result = serde_json::from_str(result.get()).map_err(ClientError::Result)?;
        Ok((result, received.attached))
    }

    /// Asks and answers in plain JSON.
    ///
    /// # Errors
    /// As [`Client::call`].
    pub fn call_raw(
        &mut self,
        method: &str,
        params: Value,
    ) -> Result<(Value, Vec<u8>), ClientError> {
        self.call_with_attachments(method, &params, &[])
    }

    /// Asks and does not wait. The server stops reading at some number of requests under way: who sends without end must receive in between.
    ///
    /// # Errors
    /// [`ClientError::Params`] or [`ClientError::Connection`].
    pub fn send<P: Serialize + ?Sized>(
        &mut self,
        method: &str,
        params: &P,
    ) -> Result<Id, ClientError> {
        self.send_with_attachments(method, params, &[])
    }

    /// As [`Client::send`], with raw bytes behind the line.
    ///
    /// # Errors
    /// As [`Client::send`].
    pub fn send_with_attachments<P: Serialize + ?Sized>(
        &mut self,
        method: &str,
        params: &P,
        attached: &[u8],
    ) -> Result<Id, ClientError> {
        let id = Id::from(self.next_id);
        self.next_id += 1;
        self.write(Some(&id), method, params, attached)?;
        Ok(id)
    }

    /// Gives up on a request under way. Its reply still comes: `cancelled`, or the result where that was ready.
    ///
    /// # Errors
    /// [`ClientError::Connection`].
    pub fn cancel(&mut self, request: Id) -> Result<(), ClientError> {
        let params = crate::protocol::server::Cancel { request };
        self.write(None, "request.cancel", &params, &[])
    }

    /// The next reply, in the order of the requests. What goes ahead of it is passed over; [`Client::next`] gives that too.
    ///
    /// # Errors
    /// [`ClientError::Closed`] where no more will come; see there for the others.
    pub fn receive(&mut self) -> Result<Received, ClientError> {
        loop {
            if let Message::Reply(received) = self.next()? {
                return Ok(received);
            }
        }
    }

    /// The next message: a reply, or an item of a streamed batch that goes ahead of its reply.
    ///
    /// # Errors
    /// As [`Client::receive`].
    #[expect(
        clippy::should_implement_trait,
        reason = "it waits, and may fail for good"
    )]
    pub fn next(&mut self) -> Result<Message, ClientError> {
        match self.early.pop_front() {
            Some(message) => Ok(message),
            None => self.read(),
        }
    }

    fn receive_for(&mut self, id: &Id) -> Result<Received, ClientError> {
        loop {
            match self.read()? {
                // An error without id is about a line that the server could not make sense of. Whichever it was, no better answer will come.
                Message::Reply(received) if received.id == *id || received.id == Id::Null => {
                    return Ok(received);
                }
                other => self.early.push_back(other),
            }
        }
    }

    fn write<P: Serialize + ?Sized>(
        &mut self,
        id: Option<&Id>,
        method: &str,
        params: &P,
        attached: &[u8],
    ) -> Result<(), ClientError> {
        let outgoing = Outgoing {
            id,
            method,
            params,
            deadline_ms: self.deadline_ms,
            attach_bytes: attached.len() as u64,
        };
        let line = outgoing.line().map_err(ClientError::Params)?;
        self.writer.write_all(&line)?;
        self.writer.write_all(attached)?;
        Ok(())
    }

    fn read(&mut self) -> Result<Message, ClientError> {
        let mut line = Vec::new();
        let limit = MAX_REPLY_BYTES + 1;
        (&mut self.reader)
            .take(limit)
            .read_until(b'\n', &mut line)?;
        if line.last() != Some(&b'\n') {
            return Err(if line.len() as u64 == limit {
                ClientError::TooLong
            } else {
                ClientError::Closed
            });
        }
        let incoming = Incoming::parse(&line).map_err(ClientError::NotAReply)?;
        let attach_bytes = match &incoming {
            Incoming::Reply(reply) => reply.attach_bytes,
            Incoming::Notification(notification) => notification.attach_bytes,
        };
        if attach_bytes > MAX_REPLY_BYTES {
            return Err(ClientError::TooLong);
        }
        // Grows with what comes, so that a number alone takes no memory.
        let mut attached = Vec::new();
        (&mut self.reader)
            .take(attach_bytes)
            .read_to_end(&mut attached)?;
        if (attached.len() as u64) < attach_bytes {
            return Err(ClientError::Closed);
        }
        Ok(match incoming {
            Incoming::Reply(reply) => Message::Reply(Received {
                id: reply.id,
                outcome: reply.outcome,
                attached,
            }),
            Incoming::Notification(notification) => Message::Notification(Notification {
                method: notification.method,
                params: notification.params,
                attached,
            }),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::protocol::blob::{ArrayTransport, Blob, Dtype};
    use crate::protocol::{Attachments, Fault, MissingRig, Request};
    use serde_json::json;
    use std::net::TcpListener;
    use std::thread::{self, JoinHandle};

    /// A server that answers each request with what `answer` makes of it, until the client goes.
    fn client_of(
        answer: impl Fn(Request, Vec<u8>) -> Vec<u8> + Send + 'static,
    ) -> (Client, JoinHandle<()>) {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        let server = thread::spawn(move || {
            let (mut stream, _) = listener.accept().unwrap();
            let mut reader = BufReader::new(stream.try_clone().unwrap());
            loop {
                let mut line = Vec::new();
                if reader.read_until(b'\n', &mut line).unwrap() == 0 {
                    return;
                }
                let request = Request::parse(&line).unwrap();
                let mut attached = vec![0; request.attach_bytes as usize];
                reader.read_exact(&mut attached).unwrap();
                stream.write_all(&answer(request, attached)).unwrap();
            }
        });
        let mut client = Client::connect(address).unwrap();
        // A client that waits for what never comes is to fail its test and not to hang it.
        client.set_timeout(Some(Duration::from_secs(20))).unwrap();
        (client, server)
    }

    fn id(request: &Request) -> &Id {
        request.id.as_ref().unwrap_or(&Id::Null)
    }

    fn result_line(id: &Id, result: &impl Serialize, attach_bytes: u64) -> Vec<u8> {
        let reply =
            json!({"jsonrpc": "2.0", "id": id, "result": result, "attach_bytes": attach_bytes});
        format!("{reply}\n").into_bytes()
    }

    fn echo(request: Request, _: Vec<u8>) -> Vec<u8> {
        let result = json!({ "method": request.method, "params": request.params });
        result_line(id(&request), &result, 0)
    }

    fn reply_with(bytes: &'static [u8]) -> impl Fn(Request, Vec<u8>) -> Vec<u8> {
        move |_, _| bytes.to_vec()
    }

    #[test]
    fn a_call_gets_the_result_of_its_own_request() {
        let (mut client, _server) = client_of(echo);
        let (result, attached) = client.call_raw("server.ping", json!({ "n": 1 })).unwrap();
        assert_eq!(
            result,
            json!({ "method": "server.ping", "params": { "n": 1 } })
        );
        assert!(attached.is_empty());
    }

    #[test]
    fn requests_can_be_sent_ahead_and_a_call_in_between_loses_no_reply() {
        let (mut client, _server) = client_of(echo);
        let first = client.send("first", &json!({})).unwrap();
        let second = client.send("second", &json!({})).unwrap();
        let (third, _) = client.call_raw("third", json!({})).unwrap();
        assert_eq!(third["method"], "third");
        assert_eq!(client.receive().unwrap().id, first);
        assert_eq!(client.receive().unwrap().id, second);
    }

    #[test]
    fn raw_bytes_go_both_ways() {
        let (mut client, _server) = client_of(|request, attached| {
            let mut attachments = Attachments::default();
            let floats = attached.iter().map(|byte| f32::from(*byte).to_le_bytes());
            let blob = Blob::array(
                Dtype::Float32,
                floats.collect::<Vec<_>>().into_flattened().into(),
                &[attached.len()],
                ArrayTransport::Attach,
                &mut attachments,
            );
            let mut reply = result_line(id(&request), &blob, attachments.total_bytes());
            reply.extend(attachments.to_bytes());
            reply
        });
        for _ in 0..2 {
            let (blob, attached): (Blob, _) = client
                .call_with_attachments("echo", &json!({}), b"\n\x01\xff")
                .unwrap();
            assert_eq!(blob.floats(&attached).unwrap(), [10.0, 1.0, 255.0]);
        }
    }

    #[test]
    fn an_error_of_the_server_is_told_from_one_of_the_connection() {
        let (mut client, _server) = client_of(|request, _| {
            let missing = MissingRig {
                rig: "wasp".to_owned(),
                ..MissingRig::default()
            };
            let fault = Fault::RigNotLoaded(Box::new(missing));
            let error = json!({"id": id(&request), "error": ErrorObject::from(fault)});
            format!("{error}\n").into_bytes()
        });
        for _ in 0..2 {
            let error = client.call_raw("pose.get", json!({})).unwrap_err();
            let ClientError::Server(error) = error else {
                panic!("{error}")
            };
            assert_eq!(error.detail("rig"), Some(&json!("wasp")));
        }

        type Check = fn(&ClientError) -> bool;
        let cases: [(&[u8], Check); 5] = [
            (b"hello\n", |e| matches!(e, ClientError::NotAReply(_))),
            (b"{\"id\":1}\n", |e| matches!(e, ClientError::NotAReply(_))),
            (b"{\"id\":1,\"result\":3}\n", |e| {
                matches!(e, ClientError::Result(_))
            }),
            (
                b"{\"id\":1,\"result\":{},\"attach_bytes\":99999999999}\n",
                |e| matches!(e, ClientError::TooLong),
            ),
            (
                b"{\"id\":null,\"error\":{\"code\":-32600,\"message\":\"\",\"data\":{\"kind\":\"new\",\"retryable\":false}}}\n",
                |e| matches!(e, ClientError::Server(_)),
            ),
        ];
        for (bytes, expected) in cases {
            let (mut client, _server) = client_of(reply_with(bytes));
            let error = client
                .call::<_, crate::protocol::Done>("server.ping", &json!({}))
                .unwrap_err();
            assert!(expected(&error), "{}: {error:?}", bytes.escape_ascii());
        }
    }

    #[test]
    fn a_reply_cut_short_is_no_reply() {
        for bytes in [
            &b"{\"id\":1,"[..],
            b"{\"id\":1,\"result\":{},\"attach_bytes\":5}\nabc",
        ] {
            let listener = TcpListener::bind("127.0.0.1:0").unwrap();
            let mut client = Client::connect(listener.local_addr().unwrap()).unwrap();
            let (mut stream, _) = listener.accept().unwrap();
            stream.write_all(bytes).unwrap();
            stream.shutdown(std::net::Shutdown::Write).unwrap();
            let error = client.call_raw("server.ping", json!({})).unwrap_err();
            assert!(matches!(error, ClientError::Closed), "{error:?}");
        }
    }

    #[test]
    fn a_cancellation_names_the_request_and_waits_for_nothing() {
        let (mut client, _server) = client_of(|request, _| {
            let said = json!([request.id.is_none(), request.method, request.params]);
            result_line(&Id::from(7), &said, 0)
        });
        client.cancel(Id::from(7)).unwrap();
        let result = client.receive().unwrap().outcome.unwrap();
        assert_eq!(result.get(), r#"[true,"request.cancel",{"request":7}]"#);
    }
}
