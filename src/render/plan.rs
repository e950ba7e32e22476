//! What to skin and draw, as data that both renderers read. The rules that both must follow stand here, once.
//!
//! # The contract of a picture
//! 1. **Skin**, per vertex, in bind space first: `p = position + Σ morph weight · displacement`, `n` likewise and brought back to unit
//!    length; targets in load order. Then linearly: `M = Σ weight · model_from_bind`; position `M · p`; normal `normalize(cofactor(M) · n)`.
//!    Or with dual quaternions, where each `model_from_bind` is a rigid motion after a stretch: `S = Σ weight · stretch`; the motions
//!    are averaged as dual quaternions whose signs agree with that of the vertex' first influence, and made unit; position
//!    `motion(S · p)`; normal `rotation(normalize(cofactor(S) · n))`. A normal that comes to nothing is the one before. The cofactor
//!    matrix has the cross products of the columns as its columns, which is right under any scale, and turns normals over with the
//!    winding where the matrix mirrors. Drawing wants them so; what a query returns is turned back, by [`turn_outward`](super::turn_outward).
//! 2. **Raster**: corners rounded to 1/256 pixel; samples at the standard positions, (3, 1) (7, 3) (1, 5) (5, 7) in eighths of a pixel from its
//!    upper left corner, or one at the pixel's center; a sample on an edge belongs to the triangle whose top or left edge it is; depth is
//!    reversed, the nearest wins, of equal ones the first; what cannot be seen of closed skin is culled, all else is two-sided.
//! 3. **Shade**, per pixel and triangle, in world space and linear RGB, at one place: the pixel's center where the triangle covers all samples,
//!    else the first sample that it covers. Where other triangles hide some of them, the first that is seen will do as well. At the place an
//!    attribute is that of the triangle's plane, in perspective. `n` is flipped toward the side that is seen:
//!    `ambient · diffuse + Σ radiance · (diffuse · max(n·l, 0) + [n·l > 0] · specular · max(n·h, 0)^shininess) + emissive`, clamped to 0..1.
//!    The radiance of a spot light is times `clamp((cos − cos outer) / (cos inner − cos outer), 0, 1)²`, `cos` being that of the angle between
//!    its direction and the way to what it lights. A flat normal is the triangle's own. `diffuse` is the surface's, times the texture at the pixel's center where the mesh has one
//!    (linear light, bilinear in two levels and linear between), times the vertex color, interpolated as positions are and held to 0..1;
//!    of a skeleton's solids it is their own color. Where a texture is asked for: texture coordinates (u, v), `v` = 0 the bottom row, are
//!    mapped from (u, 1 − v) by the material's transform to a place on the picture, from its upper left corner; beyond (0, 0) and (1, 1)
//!    it is repeated, mirrored or held. The level is `½ · log2(max(1, a², b²))`, where `a` and `b` are how far, in texels, that place moves
//!    between the centers of the two pixels of a row and of a column in the aligned square of four that the pixel is of.
//!    What is not lit is `diffuse`, clamped. A normal map `m = 2 · texel − 1`, its first two numbers times its scale, makes
//!    `n' = normalize(m.x · t + m.y · b + m.z · n)`: `t` and `b` are the directions in the triangle's plane in which the place moves right and up
//!    on the picture, each made perpendicular to `n` (already flipped) and unit; where the place does not move over the triangle, or
//!    `n'` comes to nothing, it stays `n`. Flat normals that a request asks
//!    for are not mapped, those of a part that has no others are.
//! 4. **Blend**: alpha is that of the surface, the texture and the vertex color multiplied. A mask leaves out a triangle at all samples of a
//!    pixel where its alpha at the pixel's center is less than the material's cutoff. Skeleton first, then what is opaque or masked. Then parts
//!    that blend, in the order of `blending_parts`, farthest first, and the triangles of a part in its own order: sample by sample each is
//!    laid over what is there by its alpha; what is opaque and nearer hides it, it hides nothing itself. Of a translucent skin
//!    (opacity below 1) instead, whatever its materials, the nearest surface alone is laid over the skeleton, by its alpha times
//!    the skin's opacity. The skeleton behind an opaque skin stays hidden. Alpha is premultiplied.
//! 5. **Resolve**: the samples of a pixel are averaged, linear and premultiplied, each layer by itself, and the skin's layer is laid over the
//!    other; the outcome is divided by its alpha, encoded as sRGB and rounded to 8 bits.

use super::skeleton::{self, SkeletonView};
use crate::pose::{Palette, Posed, Skinning};
use crate::rig::{Mesh, Part, Rig};
use crate::scene::{Scene, Shape, ShowSkeleton, VertexQuery};
use glam::DVec3;
use std::sync::Arc;

/// One renderer's worth of work.
#[derive(Debug, Clone)]
pub struct Plan {
    pub instances: Vec<Instance>,
    pub wanted: Wanted,
}

/// A rig in a pose, ready to be skinned. A clone of it is the same one.
#[derive(Debug, Clone)]
pub struct Instance {
    posed: Arc<Posed>,
    skinning: Skinning,
    /// What to skin by where the pose does not count.
    as_modelled: Option<Arc<AsModelled>>,
}

#[derive(Debug)]
struct AsModelled {
    palette: Palette,
    morph_weights: Vec<f32>,
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
    /// Over all instances, in world space.
    pub skeleton: SkeletonView,
}

impl Picture {
    /// Whether the skin goes into a layer of its own, so that only its nearest surface is laid over what stands behind it.
    pub fn is_translucent(&self) -> bool {
        self.skin_is_shown && self.scene.show.skin_opacity() < 1.0
    }

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

impl Instance {
    /// As modelled, a mesh follows neither joints nor morph targets.
    pub fn new(posed: Arc<Posed>, shape: Shape, skinning: Skinning) -> Self {
        let as_modelled = match shape {
            Shape::Posed => None,
            Shape::Bind => Some(Arc::new(AsModelled {
                palette: Palette::bind(posed.rig(), skinning),
                morph_weights: vec![0.0; posed.morph_weights().len()],
            })),
        };
        Self {
            posed,
            skinning,
            as_modelled,
        }
    }

    /// One entry per binding, as the shape wants it.
    pub fn palette(&self) -> &Palette {
        match &self.as_modelled {
            Some(as_modelled) => &as_modelled.palette,
            None => self.posed.palette(self.skinning),
        }
    }

    /// One per morph target.
    pub fn morph_weights(&self) -> &[f32] {
        match &self.as_modelled {
            Some(as_modelled) => &as_modelled.morph_weights,
            None => self.posed.morph_weights(),
        }
    }

    /// Whether the vertices of both are the same, as far as can be told without looking at numbers.
    pub fn is_skinned_like(&self, other: &Self) -> bool {
        let is_same = match (&self.as_modelled, &other.as_modelled) {
            (None, None) => Arc::ptr_eq(&self.posed, &other.posed),
            (Some(_), Some(_)) => Arc::ptr_eq(self.rig(), other.rig()),
            _ => false,
        };
        is_same && self.skinning == other.skinning
    }

    /// As [`Posed::mirrors`]; as modelled, nothing does.
    pub fn mirrors(&self, mesh: &Mesh) -> bool {
        self.as_modelled.is_none() && self.posed.mirrors(mesh)
    }

    /// As [`Posed::center_of`].
    pub fn center_of(&self, part: &Part) -> DVec3 {
        match self.as_modelled {
            Some(_) => part.center.as_dvec3(),
            None => self.posed.center_of(part),
        }
    }

    pub fn rig(&self) -> &Arc<Rig> {
        self.posed.rig()
    }
}

impl Plan {
    /// Those of which a picture shows skin.
    pub fn shown_instances(&self) -> &[Instance] {
        match &self.wanted {
            Wanted::Picture(picture) if !picture.skin_is_shown => &[],
            Wanted::Picture(_) | Wanted::Vertices(_) => &self.instances,
        }
    }

    /// One rig, one picture. A rig with no skin shows its skeleton, also where the scene says nothing of it. `rig_size` is that of the
    /// rest bounds.
    pub fn picture(posed: Arc<Posed>, skinning: Skinning, scene: Scene, rig_size: f64) -> Self {
        let has_skin = posed.rig().vertex_count() > 0;
        let how = match scene.show.skeleton {
            ShowSkeleton::None if !has_skin => ShowSkeleton::Wireframe,
            asked => asked,
        };
        let shape = scene.show.skin.shape();
        let skin_is_shown = has_skin && scene.show.shows_skin();
        let picture = Picture {
            rig_size,
            skin_is_shown,
            skeleton: skeleton::view(&posed, how, rig_size),
            scene,
        };
        Self {
            instances: vec![Instance::new(posed, shape, skinning)],
            wanted: Wanted::Picture(Box::new(picture)),
        }
    }

    /// Vertices of one rig; the queries lie inside its meshes.
    pub fn vertices(
        posed: Arc<Posed>,
        skinning: Skinning,
        shape: Shape,
        queries: Vec<VertexQuery>,
    ) -> Self {
        Self {
            instances: vec![Instance::new(posed, shape, skinning)],
            wanted: Wanted::Vertices(queries),
        }
    }
}
