//! What to skin and draw, as data that both renderers read. The rules that both must follow stand here, once.
//!
//! # The contract of a picture
//! 1. **Skin**: per vertex, `M = Σ weight · model_from_bind`; position `M · p`; normal `normalize(cofactor(M) · n)`, or the bind
//!    normal where that is zero. The cofactor matrix has the cross products of `M`'s columns as its columns, which is right under
//!    any scale, and turns normals over with the winding where `M` mirrors.
//! 2. **Raster**: standard 4-sample positions, or the pixel's center; depth is reversed and the nearest wins; nothing is culled.
//! 3. **Shade**, per pixel and triangle, in world space and linear RGB, at the pixel's center, or at a place the triangle covers where it
//!    does not cover that; `n` flipped toward the side that is seen:
//!    `ambient · diffuse + Σ radiance · (diffuse · max(n·l, 0) + [n·l > 0] · specular · max(n·h, 0)^shininess)`, clamped to 0..1.
//!    A flat normal is the triangle's own.
//! 4. **Blend**: skeleton first; the nearest surface of the skin is laid over what is there by its opacity; the skeleton behind an
//!    opaque skin stays hidden. Alpha is premultiplied.
//! 5. **Resolve**: the samples of a pixel are averaged, linear and premultiplied, each layer by itself, and the skin's layer is laid over the
//!    other; the outcome is divided by its alpha, encoded as sRGB and rounded to 8 bits.

use crate::pose::{Palette, Posed};
use crate::rig::Rig;
use crate::scene::{Scene, Shape, ShowSkeleton, ShowSkin, VertexQuery};
use glam::Vec3;
use std::borrow::Cow;
use std::sync::Arc;

/// One renderer's worth of work.
#[derive(Debug, Clone)]
pub struct Plan {
    pub instances: Vec<Instance>,
    pub wanted: Wanted,
}

/// A rig in a pose.
#[derive(Debug, Clone)]
pub struct Instance {
    pub posed: Arc<Posed>,
    pub shape: Shape,
}

/// What a plan is for.
#[derive(Debug, Clone)]
pub enum Wanted {
    Picture(Box<Picture>),
    /// Of the one instance of the plan.
    Vertices(Vec<VertexQuery>),
}

/// A picture of the instances of a plan.
#[derive(Debug, Clone)]
pub struct Picture {
    pub scene: Scene,
    /// Rest bounds' diagonal: what inverse-square lights measure distance by.
    pub rig_size: f64,
    pub skin_is_shown: bool,
    /// Lines over all instances, in world space.
    pub lines: Vec<Segment>,
}

impl Picture {
    /// Smallest squared distance that an inverse-square light is divided by.
    pub fn least_distance_squared(&self) -> f32 {
        // A rig that is a single point has no size; then nothing is nearer than one unit in a hundred.
        let size = if self.rig_size > 0.0 {
            self.rig_size
        } else {
            1.0
        };
        (1e-4 * size * size) as f32
    }
}

/// A line of constant width in pixels, its ends round enough to be a dot where they coincide.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Segment {
    pub from_in_world: Vec3,
    pub width_pixels: f32,
    pub to_in_world: Vec3,
    /// Linear RGB.
    pub color: Vec3,
}

/// Wide enough to be seen in a 128-pixel thumbnail, thin enough to show a finger.
const BONE_WIDTH_PIXELS: f32 = 2.0;
const JOINT_DOT_PIXELS: f32 = 5.0;
const BONE_COLOR: Vec3 = Vec3::new(0.85, 0.72, 0.30);
const JOINT_COLOR: Vec3 = Vec3::new(0.95, 0.33, 0.15);

impl Instance {
    pub fn rig(&self) -> &Arc<Rig> {
        self.posed.rig()
    }

    /// One matrix per binding, as the shape wants it.
    pub fn palette(&self) -> Cow<'_, Palette> {
        match self.shape {
            Shape::Posed => Cow::Borrowed(self.posed.palette()),
            Shape::Bind => Cow::Owned(Palette::bind(self.rig())),
        }
    }
}

impl Plan {
    /// One rig, one picture. A rig with no skin shows its skeleton, whatever the scene says.
    pub fn picture(posed: Arc<Posed>, scene: Scene, rig_size: f64) -> Self {
        let has_skin = posed.rig().vertex_count() > 0;
        let skeleton = if has_skin {
            scene.show.skeleton
        } else {
            ShowSkeleton::Wireframe
        };
        let lines = match skeleton {
            ShowSkeleton::None => Vec::new(),
            ShowSkeleton::Wireframe => wireframe(&posed),
        };
        let shape = if scene.show.skin == ShowSkin::Bind {
            Shape::Bind
        } else {
            Shape::Posed
        };
        let skin_is_shown =
            has_skin && scene.show.skin != ShowSkin::None && scene.show.skin_opacity() > 0.0;
        let picture = Picture {
            scene,
            rig_size,
            skin_is_shown,
            lines,
        };
        Self {
            instances: vec![Instance { posed, shape }],
            wanted: Wanted::Picture(Box::new(picture)),
        }
    }

    /// Vertices of one rig; the queries lie inside its meshes.
    pub fn vertices(posed: Arc<Posed>, shape: Shape, queries: Vec<VertexQuery>) -> Self {
        Self {
            instances: vec![Instance { posed, shape }],
            wanted: Wanted::Vertices(queries),
        }
    }
}

/// A line along each bone, then a dot at each joint, so that a skeleton of one joint shows too.
fn wireframe(posed: &Posed) -> Vec<Segment> {
    let bones = posed.bones().map(|(_, from, to)| Segment {
        from_in_world: from.as_vec3(),
        to_in_world: to.as_vec3(),
        width_pixels: BONE_WIDTH_PIXELS,
        color: BONE_COLOR,
    });
    let dots = posed.world_from_joint().iter().map(|world_from_joint| {
        let at = world_from_joint.translation.as_vec3();
        Segment {
            from_in_world: at,
            to_in_world: at,
            width_pixels: JOINT_DOT_PIXELS,
            color: JOINT_COLOR,
        }
    });
    bones.chain(dots).collect()
}
