//! The responses of one connection that are on their way, in the order of the requests: bounded, and shared by its two threads.
//! Never lives here: waiting for any one of them, and writing it.

use crate::service::ResponseHandle;
use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

pub(super) struct ResponseQueue {
    state: Mutex<State>,
    changed: Condvar,
    most: usize,
}

#[derive(Default)]
struct State {
    responses: VecDeque<ResponseHandle>,
    /// Those in `responses`, and the one being waited for or written.
    in_flight: usize,
    /// No more requests come.
    is_closed: bool,
    /// Nothing can be written any more.
    is_broken: bool,
}

impl ResponseQueue {
    pub(super) fn new(most: usize) -> Self {
        Self {
            state: Mutex::default(),
            changed: Condvar::new(),
            most,
        }
    }

    /// Blocks while as many requests are in flight as may be; `false` where nothing can be written any more.
    pub(super) fn wait_for_space(&self) -> bool {
        let full = |state: &mut State| state.in_flight >= self.most && !state.is_broken;
        let state = self.changed.wait_while(self.lock(), full);
        !state.unwrap_or_else(PoisonError::into_inner).is_broken
    }

    pub(super) fn push(&self, response: ResponseHandle) {
        let mut state = self.lock();
        state.in_flight += 1;
        state.responses.push_back(response);
        self.changed.notify_all();
    }

    pub(super) fn close(&self) {
        self.lock().is_closed = true;
        self.changed.notify_all();
    }

    pub(super) fn is_broken(&self) -> bool {
        self.lock().is_broken
    }

    /// The next response to wait for; `None` after the last.
    pub(super) fn next(&self) -> Option<ResponseHandle> {
        let idle = |state: &mut State| state.responses.is_empty() && !state.is_closed;
        let state = self.changed.wait_while(self.lock(), idle);
        state
            .unwrap_or_else(PoisonError::into_inner)
            .responses
            .pop_front()
    }

    /// The one that [`ResponseQueue::next`] gave is done with.
    pub(super) fn written(&self) {
        self.lock().in_flight -= 1;
        self.changed.notify_all();
    }

    /// Gives up on everything in flight.
    pub(super) fn break_off(&self) {
        let mut state = self.lock();
        state.is_broken = true;
        let abandoned = std::mem::take(&mut state.responses);
        drop(state);
        self.changed.notify_all();
        drop(abandoned);
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // Nothing that holds this lock can leave the state half-written.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
