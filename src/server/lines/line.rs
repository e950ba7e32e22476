//! A line that was read, and perhaps refused, before the service acts on it: the raw bytes that belong to it are still to come.
//! Never lives here: reading from a socket.

use crate::limits::{LimitExceeded, Limits};
use crate::protocol::{self, BadRequest, Fault, FieldFault, Id};
use crate::service::{Request, ResponseHandle, Session};
use bytes::Bytes;
use std::time::{Duration, Instant};

pub(super) struct Line {
    read: Result<protocol::Request, BadRequest>,
    arrived: Instant,
}

impl Line {
    pub(super) fn read(line: &[u8]) -> Self {
        Self {
            arrived: Instant::now(),
            read: protocol::Request::parse(line),
        }
    }

    /// The last line of a client that closed its half without ending it. `None` where it is no whole JSON object: then it may be the start
    /// of another line than the client meant to send.
    pub(super) fn read_unended(line: &[u8]) -> Option<Self> {
        let read = Self::read(line);
        let is_cut = matches!(
            &read.read,
            Err(BadRequest {
                fault: Fault::ParseError { .. },
                ..
            })
        );
        if is_cut || !line.trim_ascii_start().starts_with(b"{") {
            return None;
        }
        match read.read {
            // They come behind the line's end.
            Ok(protocol::Request { attach_bytes, .. }) if attach_bytes > 0 => {
                let problem = format!(
                    "expected {attach_bytes} raw bytes behind the line, but found neither its end nor any"
                );
                let fault = FieldFault::new("attach_bytes", problem);
                Some(read.refused(Fault::InvalidMember(fault)))
            }
            _ => Some(read),
        }
    }

    /// One that outgrew its limit, of which nothing was kept.
    pub(super) fn too_long(exceeded: LimitExceeded) -> Self {
        Self {
            read: Err(unfollowed(Id::Null, exceeded.into())),
            arrived: Instant::now(),
        }
    }

    /// How many raw bytes follow the line; `None` where nobody can tell, and so the connection has to end.
    pub(super) fn attach_bytes(&self) -> Option<u64> {
        match &self.read {
            Ok(request) => Some(request.attach_bytes),
            Err(bad) => bad.attach_bytes,
        }
    }

    /// Refuses a line that more raw bytes would follow than may. Nothing can follow it then.
    pub(super) fn within(self, limits: &Limits) -> Self {
        let allowed = limits.attachment_bytes(self.attach_bytes().unwrap_or(0));
        match allowed {
            Ok(()) => self,
            Err(exceeded) => self.refused(exceeded.into()),
        }
    }

    fn refused(self, fault: Fault) -> Self {
        let id = match self.read {
            Ok(protocol::Request { id: Some(id), .. }) | Err(BadRequest { id, .. }) => id,
            Ok(protocol::Request { id: None, .. }) => Id::Null,
        };
        Self {
            read: Err(unfollowed(id, fault)),
            arrived: self.arrived,
        }
    }

    /// Hands the line to the service, with the raw bytes that followed it.
    pub(super) fn begin(self, session: &mut Session, attached: Bytes) -> Option<ResponseHandle> {
        let protocol::Request {
            id,
            method,
            params,
            deadline_ms,
            ..
        } = match self.read {
            Ok(request) => request,
            Err(BadRequest { id, fault, .. }) => return Some(session.refuse(id, fault)),
        };
        let due = |ms| self.arrived.checked_add(Duration::from_millis(ms));
        session.begin(Request {
            id,
            method,
            params,
            deadline: deadline_ms.and_then(due),
            attached,
        })
    }
}

/// Behind such a line nobody knows where the next one starts.
fn unfollowed(id: Id, fault: Fault) -> BadRequest {
    BadRequest {
        id,
        attach_bytes: None,
        fault,
    }
}
