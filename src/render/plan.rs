//! What to skin and draw, as data that both renderers read. The rules that both must follow stand here, once.
//!
//! # The contract of a picture
//! 1. **Skin**, per vertex and once for all instances of a pose, in bind space first: `p = position + Σ morph weight · displacement`, `n` likewise and brought back to unit
//!    length; targets in load order. Then linearly: `M = Σ weight · model_from_bind`; position `M · p`; normal `normalize(cofactor(M) · n)`.
//!    Or with dual quaternions, where each `model_from_bind` is a rigid motion after a stretch: `S = Σ weight · stretch`; the motions
//!    are averaged as dual quaternions whose signs agree with that of the vertex' first influence, and made unit; position
//!    `motion(S · p)`; normal `rotation(normalize(cofactor(S) · n))`. A normal that comes to nothing is the one before. The cofactor
//!    matrix has the cross products of the columns as its columns, which is right under any scale, and turns normals over with the
//!    winding where the matrix mirrors. Drawing wants them so; what a query returns is turned back, by [`turn_outward`](super::turn_outward). What comes out
//!    is in model space. An instance is drawn with `world_from_model` times a position, and `cofactor(world_from_model)`, without its scale, times
//!    a normal, which is not made unit again before it is interpolated.
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
//!    laid over what is there by its alpha; what is opaque and nearer hides it, it hides nothing itself. The skeleton
//!    behind an opaque skin stays hidden. Alpha is premultiplied.
//!    An instance whose skin has an opacity below 1 is one layer: whatever its materials, its nearest surface alone counts at each sample, by
//!    its alpha times that opacity. Layers and parts that blend are one list, laid over the rest from the farthest center on, of equally
//!    far ones the instance of the lower index first. So far the renderers draw a single layer, above all that blends: where several
//!    instances are translucent, they share it.
//! 5. **Resolve**: the samples of a pixel are averaged, linear and premultiplied, each layer by itself, and the skin's layer is laid over the
//!    other; the outcome is divided by its alpha, encoded as sRGB and rounded to 8 bits.

use super::{Instance, Skin};
use crate::frame::ImageKind;
use crate::pose::{Posed, Skinning};
use crate::scene::{Appearance, Scene, Shape, VertexQuery};
use std::collections::BTreeSet;
use std::sync::Arc;

/// One renderer's worth of work: a picture, vertices, or both of the same skins.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The characters, in the order in which [`VertexQuery::instance`] counts them.
    pub instances: Vec<Instance>,
    /// `None` asks for vertices alone: nothing is drawn.
    pub image: Option<ImagePlan>,
    /// Inside the meshes of the instances.
    pub vertices: Vec<VertexQuery>,
}

/// A picture of all instances of a plan.
#[derive(Debug, Clone)]
pub struct ImagePlan {
    /// The camera, the lights and what else all instances share.
    pub scene: Scene,
    /// Which rasters are wanted, each once.
    pub outputs: BTreeSet<ImageKind>,
}

impl Plan {
    /// Instances of which the picture shows skin, each with its index.
    pub fn drawn(&self) -> impl Iterator<Item = (usize, &Instance)> + Clone {
        let instances = self.image.iter().flat_map(|_| &self.instances);
        let drawn = instances.enumerate();
        drawn.filter(|(_, instance)| instance.shows_skin())
    }

    /// The skins that the picture shows, each distinct one once, in the order of the instances.
    pub fn drawn_skins(&self) -> impl Iterator<Item = &Skin> {
        let all = self.drawn().map(|(_, instance)| instance.skin());
        let distinct = all.clone().enumerate().filter(move |(index, skin)| {
            let mut before = all.clone().take(*index);
            !before.any(|other| other == *skin)
        });
        distinct.map(|(_, skin)| skin)
    }

    /// Whether the skin of any instance is a layer of its own.
    pub fn is_translucent(&self) -> bool {
        self.drawn().any(|(_, instance)| instance.is_translucent())
    }

    /// A color picture of one character. `rest_size` is the diagonal of its rest bounds.
    pub fn picture(
        posed: Arc<Posed>,
        skinning: Skinning,
        appearance: Appearance,
        scene: Scene,
        rest_size: f64,
    ) -> Self {
        let outputs = BTreeSet::from([ImageKind::Color]);
        Self {
            instances: vec![Instance::shown(posed, skinning, appearance, rest_size)],
            image: Some(ImagePlan { scene, outputs }),
            vertices: Vec::new(),
        }
    }

    /// Vertices of one rig.
    pub fn vertices(
        posed: Arc<Posed>,
        skinning: Skinning,
        shape: Shape,
        queries: Vec<VertexQuery>,
    ) -> Self {
        Self {
            instances: vec![Instance::new(Skin::new(posed, shape, skinning))],
            image: None,
            vertices: queries,
        }
    }
}
