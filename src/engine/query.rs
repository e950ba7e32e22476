//! What the engine can be asked about characters in poses. Never lives here: how it finds out.

use super::LoadedRig;
use crate::frame::ImageKind;
use crate::pose::{Posed, Skinning};
use crate::render::{ImagePlan, Instance, Plan};
use crate::scene::{Appearance, BoneRadius, Cull, Ray, Scene, Shape, VertexQuery};
use glam::DAffine3;
use std::collections::BTreeSet;
use std::sync::Arc;

/// A character as a picture shows it.
#[derive(Debug, Clone)]
pub struct Character {
    /// The rig and its pose, worked out.
    pub posed: Arc<Posed>,
    /// Diagonal of its rest bounds.
    pub rest_size: f64,
    /// How vertices follow several joints.
    pub skinning: Skinning,
    /// What of it is drawn, and of what surface.
    pub appearance: Appearance,
    /// Invertible.
    pub world_from_model: DAffine3,
}

/// A picture of some characters, and vertices of the same poses.
#[derive(Debug, Clone)]
pub struct FrameQuery {
    /// In the order in which [`VertexQuery::instance`] counts them.
    pub characters: Vec<Character>,
    /// The camera, the lights and what else all characters share.
    pub scene: Scene,
    /// Which rasters of the picture are wanted.
    pub outputs: BTreeSet<ImageKind>,
    /// Inside the meshes of the characters.
    pub vertices: Vec<VertexQuery>,
}

impl FrameQuery {
    /// A color picture of one character at the origin of the world; `posed` is a pose of `loaded`.
    pub fn color(
        loaded: &LoadedRig,
        posed: Arc<Posed>,
        skinning: Skinning,
        appearance: Appearance,
        scene: Scene,
    ) -> Self {
        let character = Character {
            posed,
            rest_size: loaded.extents.bounds().size(),
            skinning,
            appearance,
            world_from_model: DAffine3::IDENTITY,
        };
        Self {
            characters: vec![character],
            scene,
            outputs: BTreeSet::from([ImageKind::Color]),
            vertices: Vec::new(),
        }
    }
}

impl From<FrameQuery> for Plan {
    fn from(query: FrameQuery) -> Self {
        let FrameQuery {
            characters,
            scene,
            outputs,
            vertices,
        } = query;
        let instance = |character: Character| {
            let Character {
                posed,
                rest_size,
                skinning,
                appearance,
                world_from_model,
            } = character;
            Instance::shown(posed, skinning, appearance, rest_size).placed(world_from_model)
        };
        Self {
            instances: characters.into_iter().map(instance).collect(),
            image: Some(ImagePlan { scene, outputs }),
            vertices,
        }
    }
}

/// What a ray is asked to meet.
#[derive(Debug, Clone, Copy)]
pub struct PickQuery {
    /// In world space, which is the model space of the one character that is asked about.
    pub ray: Ray,
    /// Whether bones can be met.
    pub bones: bool,
    /// `None` leaves each bone as thick as it is drawn.
    pub bone_radius: Option<BoneRadius>,
    /// The form of the skin that can be met, if any of it can.
    pub skin: Option<Shape>,
    /// Whether the backs of single-sided skin can be met as well.
    pub cull: Cull,
    /// Index into the rig's variants, which say what is single-sided.
    pub variant: Option<usize>,
}
