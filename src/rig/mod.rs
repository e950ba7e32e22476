//! The format-free character: readers fill a [`Draft`], [`Draft::build`] validates it once, and a [`Rig`] can no longer be wrong.
//! Never lives here: anything that knows a file format, a pose or a GPU.

mod build;
mod clip;
mod dof;
mod draft;
mod light;
mod material;
mod mesh;
mod morph;
mod names;
mod rotation;
mod skeleton;
mod texture;
mod warnings;

pub use clip::{Channel, Clip, Curve, Extrapolation, Interpolation, Key, slerp};
pub use dof::{Dof, DofKind, Dofs, MORPH_PREFIX};
pub use draft::{
    BindPose, BindingDraft, ChannelDraft, ChannelTarget, ClipDraft, Draft, JointDraft, MeshDraft,
    MorphDraft, MorphForm, PartDraft, PartInVariant, RigError, RigProblem,
};
pub use light::{FileLight, FileLightKind};
pub use material::{Highlight, Material, NormalMap, Opacity, TexturePlace, TextureTransform, Wrap};
pub use mesh::{Binding, BindingBounds, Influence, Look, Mesh, Part, Sides};
pub use morph::{Morph, MorphDisplacement};
pub use rotation::{Rotation, RotationOrder};
pub use skeleton::{Axis, Joint, Limit, Skeleton};
pub use texture::{Encoding, LINEAR_FROM_SRGB, Texture, TextureLevel, linear_from_srgb};
pub use warnings::Warnings;

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Largest absolute coordinate, offset or matrix entry of a rig, in its units: far beyond any character, and small enough that
/// nothing computed from it overflows float32.
pub const LARGEST_COORDINATE: f64 = 1e9;

/// Tells one built [`Rig`] from every other of this process, also from one of the same name and files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct RigId(u64);

impl RigId {
    fn next() -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(1);
        Self(NEXT.fetch_add(1, Ordering::Relaxed))
    }
}

/// A character that passed [`Draft::build`]: parents stand before their children, every index is in range, every number is finite,
/// names are unique, weights of a vertex sum to 1. What uses a rig relies on it and checks nothing again.
#[derive(Debug)]
pub struct Rig {
    id: RigId,
    skeleton: Skeleton,
    dofs: Dofs,
    meshes: Vec<Mesh>,
    bindings: Vec<Binding>,
    materials: Vec<Material>,
    variants: Vec<String>,
    lights: Vec<FileLight>,
    morphs: Vec<Morph>,
    clips: Vec<Clip>,
    warnings: Vec<String>,
}

impl Rig {
    /// Under which renderers keep what they made of this rig.
    pub fn id(&self) -> RigId {
        self.id
    }

    /// Its joints; there are none where the rig is only a mesh.
    pub fn skeleton(&self) -> &Skeleton {
        &self.skeleton
    }

    /// The numbers that a pose of it sets.
    pub fn dofs(&self) -> &Dofs {
        &self.dofs
    }

    /// In load order; empty where the rig is only a skeleton.
    pub fn meshes(&self) -> &[Mesh] {
        &self.meshes
    }

    /// What influences point at: one skinning matrix each, in palette order.
    pub fn bindings(&self) -> &[Binding] {
        &self.bindings
    }

    /// What parts of meshes name by index; in load order, empty where the files have none.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// Names of the choices of materials that the file offers beside its own.
    pub fn variants(&self) -> &[String] {
        &self.variants
    }

    /// What a part of one of its meshes is made of. `variant` is an index into [`Rig::variants`], `None` the file's own choice.
    pub fn material_of(&self, part: &Part, variant: Option<usize>) -> Option<&Material> {
        let material = part.look(variant).material?;
        Some(&self.materials[material])
    }

    /// Lights of the files, which shine only where a picture asks for them.
    pub fn lights(&self) -> &[FileLight] {
        &self.lights
    }

    /// Of all materials; one that several use comes as often.
    pub fn textures(&self) -> impl Iterator<Item = &Arc<Texture>> {
        let places = self.materials.iter().flat_map(Material::textures);
        places.map(|place| &place.texture)
    }

    /// In load order, as their DOFs stand.
    pub fn morphs(&self) -> &[Morph] {
        &self.morphs
    }

    /// In load order.
    pub fn clips(&self) -> &[Clip] {
        &self.clips
    }

    /// What was odd in the files but could be worked with, a sentence each.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Those of the files, of all meshes together.
    pub fn vertex_count(&self) -> usize {
        self.meshes.iter().map(Mesh::vertex_count).sum()
    }

    /// Those of all meshes, copies included.
    pub fn draw_vertex_count(&self) -> usize {
        self.meshes.iter().map(Mesh::draw_vertex_count).sum()
    }

    /// Those of all meshes together.
    pub fn triangle_count(&self) -> usize {
        self.meshes.iter().map(|mesh| mesh.triangles().len()).sum()
    }

    /// Bytes that this rig takes in memory, to the accuracy a budget needs.
    pub fn memory_bytes(&self) -> u64 {
        // A joint with its name, three DOFs and their names in the map comes to about a kibibyte.
        let skeleton = self.skeleton.joints().len() * 1024;
        // One that several materials use counts once.
        let mut textures: Vec<_> = self.textures().collect();
        textures.sort_unstable_by_key(|texture| Arc::as_ptr(texture));
        textures.dedup_by_key(|texture| Arc::as_ptr(texture));
        let textures: usize = textures.iter().map(|texture| texture.memory_bytes()).sum();
        let meshes: usize = self.meshes.iter().map(Mesh::memory_bytes).sum();
        let keys: usize = self
            .clips
            .iter()
            .flat_map(|clip| &clip.channels)
            .map(|channel| match channel {
                Channel::Dof { curve, .. } => size_of_val(curve.keys.as_slice()),
                Channel::Rotation { curve, .. } => size_of_val(curve.keys.as_slice()),
            })
            .sum();
        (skeleton + keys + textures + meshes + std::mem::size_of_val(self.bindings.as_slice()))
            as u64
    }
}
