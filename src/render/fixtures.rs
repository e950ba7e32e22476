//! Small plans that unit tests share. Never lives here: what should come of them.

use super::Plan;
use crate::limits::Limits;
use crate::pose::{Pose, Posed, Skinning};
use crate::rig::{Draft, MeshDraft};
use crate::scene::{
    Appearance, Background, Bounds, Camera, Light, Orbit, Samples, Scene, Show, ShowSkin, Size,
};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// So many triangles, a mesh each.
pub(crate) fn posed(meshes: usize) -> Arc<Posed> {
    let mesh = |_| MeshDraft {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        triangles: vec![[0, 1, 2]],
        ..MeshDraft::default()
    };
    let draft = Draft {
        meshes: (0..meshes).map(mesh).collect(),
        ..Draft::default()
    };
    let rig = Arc::new(draft.build(&Limits::default()).unwrap());
    Arc::new(Posed::new(&Pose::rest(&rig)).unwrap())
}

/// A small picture of it.
pub(crate) fn picture(posed: &Arc<Posed>, skinning: Skinning, skin: ShowSkin) -> Plan {
    let size = Size {
        width: 8,
        height: 8,
    };
    let bounds = Bounds {
        min: DVec3::ZERO,
        max: DVec3::ONE,
    };
    let scene = Scene {
        size,
        samples: Samples::One,
        camera: Camera::orbit(Orbit::default(), &bounds, size).unwrap(),
        lights: Light::default_pair(),
        ambient: Scene::DEFAULT_AMBIENT,
        background: Background::default(),
    };
    let appearance = Appearance {
        show: Show::new(skin, Default::default(), Default::default(), 1.0).unwrap(),
        ..Appearance::default()
    };
    Plan::picture(Arc::clone(posed), skinning, appearance, scene, 1.0)
}
