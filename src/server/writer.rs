//! The writing half of a connection: replies in the order of their requests.

use super::Shared;
use super::lines::is_timeout;
use crate::service::{Outgoing, Part, Pending, turned_away};
use std::collections::VecDeque;
use std::io::{ErrorKind, IoSlice, Write};
use std::net::{Shutdown, TcpStream};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Replies that are on their way, in order; bounded, and shared by the two threads of a connection.
pub(super) struct Queue {
    state: Mutex<State>,
    changed: Condvar,
    most: usize,
}

struct State {
    pending: VecDeque<Pending>,
    /// Those in `pending`, and the one being waited for or written.
    in_flight: usize,
    /// No more requests come.
    is_closed: bool,
    /// Replies can no longer be written.
    is_broken: bool,
}

impl Queue {
    pub fn new(most: usize) -> Self {
        let state = State {
            pending: VecDeque::new(),
            in_flight: 0,
            is_closed: false,
            is_broken: false,
        };
        Self {
            state: Mutex::new(state),
            changed: Condvar::new(),
            most,
        }
    }

    /// Blocks while as many requests are in flight as may be; `false` where replies can no longer be written.
    pub fn wait_for_room(&self) -> bool {
        let full = |state: &mut State| state.in_flight >= self.most && !state.is_broken;
        let state = self.changed.wait_while(self.lock(), full);
        !state.unwrap_or_else(PoisonError::into_inner).is_broken
    }

    pub fn push(&self, pending: Pending) {
        let mut state = self.lock();
        state.in_flight += 1;
        state.pending.push_back(pending);
        self.changed.notify_all();
    }

    pub fn close(&self) {
        self.lock().is_closed = true;
        self.changed.notify_all();
    }

    pub fn is_broken(&self) -> bool {
        self.lock().is_broken
    }

    /// The next reply to wait for; `None` after the last.
    fn next(&self) -> Option<Pending> {
        let idle = |state: &mut State| state.pending.is_empty() && !state.is_closed;
        let state = self.changed.wait_while(self.lock(), idle);
        state
            .unwrap_or_else(PoisonError::into_inner)
            .pending
            .pop_front()
    }

    fn written(&self) {
        self.lock().in_flight -= 1;
        self.changed.notify_all();
    }

    /// Gives up on everything in flight.
    fn break_off(&self) {
        let mut state = self.lock();
        state.is_broken = true;
        let abandoned = std::mem::take(&mut state.pending);
        drop(state);
        self.changed.notify_all();
        drop(abandoned);
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // Nothing that holds this lock can leave the state half-written.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// How often a wait for a reply, or for a client to take it in, looks whether the grace time is over.
pub(super) const TICK: Duration = Duration::from_millis(100);

/// Writes replies until there are no more, or the client takes no more.
pub(super) fn run(shared: &Shared, stream: &TcpStream, queue: &Queue) {
    while let Some(pending) = queue.next() {
        let mut is_answered = false;
        while !is_answered {
            let outgoing = wait(shared, &pending);
            if write(shared, stream, &outgoing).is_err() {
                // Wakes the reading half as well.
                let _ = stream.shutdown(Shutdown::Both);
                return queue.break_off();
            }
            // With it, room for the reply is given back before the place of its request.
            is_answered = outgoing.is_last;
        }
        queue.written();
    }
}

fn wait(shared: &Shared, pending: &Pending) -> Outgoing {
    loop {
        // What has a reply already keeps it; nothing else is waited for any more.
        if shared.grace_end().is_some_and(|end| Instant::now() >= end) {
            pending.shut_down();
        }
        if let Some(reply) = pending.wait_for(TICK) {
            return reply;
        }
    }
}

/// Writes a message in one piece, as far as the socket takes it: in several, its client would be woken for each. Waits for a client to take
/// everything in, but not for ever, and hardly at all once the server has stopped waiting for anything.
fn write(shared: &Shared, mut stream: &TcpStream, message: &Outgoing) -> std::io::Result<()> {
    let parts = message.attachments.iter().map(Part::bytes);
    let pieces = std::iter::once(message.line.as_slice()).chain(parts);
    let mut pieces: Vec<IoSlice<'_>> = pieces.map(IoSlice::new).collect();
    let bytes: usize = pieces.iter().map(|piece| piece.len()).sum();
    let mut rest = pieces.as_mut_slice();
    let mut taken = Instant::now();
    // Passes over pieces of nothing.
    IoSlice::advance_slices(&mut rest, 0);
    while !rest.is_empty() {
        match stream.write_vectored(rest) {
            Ok(0) => return Err(ErrorKind::WriteZero.into()),
            Ok(count) => {
                IoSlice::advance_slices(&mut rest, count);
                taken = Instant::now();
            }
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) if is_timeout(&error) => {
                if taken.elapsed() >= shared.patience.stalled || shared.is_done_listening() {
                    return Err(error);
                }
            }
            Err(error) => return Err(error),
        }
    }
    shared.service.stats().wrote_bytes(bytes);
    Ok(())
}

/// Tells a client that it is one too many; its stream is to be kept a little, so that it can read that.
pub(super) fn turn_away(mut stream: &TcpStream, maximum: u64, asked: u64) {
    // A peer that does not take one line in this time does without it: the listener has others to see to.
    let _ = stream.set_write_timeout(Some(TICK));
    let _ = stream.write_all(&turned_away(maximum, asked));
    let _ = stream.shutdown(Shutdown::Write);
}
