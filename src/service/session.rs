//! One connection's side of the service: requests in, responses out, in whatever framing the connection has.
//! Never lives here: the order in which responses are written.

use super::call::Call;
use super::dispatch::Dispatch;
use super::in_flight::InFlight;
use super::message::Permit;
#[cfg(any(test, feature = "test-support"))]
use super::message::Response;
use super::response::{ResponseHandle, response};
use super::state::Service;
use crate::engine::{Cancellation, ConnectionQuota};
use crate::protocol::{Fault, Id, Method};
use bytes::Bytes;
use serde_json::value::RawValue;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Instant;

/// A request, however it came.
#[derive(Debug, Clone)]
pub struct Request {
    /// `None` makes it a notification, which is never answered.
    pub id: Option<Id>,
    pub method: String,
    pub params: Option<Box<RawValue>>,
    pub deadline: Option<Instant>,
    /// Raw bytes that came along.
    pub attached: Bytes,
}

/// What one connection asks the service.
pub struct Session {
    service: Arc<Service>,
    in_flight: InFlight,
    quota: Arc<ConnectionQuota>,
}

impl Service {
    pub fn session(self: &Arc<Self>) -> Session {
        Session {
            service: Arc::clone(self),
            in_flight: InFlight::default(),
            quota: self.engine.admission().connection_quota(),
        }
    }

    /// Answers one request and waits for it. `None` for a notification.
    #[cfg(any(test, feature = "test-support"))]
    pub fn answer(self: &Arc<Self>, request: Request) -> Option<Response> {
        self.session().begin(request).map(ResponseHandle::wait)
    }
}

impl Session {
    /// Memory for the raw bytes of a request; `None` where there is none now.
    pub fn reserve_attachment(&self, bytes: u64) -> Option<Permit> {
        let admission = self.service.engine.admission();
        admission.reserve_attachment(bytes).map(Permit::new)
    }

    /// Acts on a request. What changes rigs or poses has happened when this returns; drawing and copying go on behind the
    /// [`ResponseHandle`]. `None` for a notification.
    pub fn begin(&mut self, request: Request) -> Option<ResponseHandle> {
        let Request {
            id,
            method,
            params,
            deadline,
            attached,
        } = request;
        let method = Method::named(&method);
        let named = method.as_ref().ok().copied();
        // Nobody hears what a notification comes to, so one that only asks is not worth working on.
        if id.is_none() && !named.is_some_and(Method::mutates) {
            return None;
        }
        let cancellation = Cancellation {
            deadline,
            ..Cancellation::default()
        };
        let stats = &self.service.stats;
        let (responder, handle) = match id {
            Some(id) => {
                let (responder, handle) = response(id.clone(), named, cancellation.clone(), stats);
                self.in_flight.insert(id, &handle);
                (responder, Some(handle))
            }
            // It is counted and goes nowhere.
            None => (
                response(Id::Null, named, Cancellation::default(), stats).0,
                None,
            ),
        };
        match method {
            Ok(method) => {
                let call = Call {
                    service: Arc::clone(&self.service),
                    attached,
                    cancellation,
                    quota: Arc::clone(&self.quota),
                };
                let dispatch = Dispatch {
                    call: &call,
                    params: params.as_deref(),
                    responder,
                };
                // A panic drops the responder, which tells the client; a store is only ever changed as a whole.
                let run = || dispatch.run(method, &self.in_flight);
                drop(catch_unwind(AssertUnwindSafe(run)));
            }
            Err(fault) => responder.respond(Err(fault)),
        }
        handle
    }

    /// The response to what could not be read as a request, in the order of those that could.
    pub fn refuse(&self, id: Id, fault: Fault) -> ResponseHandle {
        let (responder, handle) = response(id, None, Cancellation::default(), &self.service.stats);
        responder.respond(Err(fault));
        handle
    }
}
