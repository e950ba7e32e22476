//! What a frame request comes to in plain types, for a caller in this process that draws it itself. Never lives here: drawing.

use super::pose::of_pose;
use super::scene::of_skinning;
use super::{Call, Service, describe, file_lights};
use crate::engine::{RigRef, Urgency};
use crate::pose::{Posed, Skinning};
use crate::protocol::Fault;
use crate::protocol::camera::{Lights, NamedLights};
use crate::protocol::frame::FrameParams;
use crate::protocol::pose::Clamped;
use crate::scene::Scene;
use std::sync::Arc;

/// What is to be drawn.
pub struct Subject {
    pub scene: Scene,
    pub posed: Arc<Posed>,
    pub skinning: Skinning,
    /// Values of the pose that their limits changed.
    pub clamped: Vec<Clamped>,
}

impl Service {
    /// What a frame request about `rig` shows. What it refers to as attached is not there.
    ///
    /// # Errors
    /// As `frame.render` has them.
    pub fn subject(self: &Arc<Self>, params: &FrameParams, rig: &RigRef) -> Result<Subject, Fault> {
        let call = Call {
            service: Arc::clone(self),
            attached: Arc::default(),
            urgency: Urgency::default(),
            share: self.engine.admission().share(),
        };
        call.subject(params, rig)
    }
}

impl Call {
    pub(super) fn subject(&self, params: &FrameParams, found: &RigRef) -> Result<Subject, Fault> {
        let mut scene = self.scene(params, &found.loaded)?;
        let (posed, clamped) = self.posed(&params.pose, found).map_err(of_pose)?;
        if let Some(Lights::Named(NamedLights::File)) = params.lights {
            scene.lights = file_lights::in_pose(&posed);
        }
        Ok(Subject {
            scene,
            skinning: of_skinning(params.skinning),
            clamped: describe::clamped(posed.rig(), &clamped),
            posed,
        })
    }
}
