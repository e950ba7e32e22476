//! The daemon in this process, asked over loopback. Never lives here: what it is compared with.

use crate::scenes::{Shots, Subject};
use crate::wire::{Got, Wire, request};
use rigd::engine::{Engine, RendererChoice};
use rigd::formats::Source;
use rigd::limits::Limits;
use rigd::server::{Server, Stopper, Timeouts};
use rigd::service::Service;
use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Instant;

/// Serves until it is dropped.
pub struct Daemon {
    pub service: Arc<Service>,
    pub address: SocketAddr,
    stopper: Stopper,
    thread: Option<JoinHandle<io::Result<()>>>,
}

impl Daemon {
    pub fn open(adapter: &str) -> Self {
        let Ok(adapter) = adapter.parse();
        let choice = RendererChoice {
            adapter,
            ..RendererChoice::default()
        };
        let engine = Engine::open(choice, Limits::default()).expect("a graphics adapter");
        let service = Service::new(engine, Source::inline_only());
        let server = Server::bind("127.0.0.1:0", Arc::clone(&service), Timeouts::default())
            .expect("a free port");
        Self {
            service,
            address: server.address().expect("it is bound"),
            stopper: server.stopper().expect("it is bound"),
            thread: Some(std::thread::spawn(move || server.run())),
        }
    }

    pub fn engine(&self) -> &Engine {
        self.service.engine()
    }

    /// Seconds a request, over `count` of them, from so many clients with so many in flight each.
    pub fn ask(
        &self,
        clients: usize,
        in_flight: usize,
        count: usize,
        request: impl Fn(usize) -> Vec<u8> + Sync,
    ) -> f64 {
        ask(self.address, clients, in_flight, count, request)
    }

    /// Seconds a picture.
    pub fn frames(
        &self,
        subject: &Subject,
        shots: Shots,
        clients: usize,
        in_flight: usize,
        count: usize,
    ) -> f64 {
        self.ask(clients, in_flight, count, |index| {
            request("frame.render", &shots.params(subject, index), &[])
        })
    }

    /// Seconds a picture of requests for so many each, so many requests in flight.
    pub fn batches(
        &self,
        subject: &Subject,
        shots: Shots,
        batch: Batch,
        in_flight: usize,
        count: usize,
    ) -> f64 {
        let Batch { frames, stream } = batch;
        let seconds = self.ask(1, in_flight, count.div_ceil(frames), |index| {
            let params = shots.batch_params(subject, index * frames, frames, stream);
            request("frame.batch", &params, &[])
        });
        seconds / frames as f64
    }

    pub fn has_batches(&self, subject: &Subject) -> bool {
        let mut wire = Wire::connect(self.address);
        let params = Shots::new(8, 1).batch_params(subject, 0, 1, false);
        wire.send(&request("frame.batch", &params, &[]));
        wire.receive() == Got::Result
    }
}

/// A request for several pictures.
#[derive(Clone, Copy)]
pub struct Batch {
    pub frames: usize,
    /// Whether each is sent once it is done.
    pub stream: bool,
}

impl Drop for Daemon {
    fn drop(&mut self) {
        self.stopper.stop();
        if let Some(thread) = self.thread.take() {
            // A run that has failed already is not to be failed twice.
            let _ = thread.join();
        }
    }
}

/// Seconds a request, over `count` of them, from so many clients with so many in flight each.
pub fn ask(
    address: SocketAddr,
    clients: usize,
    in_flight: usize,
    count: usize,
    request: impl Fn(usize) -> Vec<u8> + Sync,
) -> f64 {
    let wires: Vec<Wire> = (0..clients).map(|_| Wire::connect(address)).collect();
    let of_each = count.div_ceil(clients);
    let request = &request;
    let started = Instant::now();
    std::thread::scope(|scope| {
        for (client, mut wire) in wires.into_iter().enumerate() {
            scope.spawn(move || {
                let number = |index: usize| client * of_each + index;
                for index in 0..in_flight.min(of_each) {
                    wire.send(&request(number(index)));
                }
                for done in 0..of_each {
                    while wire.receive() == Got::Notification {}
                    if done + in_flight < of_each {
                        wire.send(&request(number(done + in_flight)));
                    }
                }
            });
        }
    });
    started.elapsed().as_secs_f64() / (of_each * clients) as f64
}
