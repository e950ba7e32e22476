//! One connection: this thread reads and acts, another writes responses in the order of the requests.
//! Never lives here: where a line ends, and what is in it.

use super::line::Line;
use super::queue::ResponseQueue;
use super::reader::{LineReader, Next, Wait, is_timeout};
use super::shared::Shared;
use super::writer;
use crate::service::{Permit, Session};
use bytes::Bytes;
use std::io::Read;
use std::net::{Shutdown, TcpStream};
use std::time::{Duration, Instant};

/// How often a silent connection looks whether the server stops.
const TICK: Duration = Duration::from_millis(100);
/// Once it stops, how long a silence means that nothing more has arrived.
const LAST_TICK: Duration = Duration::from_millis(20);
/// How long input is thrown away so that the last reply is not lost to a reset.
const LINGER: Duration = Duration::from_secs(1);

/// Serves `stream` until either side is done with it.
pub(super) fn run(shared: &Shared, stream: &TcpStream) {
    if prepare(stream).is_err() {
        // The peer is gone already.
        return;
    }
    let in_flight = shared.service.limits().in_flight_per_connection as usize;
    let queue = ResponseQueue::new(in_flight);
    std::thread::scope(|scope| {
        let queue = &queue;
        // Even where reading panics: the scope waits for the other thread, and that one for this.
        let _closed_at_the_end = Closing(queue);
        let writing = std::thread::Builder::new()
            .name("replies".to_owned())
            .spawn_scoped(scope, move || writer::run(shared, stream, queue));
        // Without a second thread there is nobody to answer.
        if writing.is_ok() {
            Reading::new(shared, stream, queue).run();
        }
    });
    linger(stream);
}

/// Tells the writing half, on drop, that no more requests come.
struct Closing<'a>(&'a ResponseQueue);

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

/// The reading half.
struct Reading<'a> {
    shared: &'a Shared,
    stream: &'a TcpStream,
    queue: &'a ResponseQueue,
    session: Session,
    lines: LineReader<&'a TcpStream>,
}

/// Whether another line may be read behind one.
#[derive(PartialEq, Eq)]
enum Then {
    ReadOn,
    Close,
}

impl<'a> Reading<'a> {
    fn new(shared: &'a Shared, stream: &'a TcpStream, queue: &'a ResponseQueue) -> Self {
        let limits = shared.service.limits();
        Self {
            shared,
            stream,
            queue,
            session: shared.service.session(),
            lines: LineReader::new(stream, limits.line_bytes as usize, shared.timeouts.stalled),
        }
    }

    /// Reads messages and begins each, until there are no more or one cannot be followed by another.
    fn run(mut self) {
        let mut is_first = true;
        // Back-pressure: no line is read before there is room for its reply.
        while self.queue.wait_for_space() {
            // What had arrived is still answered when the grace time is over, but a client that goes on asking is not heard for ever.
            if self.shared.shutdown.is_over() || self.next(is_first) == Then::Close {
                return;
            }
            is_first = false;
        }
    }

    fn next(&mut self, is_first: bool) -> Then {
        let (shared, stream, queue) = (self.shared, self.stream, self.queue);
        let wait = || wait(shared, stream, queue);
        let on_bytes = |count| shared.service.stats().read_bytes(count);
        let limits = shared.service.limits();
        match self.lines.next_line(&wait, &on_bytes) {
            Next::End => Then::Close,
            Next::TooLong => {
                let exceeded = limits.line_bytes(limits.line_bytes.saturating_add(1));
                if let Err(exceeded) = exceeded {
                    self.begin(Line::too_long(exceeded), Bytes::new());
                }
                Then::Close
            }
            Next::Unended(line) => {
                if let Some(line) = Line::read_unended(&line) {
                    self.begin(line, Bytes::new());
                }
                Then::Close
            }
            Next::Line(line) if is_first && is_http(&line) => Then::Close,
            Next::Line(line) => {
                let line = Line::read(&line).within(limits);
                let Some(count) = line.attach_bytes() else {
                    self.begin(line, Bytes::new());
                    return Then::Close;
                };
                let Some((attached, permit)) = self.attached(count) else {
                    return Then::Close;
                };
                self.begin(line, attached);
                drop(permit);
                Then::ReadOn
            }
        }
    }

    /// The raw bytes behind a line; `None` where they do not all come.
    fn attached(&mut self, count: u64) -> Option<(Bytes, Option<Permit>)> {
        if count == 0 {
            return Some((Bytes::new(), None));
        }
        let (shared, stream, queue) = (self.shared, self.stream, self.queue);
        let wait = || wait(shared, stream, queue);
        let on_bytes = |count| shared.service.stats().read_bytes(count);
        // Where others bring too much along already, this one's bytes wait in its own socket.
        let permit = loop {
            let permit = self.session.reserve_attachment(count);
            // On a stop only what has arrived is read, and that lies in the socket's own buffer already.
            if permit.is_some() || matches!(wait(), Wait::Stop) {
                break permit;
            }
            std::thread::sleep(LAST_TICK);
        };
        let bytes = self.lines.next_bytes(count as usize, &wait, &on_bytes)?;
        Some((bytes.into(), permit))
    }

    fn begin(&mut self, line: Line, attached: Bytes) {
        if let Some(response) = line.begin(&mut self.session, attached) {
            self.queue.push(response);
        }
    }
}

/// Whether to wait for more bytes.
fn wait(shared: &Shared, stream: &TcpStream, queue: &ResponseQueue) -> Wait {
    if queue.is_broken() {
        return Wait::Stop;
    }
    if shared.shutdown.is_asked() {
        // What has arrived is read without waiting for more.
        let _ = stream.set_read_timeout(Some(LAST_TICK));
        return Wait::Stop;
    }
    Wait::GoOn
}

/// A web page can make a browser send HTTP requests to any port: they are refused before anything of them is acted on.
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
