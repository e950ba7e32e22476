//! A character of a plan: a rig in a pose, how it is skinned, how it looks and where it stands. Never lives here: what it is drawn into.

use super::skeleton::{self, SkeletonView};
use crate::pose::{Palette, Posed, Skinning};
use crate::rig::{Mesh, Part, Rig};
use crate::scene::{Appearance, Shape, ShowSkeleton};
use glam::{DAffine3, DMat4, DVec3};
use std::sync::Arc;

/// A character, ready to be skinned and drawn.
#[derive(Debug, Clone)]
pub struct Instance {
    skin: Skin,
    appearance: Appearance,
    world_from_model: DAffine3,
    /// Diagonal of the rest bounds, in model space.
    rest_size: f64,
    /// In model space.
    skeleton: Arc<SkeletonView>,
}

/// What decides the skinned vertices of an instance. Equal skins have equal vertices; they are told apart without looking at numbers.
#[derive(Debug, Clone)]
pub struct Skin {
    posed: Arc<Posed>,
    skinning: Skinning,
    /// What to skin by where the pose does not count.
    bind_shape: Option<Arc<BindShape>>,
}

#[derive(Debug)]
struct BindShape {
    palette: Palette,
    morph_weights: Vec<f32>,
}

impl Skin {
    /// In the bind shape, a mesh follows neither joints nor morph targets.
    pub fn new(posed: Arc<Posed>, shape: Shape, skinning: Skinning) -> Self {
        let bind_shape = match shape {
            Shape::Posed => None,
            Shape::Bind => Some(Arc::new(BindShape {
                palette: Palette::bind(posed.rig(), skinning),
                morph_weights: vec![0.0; posed.morph_weights().len()],
            })),
        };
        Self {
            posed,
            skinning,
            bind_shape,
        }
    }

    /// Of the pose; its meshes are what is skinned.
    pub fn rig(&self) -> &Arc<Rig> {
        self.posed.rig()
    }

    /// One entry per binding: model space <- bind space.
    pub fn palette(&self) -> &Palette {
        match &self.bind_shape {
            Some(bind_shape) => &bind_shape.palette,
            None => self.posed.palette(self.skinning),
        }
    }

    /// One per morph target.
    pub fn morph_weights(&self) -> &[f32] {
        match &self.bind_shape {
            Some(bind_shape) => &bind_shape.morph_weights,
            None => self.posed.morph_weights(),
        }
    }

    /// As [`Posed::mirrors`]; in the bind shape, nothing does.
    pub fn mirrors(&self, mesh: &Mesh) -> bool {
        self.bind_shape.is_none() && self.posed.mirrors(mesh)
    }

    /// As [`Posed::center_of`], in model space.
    pub fn center_of(&self, part: &Part) -> DVec3 {
        match self.bind_shape {
            Some(_) => part.center.as_dvec3(),
            None => self.posed.center_of(part),
        }
    }
}

impl PartialEq for Skin {
    fn eq(&self, other: &Self) -> bool {
        let is_same = match (&self.bind_shape, &other.bind_shape) {
            (None, None) => Arc::ptr_eq(&self.posed, &other.posed),
            (Some(_), Some(_)) => Arc::ptr_eq(self.rig(), other.rig()),
            _ => false,
        };
        is_same && self.skinning == other.skinning
    }
}

impl Eq for Skin {}

impl Instance {
    /// At the origin of the world, with an appearance that asks for nothing.
    pub fn new(skin: Skin) -> Self {
        Self {
            skin,
            appearance: Appearance::default(),
            world_from_model: DAffine3::IDENTITY,
            rest_size: 0.0,
            skeleton: Arc::default(),
        }
    }

    /// A character as a picture shows it, in the shape that its appearance asks for. One without skin shows its skeleton, also where the
    /// appearance says nothing of it. `rest_size` is the diagonal of the rest bounds.
    pub fn shown(
        posed: Arc<Posed>,
        skinning: Skinning,
        appearance: Appearance,
        rest_size: f64,
    ) -> Self {
        let how = match appearance.show.skeleton {
            ShowSkeleton::None if posed.rig().vertex_count() == 0 => ShowSkeleton::Wireframe,
            asked => asked,
        };
        let skeleton = Arc::new(skeleton::view(&posed, how, rest_size));
        let shape = appearance.show.skin.shape();
        Self {
            appearance,
            rest_size,
            skeleton,
            ..Self::new(Skin::new(posed, shape, skinning))
        }
    }

    /// The same, placed in the world. The matrix is invertible.
    pub fn placed(self, world_from_model: DAffine3) -> Self {
        Self {
            world_from_model,
            ..self
        }
    }

    /// What its skinned vertices come from.
    pub fn skin(&self) -> &Skin {
        &self.skin
    }

    /// That of its skin's pose.
    pub fn rig(&self) -> &Arc<Rig> {
        self.skin.rig()
    }

    /// What of it is drawn, and of what surface; by default its skin in the pose, culled.
    pub fn appearance(&self) -> &Appearance {
        &self.appearance
    }

    /// Empty where the skeleton is not shown.
    pub(super) fn skeleton(&self) -> &SkeletonView {
        &self.skeleton
    }

    /// Applied to column vectors after skinning; invertible, the identity unless it was [placed](Self::placed).
    pub fn world_from_model(&self) -> DAffine3 {
        self.world_from_model
    }

    /// Of column vectors.
    pub fn clip_from_model(&self, clip_from_world: DMat4) -> DMat4 {
        clip_from_world * DMat4::from(self.world_from_model)
    }

    /// Whether a picture shows any of its skin.
    pub fn shows_skin(&self) -> bool {
        self.rig().vertex_count() > 0 && self.appearance.show.shows_skin()
    }

    /// Whether its skin is a layer of its own, of which only the nearest surface is laid over what stands behind it.
    pub fn is_translucent(&self) -> bool {
        self.shows_skin() && self.appearance.show.skin_opacity() < 1.0
    }

    /// Smallest squared distance, in world space, that an inverse-square light is divided by: a hundredth of its size.
    pub fn least_distance_squared(&self) -> f32 {
        // A rig that is a single point has no size; then nothing is nearer than one unit in a hundred.
        let size = if self.rest_size > 0.0 {
            self.rest_size
        } else {
            1.0
        };
        let scale = libm::cbrt(self.world_from_model.matrix3.determinant().abs());
        let size = size * scale;
        (1e-4 * size * size) as f32
    }
}
