//! The listener: lets connections in, turns away those that are too many, and waits for the last of them. Never lives here: lines.

use super::connection;
use super::shared::{OpenConnection, Shared};
use super::writer;
use crate::server::shutdown::Timeouts;
use crate::service::Service;
use std::collections::VecDeque;
use std::io;
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

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

impl Server {
    /// # Errors
    /// Where the address cannot be listened on.
    pub fn bind(address: &str, service: Arc<Service>, timeouts: Timeouts) -> io::Result<Self> {
        Ok(Self {
            listener: TcpListener::bind(address)?,
            shared: Arc::new(Shared::new(service, timeouts)),
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
        let mut accepted = Accepted::default();
        while !self.shared.shutdown.is_asked() {
            match self.listener.accept() {
                Ok((stream, _)) => accepted.serve(&self.shared, stream),
                // A peer that is gone again, or a moment without file descriptors: it passes.
                Err(_) => std::thread::sleep(Duration::from_millis(50)),
            }
            accepted.clear();
        }
        // Whoever had connected before the stop may have sent something already.
        self.listener.set_nonblocking(true)?;
        while let Ok((stream, _)) = self.listener.accept() {
            accepted.serve(&self.shared, stream);
        }
        // Whoever comes from here on is refused at once, and not left waiting for a server that is about to go.
        drop(self.listener);
        for thread in accepted.threads {
            // A connection's panic has ended that connection alone.
            let _ = thread.join();
        }
        Ok(())
    }
}

impl Stopper {
    /// Returns at once; [`Server::run`] returns when everything in hand is answered.
    pub fn stop(&self) {
        self.shared.shutdown.ask();
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

/// What is to be cleared away behind connections.
#[derive(Default)]
struct Accepted {
    threads: Vec<JoinHandle<()>>,
    /// Closed at once, their last line could be lost to a reset.
    turned_away: VecDeque<(Instant, TcpStream)>,
}

impl Accepted {
    /// Sockets that are kept for having been turned away.
    const MOST_TURNED_AWAY: usize = 64;

    /// Gives a new connection its threads, or turns it away.
    fn serve(&mut self, shared: &Arc<Shared>, stream: TcpStream) {
        let connection = OpenConnection::count(shared);
        if let Err(exceeded) = shared.service.limits().connections(connection.number) {
            writer::turn_away(&stream, exceeded);
            self.turned_away.push_back((Instant::now(), stream));
            return;
        }
        let shared = Arc::clone(shared);
        let spawned = std::thread::Builder::new()
            .name("connection".to_owned())
            .spawn(move || {
                connection::run(&shared, &stream);
                drop(connection);
            });
        // Without a thread the connection is closed, which is all that can be done for it.
        self.threads.extend(spawned.ok());
    }

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
