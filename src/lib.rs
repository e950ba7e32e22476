//! The code map of `rigd`, a daemon that keeps character rigs loaded, poses and skins them, and answers with pictures and vertices.
//!
//! # Rooms and arrows
//! A room may name the rooms to its right and no other, and re-exports nothing of them. Files do not need each other in circles; those below
//! a `mod.rs` may name what it declares. `tests/map` holds the source against all this.
//!
//! | room | may name | what lives there |
//! |---|---|---|
//! | `cli` | [`adapter`] `server` `service` [`engine`] [`client`] [`protocol`] [`formats`] [`encode`] [`frame`] [`scene`] [`rig`] `spelling` [`limits`] | `serve`, `render`, `inspect`, `call`, `doctor`, `openrpc` |
//! | `server` | `service` [`protocol`] [`limits`] | fronts, each with its own framing: bounded lines over TCP; an orderly shutdown; knows no method |
//! | [`client`] | [`protocol`] | a typed blocking client |
//! | `service` | [`adapter`] [`protocol`] [`engine`] [`rig`] [`formats`] [`scene`] [`pose`] [`pick`] [`frame`] [`encode`] `spelling` [`limits`] | a request in, a response out; one file for each family of methods; knows no framing and no socket |
//! | [`engine`] | [`adapter`] [`rig`] [`formats`] [`pose`] [`pick`] [`scene`] [`frame`] [`render`] [`limits`] | the use-cases in plain types; the store of rigs; whoever draws: the thread that owns the device, or the pool |
//! | [`render`] | [`adapter`] [`rig`] [`pose`] [`scene`] [`frame`] [`limits`] | a plan and two renderers of it, `render::gpu` and `render::cpu`, which never name each other |
//! | [`encode`] | [`frame`] [`scene`] | from frames to PNG, animated PNG and GIF |
//! | [`formats`] | [`rig`] `spelling` [`limits`] | files to rigs, and where files come from |
//! | [`pick`] | [`rig`] [`pose`] [`scene`] [`frame`] | rays against bones and skin |
//! | [`pose`] | [`rig`] | joint angles, limits, forward kinematics, the skinning palette |
//! | [`frame`] | [`scene`] | what came out of a renderer |
//! | [`scene`] | [`limits`] | what to draw: cameras, lights, surfaces |
//! | [`rig`] | [`limits`] | the format-free character, valid by construction |
//! | [`protocol`] | `spelling` | wire types, error kinds, the OpenRPC document |
//! | `spelling` | | the known name that an unknown one may have been meant for |
//! | [`adapter`] | | which renderer is asked for, and what each says of itself |
//! | [`limits`] | | every ceiling, with unit and reason |
//!
//! # Homes of what comes from outside
//! | crate | rooms |
//! |---|---|
//! | `wgpu` `pollster` | `render::gpu` |
//! | `bytemuck` | `render::gpu` [`render`] [`rig`] [`pose`] [`frame`] `service` |
//! | `bytes` | [`protocol`] `service` `server` `cli` |
//! | `png` `gif` `color_quant` | [`encode`] |
//! | `rayon` | [`engine`] `render::cpu` |
//! | `fearless_simd` | `render::cpu` |
//! | `image` | [`encode`] [`formats`] |
//! | `cap_std` `sha2` `gltf_json` `serde_path_to_error` `spade` | [`formats`] |
//! | `schemars` | [`protocol`] |
//! | `strsim` | `spelling` |
//! | `base64_simd` | [`protocol`] [`formats`] |
//! | `serde` `serde_json` | [`protocol`] `service` `server` [`client`] `cli` [`formats`] |
//! | `memory_stats` | `service` |
//! | `clap` `anyhow` `indicatif` `signal_hook` | `cli` |
//! | `std::net` | `server` [`client`] |
//! | `std::fs` | [`formats`] `cli` |
//! | `libm` | [`pose`] [`scene`] [`rig`] [`formats`] [`render`] |
//!
//! `glam` and `thiserror` are at home everywhere.
//!
//! # What holds everywhere
//! - A [`rig::Rig`] exists only if [`rig::Draft::build`] accepted it: parents before children, indices in range, numbers finite. A
//!   [`pose::Posed`] exists only if no vertex of it can overflow. Later rooms check neither again.
//! - Readers of files need no GPU and no file system; the GPU needs no reader.
//! - Influences of a vertex, joints and meshes are bounded by [`limits`] and memory alone, never by the width of a vertex format.
//! - The thread that owns the device never parses, compresses or touches a socket. Nothing unbounded is ever kept for a client.
//! - `render::cpu` gives the same bytes for the same plan on every machine: sums in a written order, each operation rounded once.
//! - An accepted request is answered exactly once, also when the device is lost, a client vanishes or the server stops.
//! - Skinning gives model space, the same for every instance of a pose; an instance's transform comes after it. Picture and vertices of one
//!   plan are of the same skin, and where a picture skins a pose, queries read its vertices.

#![forbid(unsafe_code)]
// They panic where nobody reads on or a disk is full; `cli::terminal` does not.
#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]
// What only tests may reach from outside is held to the first, and what anyone may, to the second.
#![cfg_attr(feature = "test-support", warn(unreachable_pub))]
#![cfg_attr(not(feature = "test-support"), warn(missing_docs))]

pub mod adapter;
#[cfg(feature = "cli")]
pub mod cli;
pub mod client;
pub mod encode;
pub mod engine;
pub mod formats;
pub mod frame;
pub mod limits;
pub mod pick;
pub mod pose;
pub mod protocol;
#[cfg(test)]
#[path = "../tests/support/random.rs"]
mod random;
pub mod render;
pub mod rig;
pub mod scene;
#[cfg(all(feature = "cli", not(feature = "test-support")))]
mod server;
#[cfg(feature = "test-support")]
pub mod server;
#[cfg(all(feature = "cli", not(feature = "test-support")))]
mod service;
#[cfg(feature = "test-support")]
pub mod service;
mod spelling;
