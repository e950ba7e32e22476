//! The response to one request: its place, which is filled exactly once by whoever is first, and how it is waited for.
//! Never lives here: what a response says, and how it is written to a socket.

use super::message::{Message, Notification, Payload, Response};
use super::stats::Stats;
use crate::engine::Cancellation;
use crate::protocol::{Fault, Id, Method};
use std::collections::VecDeque;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::task::{Context, Poll, Wake, Waker};
use std::thread::Thread;
use std::time::{Duration, Instant};

struct Slot {
    id: Id,
    method: Option<Method>,
    cancellation: Cancellation,
    stats: Arc<Stats>,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    /// In the order in which they are to be written.
    notifications: VecDeque<Notification>,
    response: Option<Response>,
    /// There is a response, whether or not it was taken away.
    is_answered: bool,
    /// Nobody waits.
    is_abandoned: bool,
    /// Of whoever waits.
    waker: Option<Waker>,
}

/// A response that is on its way. Dropped, it cancels the request.
pub struct ResponseHandle {
    slot: Arc<Slot>,
}

/// Ends a request early, for as long as anybody waits for it.
pub(super) struct CancelHandle {
    slot: Weak<Slot>,
}

/// Sends notifications ahead of a response.
pub(super) struct StreamSender {
    slot: Arc<Slot>,
}

/// The sending half of a response. Dropped without one, it sends the fault `internal`.
pub(super) struct Responder {
    slot: Option<Arc<Slot>>,
}

/// The two halves of the response to a request.
pub(super) fn response(
    id: Id,
    method: Option<Method>,
    cancellation: Cancellation,
    stats: &Arc<Stats>,
) -> (Responder, ResponseHandle) {
    let slot = Arc::new(Slot {
        id,
        method,
        cancellation,
        stats: Arc::clone(stats),
        state: Mutex::default(),
    });
    let responder = Responder {
        slot: Some(Arc::clone(&slot)),
    };
    (responder, ResponseHandle { slot })
}

/// Wakes a thread that waits.
struct Unpark(Thread);

impl Wake for Unpark {
    fn wake(self: Arc<Self>) {
        self.0.unpark();
    }
}

impl ResponseHandle {
    /// The next message. Each is given once; after the response it is pending for ever. At [`ResponseHandle::deadline`] it is to be polled
    /// again: what is not there by then becomes `deadline_exceeded`.
    pub fn poll_message(&self, context: &mut Context<'_>) -> Poll<Message> {
        let mut state = self.slot.lock();
        if let Some(message) = state.take_message() {
            return Poll::Ready(message);
        }
        if self.deadline().is_none_or(|due| Instant::now() < due) {
            state.waker = Some(context.waker().clone());
            return Poll::Pending;
        }
        drop(state);
        self.slot.fail(Fault::DeadlineExceeded);
        self.slot
            .lock()
            .take_message()
            .map_or(Poll::Pending, Poll::Ready)
    }

    /// Blocks until there is a message, for so long at most.
    pub fn wait_message(&self, timeout: Duration) -> Option<Message> {
        let waker = Waker::from(Arc::new(Unpark(std::thread::current())));
        let mut context = Context::from_waker(&waker);
        let end = Instant::now() + timeout;
        loop {
            if let Poll::Ready(message) = self.poll_message(&mut context) {
                return Some(message);
            }
            let now = Instant::now();
            if now >= end {
                return None;
            }
            // A deadline that has passed is that of a request which was answered.
            let due = self.deadline().filter(|&due| due > now);
            std::thread::park_timeout(due.map_or(end, |due| due.min(end)) - now);
        }
    }

    /// Blocks until there is a response, and passes over what goes ahead of it.
    #[cfg(any(test, feature = "test-support"))]
    pub fn wait(self) -> Response {
        loop {
            let message = self.wait_message(Duration::from_secs(60));
            if let Some(Message::Response(response)) = message {
                return response;
            }
        }
    }

    /// When the request becomes `deadline_exceeded`.
    pub fn deadline(&self) -> Option<Instant> {
        self.slot.cancellation.deadline
    }

    /// Answers `shutting_down` where there is no response yet.
    pub fn shut_down(&self) {
        self.slot.fail(Fault::ShuttingDown);
    }

    pub(super) fn cancel_handle(&self) -> CancelHandle {
        CancelHandle {
            slot: Arc::downgrade(&self.slot),
        }
    }
}

impl Drop for ResponseHandle {
    fn drop(&mut self) {
        self.slot
            .cancellation
            .cancelled
            .store(true, Ordering::Relaxed);
        let mut state = self.slot.lock();
        state.is_abandoned = true;
        let notifications = std::mem::take(&mut state.notifications);
        // Not under the lock: giving back their memory may start work.
        drop(state);
        drop(notifications);
    }
}

impl CancelHandle {
    pub(super) fn is_open(&self) -> bool {
        self.slot
            .upgrade()
            .is_some_and(|slot| !slot.lock().is_answered)
    }

    pub(super) fn cancel(&self) {
        if let Some(slot) = self.slot.upgrade() {
            slot.fail(Fault::Cancelled);
        }
    }
}

impl StreamSender {
    /// The `id` of the request.
    pub(super) fn request(&self) -> &Id {
        &self.slot.id
    }

    /// Once there is a response, or nobody waits for one, the notification is dropped.
    pub(super) fn send(&self, notification: Notification) {
        let mut state = self.slot.lock();
        if state.is_answered || state.is_abandoned {
            drop(state);
            return drop(notification);
        }
        state.notifications.push_back(notification);
        wake(state);
    }
}

impl Responder {
    /// `None` once there is a response.
    pub(super) fn stream(&self) -> Option<StreamSender> {
        self.slot.as_ref().map(|slot| StreamSender {
            slot: Arc::clone(slot),
        })
    }

    pub(super) fn respond(mut self, outcome: Result<Payload, Fault>) {
        let Some(slot) = self.slot.take() else { return };
        match outcome {
            Ok(payload) => slot.succeed(payload),
            Err(fault) => slot.fail(fault),
        }
    }
}

impl Drop for Responder {
    fn drop(&mut self) {
        if let Some(slot) = self.slot.take() {
            let message = "the server failed at this request; its log may say more".to_owned();
            slot.fail(Fault::Internal { message });
        }
    }
}

impl Slot {
    fn lock(&self) -> MutexGuard<'_, State> {
        // Nothing that holds this lock can leave the state half-written.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn succeed(&self, payload: Payload) {
        let Payload {
            json,
            attachments,
            permit,
        } = payload;
        let response = Response {
            id: self.id.clone(),
            outcome: Ok(json),
            attachments,
            permit,
        };
        self.fill(response, "ok");
    }

    fn fail(&self, fault: Fault) {
        let kind = fault.kind().name();
        let response = Response {
            id: self.id.clone(),
            outcome: Err(fault),
            attachments: Vec::new(),
            permit: None,
        };
        if self.fill(response, kind) {
            self.cancellation.cancelled.store(true, Ordering::Relaxed);
            // What was to go ahead of a result is of no more use.
            let notifications = std::mem::take(&mut self.lock().notifications);
            drop(notifications);
        }
    }

    /// Whether this was the first.
    fn fill(&self, response: Response, outcome: &'static str) -> bool {
        let mut state = self.lock();
        let is_first = !state.is_answered;
        if is_first {
            // Counted before anybody can see the response: whoever has it and asks for the counts finds it among them.
            self.stats.answered(self.method, outcome);
            state.is_answered = true;
            state.response = Some(response);
            wake(state);
        }
        is_first
    }
}

impl State {
    fn take_message(&mut self) -> Option<Message> {
        let notification = self.notifications.pop_front().map(Message::Notification);
        notification.or_else(|| self.response.take().map(Message::Response))
    }
}

fn wake(mut state: MutexGuard<'_, State>) {
    let waker = state.waker.take();
    drop(state);
    if let Some(waker) = waker {
        waker.wake();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::protocol::Attachments;
    use std::sync::atomic::AtomicUsize;

    #[derive(Default)]
    struct Counted(AtomicUsize);

    impl Wake for Counted {
        fn wake(self: Arc<Self>) {
            self.0.fetch_add(1, Ordering::SeqCst);
        }
    }

    fn open(deadline: Option<Instant>) -> (Responder, ResponseHandle) {
        let cancellation = Cancellation {
            deadline,
            ..Cancellation::default()
        };
        response(Id::from(7), None, cancellation, &Arc::default())
    }

    fn ready(index: u64) -> Notification {
        Notification {
            method: "frame.ready",
            params: index.to_string(),
            attachments: Vec::new(),
            permit: None,
        }
    }

    #[test]
    fn a_task_is_woken_for_each_message_and_needs_no_thread() {
        let (responder, handle) = open(None);
        let woken = Arc::new(Counted::default());
        let waker = Waker::from(Arc::clone(&woken));
        let mut context = Context::from_waker(&waker);
        assert!(handle.poll_message(&mut context).is_pending());
        let stream = responder.stream().unwrap();
        stream.send(ready(0));
        stream.send(ready(1));
        assert_eq!(
            woken.0.load(Ordering::SeqCst),
            1,
            "it has not been polled since"
        );
        for index in ["0", "1"] {
            let message = handle.poll_message(&mut context);
            assert!(
                matches!(message, Poll::Ready(Message::Notification(it)) if it.params == index)
            );
        }
        assert!(handle.poll_message(&mut context).is_pending());
        responder.respond(Payload::new(&3, Attachments::default(), None));
        assert_eq!(woken.0.load(Ordering::SeqCst), 2);
        stream.send(ready(2));
        let Poll::Ready(Message::Response(response)) = handle.poll_message(&mut context) else {
            panic!("it is there")
        };
        assert_eq!(
            (response.id, response.outcome),
            (Id::from(7), Ok("3".to_owned()))
        );
        assert!(handle.poll_message(&mut context).is_pending());
    }

    #[test]
    fn a_response_that_comes_from_another_thread_is_waited_for() {
        let (responder, handle) = open(None);
        assert!(handle.wait_message(Duration::from_millis(1)).is_none());
        let sending = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_millis(20));
            responder.respond(Err(Fault::DeviceLost));
        });
        let started = Instant::now();
        assert_eq!(handle.wait().outcome, Err(Fault::DeviceLost));
        // Nobody waits for the end of a timeout.
        assert!(started.elapsed() < Duration::from_secs(30));
        sending.join().unwrap();
    }

    #[test]
    fn past_its_deadline_a_request_is_answered_so_whoever_polls() {
        let (responder, handle) = open(Some(Instant::now()));
        let mut context = Context::from_waker(Waker::noop());
        let Poll::Ready(Message::Response(late)) = handle.poll_message(&mut context) else {
            panic!("it is late")
        };
        assert_eq!(late.outcome, Err(Fault::DeadlineExceeded));
        // What comes of the work is of no more use.
        responder.respond(Payload::new(&3, Attachments::default(), None));
        assert!(handle.wait_message(Duration::from_millis(1)).is_none());
    }

    #[test]
    fn every_request_is_answered_by_the_first_alone() {
        let (responder, handle) = open(None);
        drop(responder);
        assert!(matches!(handle.wait().outcome, Err(Fault::Internal { .. })));
        let (responder, handle) = open(None);
        handle.cancel_handle().cancel();
        handle.shut_down();
        responder.respond(Payload::new(&3, Attachments::default(), None));
        assert_eq!(handle.wait().outcome, Err(Fault::Cancelled));
    }
}
