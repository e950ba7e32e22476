//! Bare sockets: a client that looks at no more of a reply than it must, a server that echoes, one that only takes in.
//! Never lives here: what is asked for.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::time::Instant;

/// One connection to the daemon.
pub struct Wire {
    reader: BufReader<TcpStream>,
    writer: TcpStream,
    line: Vec<u8>,
    attached: Vec<u8>,
}

/// What came.
#[derive(Debug, PartialEq, Eq)]
pub enum Got {
    Result,
    /// A part of a result that is still to come.
    Notification,
    /// The daemon has no such method.
    NoSuchMethod,
}

impl Wire {
    pub fn connect(address: SocketAddr) -> Self {
        let writer = TcpStream::connect(address).expect("the server listens");
        writer.set_nodelay(true).expect("a socket");
        let reader = writer.try_clone().expect("a socket");
        Self {
            reader: BufReader::with_capacity(1 << 16, reader),
            writer,
            line: Vec::new(),
            attached: Vec::new(),
        }
    }

    pub fn send(&mut self, request: &[u8]) {
        self.writer.write_all(request).expect("the server reads on");
    }

    /// The last reply's.
    pub fn line(&self) -> &[u8] {
        &self.line
    }

    /// # Panics
    /// On an error, which no request here is to meet.
    pub fn receive(&mut self) -> Got {
        self.line.clear();
        let count = self.reader.read_until(b'\n', &mut self.line);
        assert!(count.expect("a line") > 0, "the server hung up");
        let line = std::str::from_utf8(&self.line).expect("JSON");
        // The count is the line's last member; a picture's reply is a kilobyte, a batch's a hundred.
        let count = line
            .rsplit_once("\"attach_bytes\":")
            .map_or(0, |(_, rest)| {
                let digits = rest.trim_end().trim_end_matches('}');
                digits.parse().expect("a number at the end")
            });
        let head = &line[..line.len().min(200)];
        let got = if head.contains("\"method_not_found\"") {
            Got::NoSuchMethod
        } else if head.contains("\"method\":") {
            Got::Notification
        } else {
            assert!(!head.contains("\"error\":"), "{line}");
            Got::Result
        };
        self.attached.resize(count, 0);
        self.reader
            .read_exact(&mut self.attached)
            .expect("what the line announced");
        got
    }
}

/// A request with raw bytes behind its line. Ids may be alike, for nobody here looks at them.
pub fn request(method: &str, params: &str, attached: &[u8]) -> Vec<u8> {
    let mut line =
        format!("{{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"{method}\",\"params\":{params}");
    if !attached.is_empty() {
        line += &format!(",\"attach_bytes\":{}", attached.len());
    }
    line += "}\n";
    let mut request = line.into_bytes();
    request.extend_from_slice(attached);
    request
}

/// Listens until the process ends, with a thread for each connection: for every line the same reply.
pub fn echo(reply: Vec<u8>) -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = listener.local_addr().expect("it is bound");
    std::thread::spawn(move || {
        for stream in listener.incoming() {
            let (mut stream, reply) = (stream.expect("a connection"), reply.clone());
            std::thread::spawn(move || {
                stream.set_nodelay(true).expect("a socket");
                let mut reader = BufReader::new(stream.try_clone().expect("a socket"));
                let mut line = Vec::new();
                while reader
                    .read_until(b'\n', &mut line)
                    .is_ok_and(|count| count > 0)
                {
                    if stream.write_all(&reply).is_err() {
                        return;
                    }
                    line.clear();
                }
            });
        }
    });
    address
}

/// A connection whose other end takes in whatever comes.
pub fn drain() -> TcpStream {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = listener.local_addr().expect("it is bound");
    let writer = TcpStream::connect(address).expect("it listens");
    let (mut reader, _) = listener.accept().expect("the connection");
    std::thread::spawn(move || {
        let mut bytes = vec![0; 1 << 16];
        while reader.read(&mut bytes).is_ok_and(|count| count > 0) {}
    });
    writer
}

/// Seconds from one reply to the next where all requests and all replies are alike, so many requests written at a time.
pub fn pings(
    address: SocketAddr,
    request: &[u8],
    reply_bytes: usize,
    at_a_time: usize,
    count: usize,
) -> f64 {
    let mut stream = TcpStream::connect(address).expect("the server listens");
    stream.set_nodelay(true).expect("a socket");
    let requests = request.repeat(at_a_time);
    let mut replies = vec![0; reply_bytes * at_a_time];
    let portions = count.div_ceil(at_a_time);
    let started = Instant::now();
    // Of a pipeline one portion is always on its way while another is read.
    let ahead = usize::from(at_a_time > 1);
    for portion in 0..portions + ahead {
        if portion < portions {
            stream.write_all(&requests).expect("the server reads on");
        }
        if portion >= ahead {
            stream.read_exact(&mut replies).expect("the replies");
        }
    }
    started.elapsed().as_secs_f64() / (portions * at_a_time) as f64
}
