//! A line on its way in: read, and perhaps refused, before the service acts on it. Never lives here: what a method does.

use crate::limits::Limits;
use crate::protocol::{BadRequest, ErrorObject, Fault, FieldFault, Id, Request, error_line};
use std::time::Instant;

/// One line, read but not yet acted upon: the raw bytes that belong to it are still to come.
pub struct Message {
    pub(super) request: Result<Request, BadRequest>,
    pub(super) arrived: Instant,
}

impl Message {
    pub fn read(line: &[u8], arrived: Instant) -> Self {
        Self {
            request: Request::parse(line),
            arrived,
        }
    }

    /// The last line of a client that closed its half without ending it. `None` where it is no whole JSON object: then it may be the start
    /// of another line than the client meant to send.
    pub fn read_unended(line: &[u8], arrived: Instant) -> Option<Self> {
        let message = Self::read(line, arrived);
        let is_cut = matches!(
            &message.request,
            Err(BadRequest {
                fault: Fault::ParseError { .. },
                ..
            })
        );
        if is_cut || !line.trim_ascii_start().starts_with(b"{") {
            return None;
        }
        match message.request {
            // They come behind the line's end.
            Ok(Request { attach_bytes, .. }) if attach_bytes > 0 => {
                let problem = format!(
                    "expected {attach_bytes} raw bytes behind the line, but found neither its end nor any"
                );
                let fault = FieldFault::new("attach_bytes", problem);
                Some(message.refused(Fault::InvalidMember(fault)))
            }
            _ => Some(message),
        }
    }

    /// A line that outgrew its limit, of which nothing was kept.
    pub fn too_long(limits: &Limits) -> Self {
        let maximum = limits.line_bytes;
        let fault = exceeded("line_bytes", maximum, maximum.saturating_add(1));
        Self {
            request: Err(unfollowed(Id::Null, fault)),
            arrived: Instant::now(),
        }
    }

    /// How many raw bytes follow the line; `None` where nobody can tell, and so the connection has to end.
    pub fn attach_bytes(&self) -> Option<u64> {
        match &self.request {
            Ok(request) => Some(request.attach_bytes),
            Err(bad) => bad.attach_bytes,
        }
    }

    /// The same message, to be refused because more raw bytes would follow it than may.
    pub fn attaching_too_much(self, limits: &Limits) -> Self {
        let asked = self.attach_bytes().unwrap_or(u64::MAX);
        self.refused(exceeded("attachment_bytes", limits.attachment_bytes, asked))
    }

    fn refused(self, fault: Fault) -> Self {
        let id = match self.request {
            Ok(Request { id: Some(id), .. }) | Err(BadRequest { id, .. }) => id,
            Ok(Request { id: None, .. }) => Id::Null,
        };
        Self {
            request: Err(unfollowed(id, fault)),
            arrived: self.arrived,
        }
    }
}

/// The line for a client that is one too many.
pub fn turned_away(maximum: u64, asked: u64) -> Vec<u8> {
    error_line(
        &Id::Null,
        &ErrorObject::from(exceeded("connections", maximum, asked)),
    )
}

fn exceeded(limit: &str, maximum: u64, asked: u64) -> Fault {
    Fault::LimitExceeded {
        limit: limit.to_owned(),
        maximum,
        asked,
    }
}

/// Behind such a message nobody knows where the next one starts.
fn unfollowed(id: Id, fault: Fault) -> BadRequest {
    BadRequest {
        id,
        attach_bytes: None,
        fault,
    }
}
