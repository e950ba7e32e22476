//! The front of the TCP contract: one JSON-RPC message to a line, raw bytes behind it. Never lives here: what a line asks for.

mod connection;
mod line;
mod listener;
mod queue;
mod reader;
mod shared;
mod writer;

pub use listener::{Server, Stopper};
