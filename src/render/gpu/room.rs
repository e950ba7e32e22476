//! How much may share a submission. Never lives here: what is done with the rest.

use super::coats::Coats;
use super::shade::{LINE_CORNERS, shape_of};
use crate::pose::SkinDualQuaternion;
use crate::render::{Plan, Segment, SolidVertex, Wanted};

/// Plans that share a submission at the most: by then what a submission costs by itself is a small part of it, and the first of them is
/// answered when the last is done.
pub(super) const MOST_PLANS: usize = 16;

/// Memory that the plans of a submission take together at the most, unless one alone takes more: sixteen different pictures of 512 x 512
/// with four samples fit.
const MOST_BYTES: u64 = 256 << 20;

/// How many of `plans`, from the first, may share a submission; `buffer_bytes` is the most that one buffer holds.
pub(super) fn fitting(plans: &[&Plan], buffer_bytes: u64) -> usize {
    let mut left = MOST_BYTES.min(buffer_bytes);
    let fits = |&index: &usize| {
        let bytes = bytes(plans[index], &plans[..index]);
        let fits = index == 0 || bytes <= left;
        left = left.saturating_sub(bytes);
        fits
    };
    (0..plans.len().min(MOST_PLANS)).take_while(fits).count()
}

/// What `plan` takes in a submission beside others: what it shares with one of them is counted there. Of everything that grows with the
/// size of a rig, a picture or an answer, so that no buffer of the submission holds more than this comes to.
fn bytes(plan: &Plan, beside: &[&Plan]) -> u64 {
    let is_skinned = |instance| {
        let mut others = beside.iter().flat_map(|other| other.shown_instances());
        others.any(|other| other.is_skinned_like(instance))
    };
    let shown = plan.shown_instances().iter();
    let skin = shown.filter(|instance| !is_skinned(*instance));
    let skin = skin.map(|instance| {
        let rig = instance.rig();
        let palette = rig.bindings().len() * size_of::<SkinDualQuaternion>();
        24 * rig.draw_vertex_count() + palette + 4 * instance.morph_weights().len()
    });
    let outcome = match &plan.wanted {
        Wanted::Picture(picture) => {
            let shape = shape_of(picture);
            let is_there = |other: &&Plan| match &other.wanted {
                Wanted::Picture(picture) => shape_of(picture) == shape,
                Wanted::Vertices(_) => false,
            };
            let targets = if beside.iter().any(is_there) {
                0
            } else {
                shape.bytes()
            };
            let skeleton = &picture.skeleton;
            let solids = &skeleton.solids;
            let lines = skeleton.lines.len() * LINE_CORNERS as usize * size_of::<Segment>();
            let solids =
                solids.vertices.len() * size_of::<SolidVertex>() + 12 * solids.triangles.len();
            let meshes = plan.shown_instances().iter();
            let meshes = meshes.flat_map(|instance| instance.rig().meshes());
            let parts = meshes.map(|mesh| mesh.parts().len()).sum::<usize>();
            let coats = parts * Coats::MOST_STRIDE;
            targets + (4 * shape.size.pixels() + lines + solids + coats) as u64
        }
        Wanted::Vertices(queries) => {
            let attributes = |query: &crate::scene::VertexQuery| {
                usize::from(query.positions) + usize::from(query.normals)
            };
            let bytes = queries
                .iter()
                .map(|query| 12 * query.count * attributes(query));
            bytes.sum::<usize>() as u64
        }
    };
    skin.sum::<usize>() as u64 + outcome
}
