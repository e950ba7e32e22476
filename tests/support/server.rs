//! A real server on a port of its own, and a client that sends whatever bytes it is told to.

use rigd::server::{Server, Stopper, Timeouts};
use rigd::service::Service;
use serde_json::{Value, json};
use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::{Shutdown, SocketAddr, TcpStream};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;

/// After this long without a byte a test has failed. Only a server that hangs takes so long, on however busy a machine.
pub const PATIENCE: Duration = Duration::from_secs(120);

/// Serves until it is dropped.
pub struct TestServer {
    pub address: SocketAddr,
    stopper: Stopper,
    thread: Option<JoinHandle<io::Result<()>>>,
}

impl TestServer {
    pub fn start(service: &Arc<Service>) -> Self {
        Self::start_with(service, Timeouts::default())
    }

    pub fn start_with(service: &Arc<Service>, timeouts: Timeouts) -> Self {
        let server =
            Server::bind("127.0.0.1:0", Arc::clone(service), timeouts).expect("a free port");
        Self {
            address: server.address().expect("it is bound"),
            stopper: server.stopper().expect("it is bound"),
            thread: Some(std::thread::spawn(move || server.run())),
        }
    }

    pub fn connect(&self) -> Wire {
        Wire::connect(self.address)
    }

    /// Asks it to stop, and does not wait.
    pub fn stop(&self) {
        self.stopper.stop();
    }

    /// Whether it is still serving.
    pub fn is_running(&self) -> bool {
        let thread = self.thread.as_ref();
        thread.is_some_and(|thread| !thread.is_finished())
    }

    /// Waits until it has stopped, and gives what serving came to.
    pub fn wait(&mut self) -> io::Result<()> {
        let thread = self.thread.take().expect("it is waited for once");
        thread.join().expect("the server does not panic")
    }
}

impl Drop for TestServer {
    fn drop(&mut self) {
        self.stop();
        if let Some(thread) = self.thread.take() {
            // A test that has failed already is not to be failed twice.
            let _ = thread.join();
        }
    }
}

/// One connection, byte by byte.
pub struct Wire {
    reader: BufReader<TcpStream>,
    writer: TcpStream,
}

impl Wire {
    pub fn connect(address: SocketAddr) -> Self {
        let writer = TcpStream::connect(address).expect("the server listens");
        writer.set_nodelay(true).expect("a socket");
        writer
            .set_read_timeout(Some(PATIENCE))
            .expect("it is not zero");
        writer
            .set_write_timeout(Some(PATIENCE))
            .expect("it is not zero");
        let reader = BufReader::new(writer.try_clone().expect("a socket"));
        Self { reader, writer }
    }

    /// A second handle, to write from another thread.
    pub fn writer(&self) -> TcpStream {
        self.writer.try_clone().expect("a socket")
    }

    /// To read whatever comes.
    pub fn reader(&mut self) -> &mut impl BufRead {
        &mut self.reader
    }

    pub fn send(&mut self, bytes: impl AsRef<[u8]>) {
        self.writer
            .write_all(bytes.as_ref())
            .expect("the server reads on");
    }

    pub fn request(&mut self, id: impl Into<Value>, method: &str, params: Value) {
        self.send(request(id, method, params));
    }

    /// Says that nothing more will be sent.
    pub fn half_close(&mut self) {
        self.writer
            .shutdown(Shutdown::Write)
            .expect("it is connected");
    }

    /// The next line, with its end; `None` at the end of the stream.
    pub fn line(&mut self) -> Option<String> {
        let mut line = String::new();
        let count = self.reader.read_line(&mut line).expect("a line or an end");
        assert!(
            count == 0 || line.ends_with('\n'),
            "a line without end: {line}"
        );
        (count > 0).then_some(line)
    }

    /// The next line as JSON.
    pub fn reply(&mut self) -> Value {
        let line = self
            .line()
            .expect("a reply, and not the end of the connection");
        serde_json::from_str(&line).expect("JSON")
    }

    /// The next reply's result, which must be for that id.
    pub fn result(&mut self, id: impl Into<Value>) -> Value {
        let mut reply = self.reply();
        assert_eq!(reply["id"], id.into(), "{reply}");
        assert!(reply.get("error").is_none(), "{reply}");
        reply["result"].take()
    }

    /// The `data` of the next reply's error, which must be for that id.
    pub fn error(&mut self, id: impl Into<Value>) -> Value {
        let mut reply = self.reply();
        assert_eq!(reply["id"], id.into(), "{reply}");
        reply["error"]["data"].take()
    }

    /// So many raw bytes.
    pub fn bytes(&mut self, count: usize) -> Vec<u8> {
        let mut bytes = vec![0; count];
        self.reader.read_exact(&mut bytes).expect("that many bytes");
        bytes
    }

    /// The server has closed the connection, in an orderly way and without another word.
    pub fn assert_end(&mut self) {
        let mut rest = Vec::new();
        self.reader
            .read_to_end(&mut rest)
            .expect("an end, and no reset");
        assert!(rest.is_empty(), "{}", rest.escape_ascii());
    }

    /// The connection is as good as ever: nothing unread lies before the answer to this.
    pub fn assert_alive(&mut self) {
        self.request("alive?", "server.ping", json!({}));
        assert_eq!(self.result("alive?"), json!({}));
    }
}

/// A request's line.
pub fn request(id: impl Into<Value>, method: &str, params: Value) -> String {
    let request = json!({"jsonrpc": "2.0", "id": id.into(), "method": method, "params": params});
    format!("{request}\n")
}

/// The parameters of a picture of the built-in figure, `side` pixels square.
pub fn picture(side: u32) -> Value {
    json!({"rig": "figure", "size": [side, side], "samples": 1})
}

/// The file in a picture's blob that came as base64.
pub fn png(frame: &Value) -> Vec<u8> {
    use base64::Engine;
    let blob = &frame["images"]["color"];
    let text = blob["data"].as_str().expect("base64");
    let file = base64::engine::general_purpose::STANDARD
        .decode(text)
        .expect("base64");
    assert_eq!(blob["bytes"], file.len());
    file
}

/// It is a picture of that many pixels to a side.
pub fn assert_is_png(file: &[u8], side: u32) {
    let picture = image::load_from_memory_with_format(file, image::ImageFormat::Png).expect("PNG");
    assert_eq!((picture.width(), picture.height()), (side, side));
}
