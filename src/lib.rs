//! rigd
#![forbid(unsafe_code)]
pub mod cli;
pub mod client;
pub mod encode;
pub mod engine;
pub mod formats;
pub mod frame;
pub mod limits;
pub mod pose;
pub mod protocol;
pub mod render;
pub mod rig;
pub mod scene;
pub mod server;
pub mod service;
