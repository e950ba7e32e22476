//! From a stream of bytes to bounded lines and the raw bytes between them. Never lives here: what is in a line.

use std::io::{self, ErrorKind, Read};
use std::time::{Duration, Instant};

/// What came next.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Next {
    /// Without its end. Blank lines are passed over.
    Line(Vec<u8>),
    /// What the client sent after the last line end before it closed its half: a whole line perhaps, or the start of one.
    Unended(Vec<u8>),
    /// The line grew past the limit; where the next one starts is not looked for.
    TooLong,
    /// No more will come: the client is done, is gone, or stopped in the middle of a message.
    End,
}

/// What waiting for bytes came to.
#[derive(PartialEq, Eq)]
enum Filled {
    More,
    /// The client has closed its half.
    Closed,
    /// The client is gone or was given up.
    Lost,
}

/// Reads a client's bytes, never keeping more than a limit allows.
pub(super) struct LineReader<R> {
    stream: R,
    buffer: Vec<u8>,
    /// What stands before this in `buffer` has been given away.
    start: usize,
    /// How far `buffer` has been searched for the end of a line.
    searched: usize,
    line_limit: usize,
    stalled: Duration,
}

/// Asked between two waits for bytes: whether to go on waiting.
pub(super) enum Wait {
    GoOn,
    /// Take what is there and no more.
    Stop,
}

/// What one read can bring.
const CHUNK: usize = 64 << 10;

impl<R: Read> LineReader<R> {
    /// The stream's reads are to time out, so that `wait` is asked now and then.
    pub(super) fn new(stream: R, line_limit: usize, stalled: Duration) -> Self {
        Self {
            stream,
            buffer: Vec::new(),
            start: 0,
            searched: 0,
            line_limit,
            stalled,
        }
    }

    /// `on_bytes` hears of each read's length.
    pub(super) fn next_line(
        &mut self,
        wait: &impl Fn() -> Wait,
        on_bytes: &impl Fn(usize),
    ) -> Next {
        loop {
            let found = self.buffer[self.searched..]
                .iter()
                .position(|&byte| byte == b'\n');
            let end = found.map_or(self.buffer.len(), |at| self.searched + at);
            if end - self.start > self.line_limit {
                return Next::TooLong;
            }
            if found.is_none() {
                self.searched = end;
                let room = self.line_limit + 1 - (end - self.start);
                match self.fill(room, end > self.start, wait, on_bytes) {
                    Filled::More => continue,
                    Filled::Closed if !is_blank(&self.buffer) => {
                        return Next::Unended(std::mem::take(&mut self.buffer));
                    }
                    Filled::Closed | Filled::Lost => return Next::End,
                }
            }
            let mut line = self.take(end + 1 - self.start);
            line.pop();
            if line.last() == Some(&b'\r') {
                line.pop();
            }
            if !is_blank(&line) {
                return Next::Line(line);
            }
        }
    }

    /// The next `count` bytes as they are; `None` where they do not all come.
    pub(super) fn next_bytes(
        &mut self,
        count: usize,
        wait: &impl Fn() -> Wait,
        on_bytes: &impl Fn(usize),
    ) -> Option<Vec<u8>> {
        while self.buffer.len() - self.start < count {
            let room = count - (self.buffer.len() - self.start);
            if self.fill(room, true, wait, on_bytes) != Filled::More {
                return None;
            }
        }
        Some(self.take(count))
    }

    fn take(&mut self, count: usize) -> Vec<u8> {
        let end = self.start + count;
        if end < self.buffer.len() {
            let taken = self.buffer[self.start..end].to_vec();
            self.start = end;
            self.searched = end;
            return taken;
        }
        // Nothing else is there: the whole buffer goes, and with it the room that a long line took.
        let mut taken = std::mem::take(&mut self.buffer);
        taken.drain(..self.start);
        self.start = 0;
        self.searched = 0;
        taken
    }

    /// Reads at least one byte and at most `room`, behind what is left of the buffer. Only in the middle of a message is a silent client
    /// given up.
    fn fill(
        &mut self,
        room: usize,
        is_mid_message: bool,
        wait: &impl Fn() -> Wait,
        on_bytes: &impl Fn(usize),
    ) -> Filled {
        self.buffer.drain(..self.start);
        self.searched -= self.start;
        self.start = 0;
        let old = self.buffer.len();
        self.buffer.resize(old + room.clamp(1, CHUNK), 0);
        let started = Instant::now();
        let (filled, count) = loop {
            match self.stream.read(&mut self.buffer[old..]) {
                Ok(0) => break (Filled::Closed, 0),
                Ok(count) => break (Filled::More, count),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if is_timeout(&error) => {
                    if matches!(wait(), Wait::Stop)
                        || (is_mid_message && started.elapsed() >= self.stalled)
                    {
                        break (Filled::Lost, 0);
                    }
                }
                Err(_) => break (Filled::Lost, 0),
            }
        };
        self.buffer.truncate(old + count);
        on_bytes(count);
        filled
    }
}

fn is_blank(line: &[u8]) -> bool {
    line.iter().all(u8::is_ascii_whitespace)
}

pub(super) fn is_timeout(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gives its pieces one read at a time.
    struct Pieces(std::collections::VecDeque<Vec<u8>>);

    impl Read for Pieces {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let Some(mut piece) = self.0.pop_front() else {
                return Ok(0);
            };
            let count = piece.len().min(buffer.len());
            buffer[..count].copy_from_slice(&piece[..count]);
            if count < piece.len() {
                self.0.push_front(piece.split_off(count));
            }
            Ok(count)
        }
    }

    fn lines(pieces: &[&str], limit: usize) -> LineReader<Pieces> {
        let pieces = pieces
            .iter()
            .map(|piece| piece.as_bytes().to_vec())
            .collect();
        LineReader::new(Pieces(pieces), limit, Duration::from_secs(1))
    }

    fn all(mut lines: LineReader<Pieces>) -> Vec<Next> {
        let mut found = Vec::new();
        loop {
            let next = lines.next_line(&|| Wait::GoOn, &|_| {});
            let is_last = !matches!(next, Next::Line(_));
            found.push(next);
            if is_last {
                return found;
            }
        }
    }

    #[test]
    fn lines_are_found_wherever_the_pieces_break() {
        let line = |text: &str| Next::Line(text.as_bytes().to_vec());
        for (pieces, wanted) in [
            (vec!["a\nb\n"], vec![line("a"), line("b"), Next::End]),
            (
                vec!["a", "b\r", "\nc\n"],
                vec![line("ab"), line("c"), Next::End],
            ),
            (vec!["\n \r\n\n", "x\n"], vec![line("x"), Next::End]),
            (vec![], vec![Next::End]),
        ] {
            assert_eq!(all(lines(&pieces, 100)), wanted, "{pieces:?}");
        }
    }

    #[test]
    fn what_has_no_line_end_is_given_where_the_client_closed_its_half() {
        let line = |text: &str| Next::Line(text.as_bytes().to_vec());
        let unended = |text: &str| Next::Unended(text.as_bytes().to_vec());
        for (pieces, wanted) in [
            (vec!["a\nha", "lf"], vec![line("a"), unended("half")]),
            (vec!["a\r"], vec![unended("a\r")]),
            (vec!["a\n \t\r"], vec![line("a"), Next::End]),
            (vec!["0123456789"], vec![unended("0123456789")]),
            (vec!["0123456789x"], vec![Next::TooLong]),
        ] {
            assert_eq!(all(lines(&pieces, 10)), wanted, "{pieces:?}");
        }
        // A client that is gone or silent has not said that this was all.
        for kind in [ErrorKind::ConnectionReset, ErrorKind::WouldBlock] {
            let stream = b"half".chain(Failing(kind));
            let mut reader = LineReader::new(stream, 10, Duration::ZERO);
            assert_eq!(
                reader.next_line(&|| Wait::GoOn, &|_| {}),
                Next::End,
                "{kind}"
            );
        }
    }

    struct Failing(ErrorKind);

    impl Read for Failing {
        fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
            Err(self.0.into())
        }
    }

    #[test]
    fn a_line_may_be_as_long_as_the_limit_and_no_longer() {
        let of = |length: usize| format!("{}\n", "x".repeat(length));
        assert!(matches!(&all(lines(&[&of(10)], 10))[0], Next::Line(line) if line.len() == 10));
        assert_eq!(all(lines(&[&of(11)], 10)), [Next::TooLong]);
        let endless = "x".repeat(1 << 20);
        let mut reader = lines(&[&endless], 10);
        assert_eq!(reader.next_line(&|| Wait::GoOn, &|_| {}), Next::TooLong);
        assert!(
            reader.buffer.len() <= 11,
            "no more than the limit is ever kept"
        );
    }

    #[test]
    fn raw_bytes_stand_between_lines() {
        let mut reader = lines(&["head\n\n\0ra", "w!tail\n"], 100);
        assert_eq!(
            reader.next_line(&|| Wait::GoOn, &|_| {}),
            Next::Line(b"head".to_vec())
        );
        assert_eq!(
            reader.next_bytes(6, &|| Wait::GoOn, &|_| {}),
            Some(b"\n\0raw!".to_vec())
        );
        assert_eq!(
            reader.next_line(&|| Wait::GoOn, &|_| {}),
            Next::Line(b"tail".to_vec())
        );
        assert_eq!(reader.next_bytes(1, &|| Wait::GoOn, &|_| {}), None);
    }
}
