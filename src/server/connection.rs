//! One connection: this thread reads and acts, another writes replies in the order of the requests.

use super::lines::{Lines, Next, Wait, is_timeout};
use super::writer::{self, Queue};
use super::{Place, Shared};
use crate::service::{Conversation, Message};
use std::io::Read;
use std::net::{Shutdown, TcpStream};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How often a silent connection looks whether the server stops.
const TICK: Duration = Duration::from_millis(100);
/// Once it stops, how long a silence means that nothing more has arrived.
const LAST_TICK: Duration = Duration::from_millis(20);
/// How long input is thrown away so that the last reply is not lost to a reset.
const LINGER: Duration = Duration::from_secs(1);

/// Serves `stream` until either side is done with it.
pub(super) fn run(shared: &Arc<Shared>, stream: &TcpStream, place: Place) {
    if prepare(stream).is_err() {
        // The peer is gone already.
        return;
    }
    let in_flight = shared.service.limits().in_flight_per_connection as usize;
    let queue = Queue::new(in_flight);
    std::thread::scope(|scope| {
        let queue = &queue;
        // Even where reading panics: the scope waits for the other thread, and that one for this.
        let _closed_at_the_end = Closing(queue);
        let writing = std::thread::Builder::new()
            .name("replies".to_owned())
            .spawn_scoped(scope, move || writer::run(shared, stream, queue));
        // Without a second thread there is nobody to answer.
        if writing.is_ok() {
            read(shared, stream, queue);
        }
    });
    linger(stream);
    drop(place);
}

/// Tells the writing half, on drop, that no more requests come.
struct Closing<'a>(&'a Queue);

impl Drop for Closing<'_> {
    fn drop(&mut self) {
        self.0.close();
    }
}

fn prepare(stream: &TcpStream) -> std::io::Result<()> {
    // A socket of a non-blocking listener is non-blocking itself on some systems.
    stream.set_nonblocking(false)?;
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(TICK))?;
    stream.set_write_timeout(Some(writer::TICK))
}

/// Reads messages and begins each, until there are no more or one cannot be followed by another.
fn read(shared: &Shared, stream: &TcpStream, queue: &Queue) {
    let limits = shared.service.limits();
    let mut conversation = shared.service.converse();
    let mut lines = Lines::new(stream, limits.line_bytes as usize, shared.patience.stalled);
    let wait = || {
        if queue.is_broken() {
            return Wait::Stop;
        }
        if shared.is_stopping() {
            // What has arrived is read without waiting for more.
            let _ = stream.set_read_timeout(Some(LAST_TICK));
            return Wait::Stop;
        }
        Wait::GoOn
    };
    let on_bytes = |count| shared.service.stats().read_bytes(count);
    let mut is_first = true;
    // Back-pressure: no line is read before there is room for its reply.
    while queue.wait_for_room() {
        // What had arrived is still answered when the grace time is over, but a client that goes on asking is not heard for ever.
        if shared.is_done_listening() {
            return;
        }
        let message = match lines.next_line(&wait, &on_bytes) {
            Next::End => return,
            Next::TooLong => {
                return answer(
                    &mut conversation,
                    queue,
                    Message::too_long(limits),
                    Vec::new(),
                );
            }
            Next::Unended(line) => {
                if let Some(message) = Message::read_unended(&line, Instant::now()) {
                    answer(&mut conversation, queue, message, Vec::new());
                }
                return;
            }
            Next::Line(line) if is_first && is_http(&line) => return,
            Next::Line(line) => Message::read(&line, Instant::now()),
        };
        is_first = false;
        let _room;
        let attached = match message.attach_bytes() {
            Some(0) => Vec::new(),
            Some(asked) if asked > limits.attachment_bytes => {
                let refused = message.attaching_too_much(limits);
                return answer(&mut conversation, queue, refused, Vec::new());
            }
            Some(count) => {
                // Where others bring too much along already, this one's bytes wait in its own socket.
                _room = loop {
                    // On a stop only what has arrived is read, and that lies in the socket's own buffer already.
                    let room = conversation.room_for(count);
                    if room.is_some() || matches!(wait(), Wait::Stop) {
                        break room;
                    }
                    std::thread::sleep(LAST_TICK);
                };
                match lines.next_bytes(count as usize, &wait, &on_bytes) {
                    Some(attached) => attached,
                    None => return,
                }
            }
            None => return answer(&mut conversation, queue, message, Vec::new()),
        };
        answer(&mut conversation, queue, message, attached);
    }
}

fn answer(conversation: &mut Conversation, queue: &Queue, message: Message, attached: Vec<u8>) {
    if let Some(pending) = conversation.begin(message, attached) {
        queue.push(pending);
    }
}

/// A browser that was talked into sending a request here gets nothing to work with.
fn is_http(line: &[u8]) -> bool {
    // Whatever the method is called.
    let last_word = line.rsplit(|&byte| byte == b' ').next().unwrap_or_default();
    last_word.len() < line.len() && last_word.starts_with(b"HTTP/")
}

/// Closes gently: what the client still sends is thrown away for a while.
fn linger(stream: &TcpStream) {
    let until = Instant::now() + LINGER;
    if stream.shutdown(Shutdown::Write).is_err()
        || stream.set_read_timeout(Some(LAST_TICK)).is_err()
    {
        return;
    }
    let mut trash = [0; 4096];
    let mut stream = stream;
    while Instant::now() < until {
        match stream.read(&mut trash) {
            Ok(0) => return,
            Ok(_) => {}
            Err(error) if is_timeout(&error) => {}
            Err(_) => return,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::is_http;

    #[test]
    fn http_is_told_from_json() {
        for line in [
            "GET / HTTP/1.1",
            "POST /x HTTP/1.0",
            "PRI * HTTP/2.0",
            "PROPFIND / HTTP/1.1",
        ] {
            assert!(is_http(line.as_bytes()), "{line}");
        }
        for line in [
            "{\"jsonrpc\":\"2.0\"}",
            "GETTING",
            "GET",
            " GET /",
            "HTTP/1.1",
        ] {
            assert!(!is_http(line.as_bytes()), "{line}");
        }
    }
}
