//! Many items of one request: a bounded number of them in hand at a time, and sent in their order. Never lives here: what an item is.

use super::Call;
use super::answer::Answer;
use crate::engine::{HeldBytes, Terms, Ticket};
use crate::protocol::{Attachments, Fault, Id, notification_line};
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What a batch is of.
pub(super) trait Items: Send + Sync + Sized + 'static {
    /// What working on an item comes to, ready to be sent.
    type Done: Send;
    /// An item as it is sent.
    type Sent: Serialize + Send;
    /// Of the notification that an item is streamed by.
    const READY: &'static str;

    fn count(&self) -> usize;

    /// Begins work on an item. `done` runs exactly once, on any thread.
    fn begin(
        &self,
        index: usize,
        terms: Terms,
        done: impl FnOnce(Result<Self::Done, Fault>) + Send + 'static,
    );

    /// Bytes that it takes until it is written.
    fn bytes(done: &Self::Done) -> u64;

    fn sent(done: Self::Done, attachments: &mut Attachments) -> Self::Sent;

    /// The parameters of the notification.
    fn ready(request: &Id, index: usize, item: Self::Sent) -> impl Serialize;

    /// The result: `items` where they were not streamed.
    fn result(&self, items: Option<Vec<Self::Sent>>) -> impl Serialize;
}

/// How a batch is to be worked on.
pub(super) struct Course {
    pub streams: bool,
    /// Bytes of one item, until it is written: the largest.
    pub item_bytes: u64,
    /// Bytes of all items as they are written, as far as they are known beforehand.
    pub least_bytes: u64,
    /// Bytes of what the request brought and is kept until its end.
    pub request_bytes: u64,
}

struct Batch<I: Items> {
    items: I,
    call: Call,
    streams: bool,
    /// Items that may be in hand at a time: enough for every core to have work while finished ones are written.
    window: usize,
    state: Mutex<State<I>>,
}

struct State<I: Items> {
    /// `None` once it is answered.
    duty: Option<Duty>,
    begun: usize,
    /// Begun, and not yet written or put with the others.
    in_hand: usize,
    /// Those whose turn to be sent has not come.
    finished: BTreeMap<usize, I::Done>,
    sent: usize,
    /// Somebody sends what is finished.
    is_sending: bool,
    /// Of a batch that is not streamed.
    together: Vec<I::Sent>,
    attachments: Attachments,
    /// Of everything in `together`.
    bytes: u64,
}

/// That of an item in hand, given back on drop: once it is written, or nobody wants it any more.
struct Place<I: Items>(Arc<Batch<I>>);

impl<I: Items> Drop for Place<I> {
    fn drop(&mut self) {
        self.0.lock().in_hand -= 1;
        // Whoever writes has other things to do.
        let batch = Arc::clone(&self.0);
        self.0.call.engine().spawn(move || batch.advance());
    }
}

/// What ends with the answer.
struct Duty {
    answer: Answer,
    ticket: Ticket,
    held: HeldBytes,
}

impl Call {
    /// Begins a batch whose items were found to be as they should.
    pub(super) fn run_batch<I: Items>(
        &self,
        items: I,
        course: &Course,
        answer: &mut Option<Answer>,
    ) -> Result<(), Fault> {
        let Course {
            streams,
            item_bytes,
            least_bytes,
            request_bytes,
        } = *course;
        if !streams {
            self.engine().limits().batch_bytes(least_bytes)?;
        }
        // Of its connection's share no more than half, so that what is asked beside it goes on.
        let share = self.engine().limits().in_flight_bytes_per_connection / 2;
        let threads = self.engine().thread_count();
        let room = usize::try_from(share / item_bytes.max(1)).unwrap_or(usize::MAX);
        let window = (2 * threads + 4).min(room).min(items.count()).max(1);
        let (held, terms) = self.take_on(request_bytes + window as u64 * item_bytes)?;
        let Some(answer) = answer.take() else {
            return Ok(());
        };
        let state = State {
            duty: Some(Duty {
                answer,
                ticket: terms.ticket,
                held,
            }),
            begun: 0,
            in_hand: 0,
            finished: BTreeMap::new(),
            sent: 0,
            is_sending: false,
            together: Vec::new(),
            attachments: Attachments::default(),
            bytes: 0,
        };
        let batch = Arc::new(Batch {
            items,
            call: self.clone(),
            streams,
            window,
            state: Mutex::new(state),
        });
        if batch.items.count() == 0 {
            batch.end();
        } else {
            batch.advance();
        }
        Ok(())
    }
}

impl<I: Items> Batch<I> {
    /// Begins as many items as may be in hand.
    fn advance(self: &Arc<Self>) {
        loop {
            let mut state = self.lock();
            let Some(duty) = &state.duty else { return };
            if state.begun == self.items.count() || state.in_hand == self.window {
                return;
            }
            let terms = Terms {
                urgency: self.call.urgency.clone(),
                ticket: duty.ticket.clone(),
            };
            let index = state.begun;
            state.begun += 1;
            state.in_hand += 1;
            drop(state);
            if let Err(error) = terms.urgency.check() {
                return self.fail(error.into());
            }
            let batch = Arc::clone(self);
            self.items
                .begin(index, terms, move |done| batch.finished(index, done));
        }
    }

    fn finished(self: &Arc<Self>, index: usize, done: Result<I::Done, Fault>) {
        match done {
            Ok(done) => {
                self.lock().finished.insert(index, done);
                self.send();
                self.advance();
            }
            Err(fault) => self.fail(fault),
        }
    }

    /// Sends what is finished, as far as its turn has come. One thread at a time does; what others finish meanwhile it sends as well.
    fn send(self: &Arc<Self>) {
        let mut state = self.lock();
        if state.is_sending {
            return;
        }
        state.is_sending = true;
        while state.duty.is_some() {
            let index = state.sent;
            let Some(done) = state.finished.remove(&index) else {
                break;
            };
            state.sent += 1;
            if self.streams {
                drop(state);
                self.stream(index, done);
                state = self.lock();
            } else if let Err(fault) = self.put_with_others(&mut state, done) {
                drop(state);
                return self.fail(fault);
            }
            if state.sent == self.items.count() {
                drop(state);
                return self.end();
            }
        }
        state.is_sending = false;
    }

    fn stream(self: &Arc<Self>, index: usize, done: I::Done) {
        let ahead = self
            .lock()
            .duty
            .as_ref()
            .and_then(|duty| duty.answer.ahead());
        let Some(ahead) = ahead else { return };
        let mut attachments = Attachments::default();
        let item = I::sent(done, &mut attachments);
        let params = I::ready(ahead.request(), index, item);
        match notification_line(I::READY, &params, &attachments) {
            Ok(line) => ahead.send(line, attachments, Box::new(Place(Arc::clone(self)))),
            Err(error) => self.fail(Fault::Internal {
                message: error.to_string(),
            }),
        }
    }

    fn put_with_others(&self, state: &mut State<I>, done: I::Done) -> Result<(), Fault> {
        let bytes = I::bytes(&done);
        state.bytes += bytes;
        let limits = self.call.engine().limits();
        limits.batch_bytes(state.bytes)?;
        if let Some(duty) = &mut state.duty {
            let grown = duty.held.grow(bytes);
            grown.map_err(|error| self.call.busy(error))?;
        }
        state.in_hand -= 1;
        let item = I::sent(done, &mut state.attachments);
        state.together.push(item);
        Ok(())
    }

    /// Everything is sent, or together.
    fn end(&self) {
        let mut state = self.lock();
        let Some(Duty {
            answer,
            ticket,
            held,
        }) = state.duty.take()
        else {
            return;
        };
        let together = std::mem::take(&mut state.together);
        let attachments = std::mem::take(&mut state.attachments);
        drop(state);
        drop(ticket);
        let items = (!self.streams).then_some(together);
        answer.send(&self.items.result(items), attachments, Some(held));
    }

    fn fail(&self, fault: Fault) {
        let mut state = self.lock();
        let duty = state.duty.take();
        state.finished.clear();
        state.together.clear();
        state.attachments = Attachments::default();
        drop(state);
        if let Some(Duty { answer, .. }) = duty {
            answer.fail(fault);
        }
    }

    fn lock(&self) -> MutexGuard<'_, State<I>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
