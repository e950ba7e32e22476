//! Requests in, responses out. [`Service::session`] gives a connection its [`Session`], which takes one [`Request`] at a time.
//! Never lives here: sockets, how messages are framed on them, and how a rig is loaded, posed or drawn.
//!
//! `dispatch` has the table of methods. Each family of methods has its file: from wire types to plain ones, one call to the engine, and
//! back.

mod appearance;
mod arrays;
mod batch;
mod call;
mod camera;
mod describe;
mod dispatch;
mod dof_row;
mod fault;
mod file_lights;
mod frame;
mod frame_batch;
mod in_flight;
mod in_process;
mod lights;
mod mesh;
mod mesh_batch;
mod message;
mod names;
mod pick;
mod pose;
mod prepared_frame;
mod prepared_pose;
mod response;
mod rig;
mod scene;
mod server;
mod session;
mod state;
mod stats;
mod vertices;

pub use describe::{describe_files, description};
pub use message::{Message, Notification, Permit, Response};
pub use prepared_frame::Subject;
#[cfg(feature = "cli")]
pub(crate) use prepared_frame::compression;
pub use response::ResponseHandle;
pub use session::{Request, Session};
pub use state::Service;
