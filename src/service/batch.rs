//! Many items of one request: checked on the pool before the first is begun, then worked on in order and sent one by one or together.
//! Never lives here: what an item is.

use super::call::Call;
use super::message::{Notification, Payload, Permit};
use super::response::Responder;
use crate::engine::{JobContext, MemoryPermit, Ordered, Ticket, WindowPermit, Work};
use crate::protocol::{Attachments, Fault, Id};
use serde::Serialize;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// What a batch is of.
pub(super) trait Items: Send + Sync + Sized + 'static {
    /// An item as the request has it.
    type Given: Send + 'static;
    /// An item in plain types, with everything checked that can be told before work on it begins.
    type Prepared: Send + 'static;
    /// What working on an item comes to, ready to be sent.
    type Done: Send;
    /// An item as it is sent.
    type Sent: Serialize + Send;
    /// Of the notification that an item is streamed by.
    const READY: &'static str;

    fn prepare(&self, index: usize, given: Self::Given) -> Result<Self::Prepared, Fault>;

    /// Bytes of the item as it is written, as far as they are known before work on it begins.
    fn least_bytes(&self, prepared: &Self::Prepared) -> u64;

    /// Starts work on an item. `done` runs exactly once, on any thread.
    fn start(
        &self,
        index: usize,
        prepared: Self::Prepared,
        context: JobContext,
        done: impl FnOnce(Result<Self::Done, Fault>) + Send + 'static,
    );

    /// Bytes of the item as it is written.
    fn written_bytes(done: &Self::Done) -> u64;

    fn sent(done: Self::Done, attachments: &mut Attachments) -> Self::Sent;

    /// The parameters of the notification.
    fn ready(request: &Id, index: u64, item: Self::Sent) -> impl Serialize;

    /// The result: `items` where they were not streamed.
    fn result(item_count: u64, items: Option<Vec<Self::Sent>>) -> impl Serialize;
}

/// A batch as it was asked for.
pub(super) struct Batch<I: Items> {
    pub items: I,
    pub given: Vec<I::Given>,
    pub streams: bool,
    /// Bytes of one item until it is written, of the largest.
    pub item_bytes: u64,
    /// Bytes of what the request brought and is kept until its end, besides the items themselves.
    pub request_bytes: u64,
}

impl<I: Items> Batch<I> {
    /// Admits the batch as one request. What this gives does not check a single item before it returns: that takes as long as a client
    /// likes, and meanwhile the connection is to hear a `request.cancel`.
    pub(super) fn prepare(self, call: &Call) -> Result<impl FnOnce(Responder) + use<I>, Fault> {
        let Self {
            items,
            given,
            streams,
            item_bytes,
            request_bytes,
        } = self;
        let engine = call.engine();
        // Of its connection's quota no more than half, so that what is asked beside it goes on.
        let quota = engine.limits().in_flight_bytes_per_connection / 2;
        let affordable = usize::try_from(quota / item_bytes.max(1)).unwrap_or(usize::MAX);
        // Enough for every core to have work while finished items are written.
        let busy = 2 * engine.thread_count() + 4;
        let window = busy.min(affordable).min(given.len()).max(1);
        let kept = given.len() * (size_of::<I::Given>() + size_of::<I::Prepared>());
        let bytes = kept as u64 + request_bytes + window as u64 * item_bytes;
        let (memory, context) = call.admit(bytes)?;
        let call = call.clone();
        Ok(move |responder| {
            let checking = Checking {
                items,
                prepared: Vec::with_capacity(given.len()),
                given: given.into_iter(),
                least_bytes: 0,
                run: Run {
                    call,
                    streams,
                    window,
                    context,
                    memory,
                    responder,
                },
            };
            checking.spawn();
        })
    }
}

/// How long items are checked on one thread before other work has its turn.
const SLICE: Duration = Duration::from_millis(2);

/// A batch whose items are being checked, each once.
struct Checking<I: Items> {
    items: I,
    given: std::vec::IntoIter<I::Given>,
    prepared: Vec<I::Prepared>,
    least_bytes: u64,
    run: Run,
}

/// What a batch is worked on with.
struct Run {
    call: Call,
    streams: bool,
    /// Items that may be in hand at a time.
    window: usize,
    context: JobContext,
    memory: MemoryPermit,
    responder: Responder,
}

impl<I: Items> Checking<I> {
    fn spawn(self) {
        let call = self.run.call.clone();
        call.engine().spawn(move || self.check_some());
    }

    fn check_some(mut self) {
        let until = Instant::now() + SLICE;
        while let Some(given) = self.given.next() {
            if let Err(fault) = self.check(given) {
                return self.run.responder.respond(Err(fault));
            }
            if Instant::now() >= until {
                return self.spawn();
            }
        }
        self.begin();
    }

    fn check(&mut self, given: I::Given) -> Result<(), Fault> {
        self.run.context.cancellation.check()?;
        let prepared = self.items.prepare(self.prepared.len(), given)?;
        self.least_bytes += self.items.least_bytes(&prepared);
        self.prepared.push(prepared);
        Ok(())
    }

    fn begin(self) {
        let Run {
            call,
            streams,
            window,
            context,
            memory,
            responder,
        } = self.run;
        if !streams && let Err(exceeded) = call.engine().limits().batch_bytes(self.least_bytes) {
            return responder.respond(Err(exceeded.into()));
        }
        let work = Working {
            items: self.items,
            item_count: self.prepared.len() as u64,
            call,
            streams,
            open: Mutex::new(Some(Open {
                responder,
                ticket: context.ticket,
                memory,
                together: Together::default(),
            })),
        };
        Ordered::run(work, self.prepared, window);
    }
}

/// A batch whose items are being worked on.
struct Working<I: Items> {
    items: I,
    item_count: u64,
    call: Call,
    streams: bool,
    /// `None` once it is answered.
    open: Mutex<Option<Open<I::Sent>>>,
}

/// What ends with the response.
struct Open<S> {
    responder: Responder,
    ticket: Ticket,
    memory: MemoryPermit,
    together: Together<S>,
}

/// The items of a batch that is not streamed.
struct Together<S> {
    items: Vec<S>,
    attachments: Attachments,
    written_bytes: u64,
}

impl<S> Default for Together<S> {
    fn default() -> Self {
        Self {
            items: Vec::new(),
            attachments: Attachments::default(),
            written_bytes: 0,
        }
    }
}

impl<I: Items> Work for Working<I> {
    type Item = I::Prepared;
    type Output = I::Done;
    type Error = Fault;

    fn start(
        &self,
        index: usize,
        prepared: I::Prepared,
        done: impl FnOnce(Result<I::Done, Fault>) + Send + 'static,
    ) -> Result<(), Fault> {
        let cancellation = self.call.cancellation.clone();
        cancellation.check()?;
        let ticket = match &*self.lock() {
            Some(open) => open.ticket.clone(),
            // Another item has failed meanwhile.
            None => return Err(Fault::Cancelled),
        };
        let context = JobContext {
            cancellation,
            ticket,
        };
        self.items.start(index, prepared, context, done);
        Ok(())
    }

    fn deliver(
        &self,
        index: usize,
        done: I::Done,
        permit: WindowPermit<Self>,
    ) -> Result<(), Fault> {
        if self.streams {
            self.stream(index, done, permit)
        } else {
            self.put_together(done)
        }
    }

    fn finish(&self, outcome: Result<(), Fault>) {
        let Some(open) = self.lock().take() else {
            return;
        };
        // Whoever has the response finds its place among the requests in the works free.
        drop(open.ticket);
        let payload = outcome.and_then(|()| {
            let Together {
                items, attachments, ..
            } = open.together;
            let items = (!self.streams).then_some(items);
            let result = I::result(self.item_count, items);
            Payload::new(&result, attachments, Some(Permit::new(open.memory)))
        });
        open.responder.respond(payload);
    }

    fn spawn(&self, resume: impl FnOnce() + Send + 'static) {
        self.call.engine().spawn(resume);
    }
}

impl<I: Items> Working<I> {
    fn stream(&self, index: usize, done: I::Done, permit: WindowPermit<Self>) -> Result<(), Fault> {
        let stream = self
            .lock()
            .as_ref()
            .and_then(|open| open.responder.stream());
        let Some(stream) = stream else { return Ok(()) };
        let mut attachments = Attachments::default();
        let item = I::sent(done, &mut attachments);
        let params = I::ready(stream.request(), index as u64, item);
        let Payload {
            json,
            attachments,
            permit,
        } = Payload::new(&params, attachments, Some(Permit::new(permit)))?;
        stream.send(Notification {
            method: I::READY,
            params: json,
            attachments,
            permit,
        });
        Ok(())
    }

    fn put_together(&self, done: I::Done) -> Result<(), Fault> {
        let bytes = I::written_bytes(&done);
        let mut open = self.lock();
        let Some(open) = &mut *open else {
            return Ok(());
        };
        let together = &mut open.together;
        together.written_bytes += bytes;
        let limits = self.call.engine().limits();
        limits.batch_bytes(together.written_bytes)?;
        let grown = open.memory.grow(bytes);
        grown.map_err(|error| self.call.busy(error))?;
        let item = I::sent(done, &mut together.attachments);
        together.items.push(item);
        Ok(())
    }

    fn lock(&self) -> MutexGuard<'_, Option<Open<I::Sent>>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
