//! Normals as a query returns them. Never lives here: drawing, which goes by the side of a triangle that is seen.

use super::Skin;
use crate::frame::SkinnedVertices;
use crate::scene::VertexQuery;

/// Skinning turns normals over with the winding where the matrix `M` of a vertex mirrors; here they are turned back, so that they point
/// outward again: times `cofactor(M)`, of [the contract](super::Plan), the sign of `M`'s determinant. `skinned` are the vertices that
/// `query` asked of `skin`.
pub fn turn_outward(skin: &Skin, query: &VertexQuery, skinned: &mut SkinnedVertices) {
    let mesh = &skin.rig().meshes()[query.mesh];
    let Some(normals) = &mut skinned.normals else {
        return;
    };
    if !skin.mirrors(mesh) {
        return;
    }
    let palette = skin.palette();
    let (normals, _) = normals.as_chunks_mut::<3>();
    for (normal, vertex) in normals.iter_mut().zip(query.start..) {
        if palette.mirrors(mesh.influences_of(vertex)) {
            *normal = normal.map(|number| -number);
        }
    }
}
