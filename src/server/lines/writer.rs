//! The writing half of a connection: responses in the order of their requests. Never lives here: JSON.

use super::queue::ResponseQueue;
use super::reader::is_timeout;
use super::shared::Shared;
use crate::limits::LimitExceeded;
use crate::server::envelope::{Envelope, unasked};
use crate::service::{Message, ResponseHandle};
use std::io::{ErrorKind, IoSlice, Write};
use std::net::{Shutdown, TcpStream};
use std::time::{Duration, Instant};

/// How often a wait for a response, or for a client to take it in, looks whether the grace time is over.
pub(super) const TICK: Duration = Duration::from_millis(100);

/// Writes responses until there are no more, or the client takes no more.
pub(super) fn run(shared: &Shared, stream: &TcpStream, queue: &ResponseQueue) {
    while let Some(response) = queue.next() {
        let mut is_answered = false;
        while !is_answered {
            let envelope = Envelope::from(wait(shared, &response));
            if write(shared, stream, &envelope).is_err() {
                // Wakes the reading half as well.
                let _ = stream.shutdown(Shutdown::Both);
                return queue.break_off();
            }
            is_answered = envelope.is_last;
            // Memory for the response is given back before the place of its request.
            drop(envelope);
        }
        queue.written();
    }
}

fn wait(shared: &Shared, response: &ResponseHandle) -> Message {
    loop {
        // What has a response already keeps it; nothing else is waited for any more.
        if shared.shutdown.is_grace_over() {
            response.shut_down();
        }
        if let Some(message) = response.wait_message(TICK) {
            return message;
        }
    }
}

/// The line, and what follows it.
fn pieces(envelope: &Envelope) -> Vec<IoSlice<'_>> {
    let Envelope {
        head, body, tail, ..
    } = envelope;
    let line = [head, body, tail, "\n"].map(|text: &str| text.as_bytes());
    let attachments = envelope.attachments.iter().map(AsRef::as_ref);
    line.into_iter()
        .chain(attachments)
        .map(IoSlice::new)
        .collect()
}

/// Writes a message in one go, as far as the socket takes it: in several, its client would be woken for each. Waits for a client to take
/// everything in, but not for ever, and hardly at all once the server has stopped waiting for anything.
fn write(shared: &Shared, mut stream: &TcpStream, envelope: &Envelope) -> std::io::Result<()> {
    let mut pieces = pieces(envelope);
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
                if taken.elapsed() >= shared.timeouts.stalled || shared.shutdown.is_over() {
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
pub(super) fn turn_away(mut stream: &TcpStream, exceeded: LimitExceeded) {
    // A peer that does not take one line in this time does without it: the listener has others to see to.
    let _ = stream.set_write_timeout(Some(TICK));
    let Envelope {
        head, body, tail, ..
    } = unasked(exceeded.into());
    let _ = stream.write_all((head + &body + &tail + "\n").as_bytes());
    let _ = stream.shutdown(Shutdown::Write);
}
