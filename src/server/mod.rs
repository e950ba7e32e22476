//! Sockets: a listener, two threads for each connection, and an orderly end. Knows no method.
//! Never lives here: what a line means.

mod connection;
mod lines;
mod writer;

use crate::service::Service;
use std::collections::VecDeque;
use std::io;
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// How patient the server is.
#[derive(Debug, Clone, Copy)]
pub struct Patience {
    /// After a stop was asked for, until requests in hand are answered with `shutting_down`.
    pub grace: Duration,
    /// With a client that takes in nothing of its reply, or stops in the middle of a message.
    pub stalled: Duration,
}

impl Default for Patience {
    fn default() -> Self {
        Self {
            grace: Duration::from_secs(10),
            stalled: Duration::from_secs(60),
        }
    }
}

/// After the grace time, how long requests are still read and replies still written: each is told that it came too late.
const LAST_WORDS: Duration = Duration::from_secs(1);

/// A bound listener that has not accepted anybody yet.
pub struct Server {
    listener: TcpListener,
    shared: Arc<Shared>,
}

/// Asks a [`Server`] to stop, from any thread.
#[derive(Clone)]
pub struct Stopper {
    shared: Arc<Shared>,
    address: SocketAddr,
}

struct Shared {
    service: Arc<Service>,
    patience: Patience,
    stopping: AtomicBool,
    /// When the stop was asked for.
    stop_asked: Mutex<Option<Instant>>,
    connections: AtomicU64,
}

impl Server {
    /// # Errors
    /// Where the address cannot be listened on.
    pub fn bind(address: &str, service: Arc<Service>, patience: Patience) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        let shared = Shared {
            service,
            patience,
            stopping: AtomicBool::new(false),
            stop_asked: Mutex::new(None),
            connections: AtomicU64::new(0),
        };
        Ok(Self {
            listener,
            shared: Arc::new(shared),
        })
    }

    /// Where it listens, with the port that the system chose for port 0.
    ///
    /// # Errors
    /// As the system has them.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.listener.local_addr()
    }

    /// # Errors
    /// As [`Server::address`].
    pub fn stopper(&self) -> io::Result<Stopper> {
        Ok(Stopper {
            shared: Arc::clone(&self.shared),
            address: self.address()?,
        })
    }

    /// Serves until a [`Stopper`] asks it to stop, and every request that had arrived by then has been answered.
    ///
    /// # Errors
    /// As the system has them.
    pub fn run(self) -> io::Result<()> {
        let mut open = Open::default();
        while !self.shared.is_stopping() {
            match self.listener.accept() {
                Ok((stream, _)) => self.shared.serve(stream, &mut open),
                // A peer that is gone again, or a moment without file descriptors: it passes.
                Err(_) => std::thread::sleep(Duration::from_millis(50)),
            }
            open.clear();
        }
        // Whoever had connected before the stop may have sent something already.
        self.listener.set_nonblocking(true)?;
        while let Ok((stream, _)) = self.listener.accept() {
            self.shared.serve(stream, &mut open);
        }
        // Whoever comes from here on is refused at once, and not left waiting for a server that is about to go.
        drop(self.listener);
        for thread in open.threads {
            // A connection's panic has ended that connection alone.
            let _ = thread.join();
        }
        Ok(())
    }
}

impl Stopper {
    /// Returns at once; [`Server::run`] returns when everything in hand is answered.
    pub fn stop(&self) {
        let mut asked = self
            .shared
            .stop_asked
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        asked.get_or_insert_with(Instant::now);
        drop(asked);
        self.shared.stopping.store(true, Ordering::SeqCst);
        // Wakes the listener, which then sees the flag. An unspecified address is reached by way of loopback.
        let mut address = self.address;
        if address.ip().is_unspecified() {
            match address {
                SocketAddr::V4(_) => address.set_ip(Ipv4Addr::LOCALHOST.into()),
                SocketAddr::V6(_) => address.set_ip(Ipv6Addr::LOCALHOST.into()),
            }
        }
        let _ = TcpStream::connect_timeout(&address, Duration::from_secs(1));
    }
}

impl Shared {
    fn is_stopping(&self) -> bool {
        self.stopping.load(Ordering::SeqCst)
    }

    /// When requests in hand are no longer waited for; `None` while nobody asked for a stop.
    fn grace_end(&self) -> Option<Instant> {
        let asked = *self
            .stop_asked
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        asked.map(|asked| asked + self.patience.grace)
    }

    /// Whether even those are given up who are still being told that the grace time is over.
    fn is_done_listening(&self) -> bool {
        self.grace_end()
            .is_some_and(|end| Instant::now() >= end + LAST_WORDS)
    }

    /// Gives a new connection its threads, or turns it away.
    fn serve(self: &Arc<Self>, stream: TcpStream, open: &mut Open) {
        let most = self.service.limits().connections;
        let place = Place::take(self);
        if place.number > most {
            writer::turn_away(&stream, most, place.number);
            open.turned_away.push_back((Instant::now(), stream));
            return;
        }
        let shared = Arc::clone(self);
        let work = move || connection::run(&shared, &stream, place);
        let spawned = std::thread::Builder::new()
            .name("connection".to_owned())
            .spawn(work);
        // Without a thread the connection is closed, which is all that can be done for it.
        open.threads.extend(spawned.ok());
    }
}

/// What is to be cleared away behind connections.
#[derive(Default)]
struct Open {
    threads: Vec<JoinHandle<()>>,
    /// Closed at once, their last line could be lost to a reset.
    turned_away: VecDeque<(Instant, TcpStream)>,
}

impl Open {
    /// Sockets that are kept for having been turned away.
    const MOST_TURNED_AWAY: usize = 64;

    fn clear(&mut self) {
        self.threads.retain(|thread| !thread.is_finished());
        let is_due = |(since, _): &(Instant, TcpStream)| since.elapsed() >= Duration::from_secs(1);
        while self.turned_away.len() > Self::MOST_TURNED_AWAY
            || self.turned_away.front().is_some_and(is_due)
        {
            self.turned_away.pop_front();
        }
    }
}

/// A place among the open connections, given back on drop.
struct Place {
    shared: Arc<Shared>,
    /// How many were open with this one.
    number: u64,
}

impl Place {
    fn take(shared: &Arc<Shared>) -> Self {
        let number = shared.connections.fetch_add(1, Ordering::SeqCst) + 1;
        shared.service.stats().opened_connection();
        Self {
            shared: Arc::clone(shared),
            number,
        }
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.shared.connections.fetch_sub(1, Ordering::SeqCst);
        self.shared.service.stats().closed_connection();
    }
}
