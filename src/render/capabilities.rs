//! What a renderer can do at most. Never lives here: finding out what there is.

use crate::frame::ImageKind;
use crate::limits::LimitExceeded;
use crate::pose::SkinDualQuaternion;
use crate::rig::Rig;
use crate::scene::Size;

/// What a renderer can do at most, known without it.
#[derive(Debug, Clone, Copy)]
pub struct Capabilities {
    /// Pixels of the side of a picture or texture.
    pub side: u64,
    /// Of one array of a rig or a picture; `None` where there is only memory itself.
    pub buffer_bytes: Option<u64>,
}

impl Capabilities {
    /// Name and value of each, as errors name them.
    pub fn entries(&self) -> impl Iterator<Item = (&'static str, u64)> + use<> {
        let bytes = self.buffer_bytes.map(|bytes| (BUFFER_BYTES, bytes));
        [(SIDE, self.side)].into_iter().chain(bytes)
    }

    /// # Errors
    /// Where a raster of this kind and size is larger than the adapter draws.
    pub fn accept_raster(&self, kind: ImageKind, size: Size) -> Result<(), LimitExceeded> {
        LimitExceeded::unless_within(SIDE, self.side, size.width.max(size.height))?;
        self.accept_bytes(kind.bytes(size) as u64)
    }

    fn accept_bytes(&self, bytes: u64) -> Result<(), LimitExceeded> {
        LimitExceeded::unless_within(BUFFER_BYTES, self.buffer_bytes.unwrap_or(u64::MAX), bytes)
    }

    /// # Errors
    /// Where a buffer or a texture of this rig is larger than the adapter takes.
    pub fn accept_rig(&self, rig: &Rig) -> Result<(), LimitExceeded> {
        // Those of all meshes stand in one buffer each, and so do their skinned vertices, six floats each. What else there is of a
        // vertex takes no more than that.
        let [influences, displacements, triangles] =
            rig.meshes().iter().fold([0; 3], |sums, mesh| {
                let [influences, displacements, triangles] = sums;
                [
                    influences + size_of_val(mesh.influences()),
                    displacements + size_of_val(mesh.morph_displacements()),
                    triangles + size_of_val(mesh.draw_triangles()),
                ]
            });
        let skinned = rig.draw_vertex_count() * 24;
        let palette = rig.bindings().len() * size_of::<SkinDualQuaternion>();
        let sizes = [influences, displacements, triangles, skinned, palette];
        let largest = sizes.into_iter().max().unwrap_or(0);
        self.accept_bytes(largest as u64)?;
        let sides = rig
            .textures()
            .map(|texture| texture.levels()[0].width.max(texture.levels()[0].height));
        LimitExceeded::unless_within(SIDE, self.side, sides.max().unwrap_or(0))
    }
}

const SIDE: &str = "adapter_side";
const BUFFER_BYTES: &str = "adapter_buffer_bytes";
