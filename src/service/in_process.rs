//! What a frame request comes to in plain types, for a caller in this process that draws it itself. Never lives here: drawing.

use super::call::Call;
use super::pose::of_pose;
use super::prepared_frame::Subject;
use super::state::Service;
use crate::engine::{Cancellation, RigRef};
use crate::protocol::Fault;
use crate::protocol::frame::FrameParams;
use bytes::Bytes;
use std::sync::Arc;

impl Service {
    /// What a frame request about `rig` shows. What it refers to as attached is not there.
    ///
    /// # Errors
    /// As `frame.render` has them.
    pub fn subject(self: &Arc<Self>, params: &FrameParams, rig: &RigRef) -> Result<Subject, Fault> {
        let call = Call {
            service: Arc::clone(self),
            attached: Bytes::new(),
            cancellation: Cancellation::default(),
            quota: self.engine.admission().connection_quota(),
        };
        let frame = call.prepare_frame(params.clone(), &Arc::new(rig.clone()))?;
        Ok(frame.evaluate().map_err(of_pose)?)
    }
}
