//! How much may share a submission. Never lives here: what is done with the rest.

use super::material_buffer::MaterialBuffer;
use super::readback::query_bytes;
use super::shade::{LINE_CORNERS, MOST_PARAMS_STRIDE, shape_of};
use crate::pose::SkinDualQuaternion;
use crate::render::{Plan, Segment, SkeletonView, Skin, SolidVertex};

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
    let queries = plan.vertices.iter().map(query_bytes).sum::<u64>();
    skin_bytes(plan, beside) + image_bytes(plan, beside) + queries
}

fn skins(plan: &Plan) -> impl Iterator<Item = &Skin> {
    let drawn = plan.drawn().map(|(_, instance)| instance.skin());
    let queried = plan.vertices.iter();
    drawn.chain(queried.map(|query| plan.instances[query.instance].skin()))
}

fn skin_bytes(plan: &Plan, beside: &[&Plan]) -> u64 {
    let bytes = skins(plan).enumerate().map(|(index, skin)| {
        let others = beside.iter().flat_map(|other| skins(other));
        if others
            .chain(skins(plan).take(index))
            .any(|other| other == skin)
        {
            return 0;
        }
        let rig = skin.rig();
        let palette = rig.bindings().len() * size_of::<SkinDualQuaternion>();
        24 * rig.draw_vertex_count() + palette + 4 * skin.morph_weights().len()
    });
    bytes.sum::<usize>() as u64
}

fn image_bytes(plan: &Plan, beside: &[&Plan]) -> u64 {
    let Some(image) = &plan.image else {
        return 0;
    };
    let shape = shape_of(plan, &image.scene);
    let is_there = |other: &&Plan| {
        let image = other.image.as_ref();
        image.is_some_and(|image| shape_of(other, &image.scene) == shape)
    };
    let targets = if beside.iter().any(is_there) {
        0
    } else {
        shape.bytes()
    };
    let rasters = image.outputs.iter().map(|kind| kind.bytes(shape.size));
    let instances = plan.instances.iter().map(|instance| {
        let SkeletonView { lines, solids } = instance.skeleton();
        let lines = lines.len() * LINE_CORNERS as usize * size_of::<Segment>();
        let solids = solids.vertices.len() * size_of::<SolidVertex>() + 12 * solids.triangles.len();
        let parts = instance
            .rig()
            .meshes()
            .iter()
            .map(|mesh| mesh.parts().len());
        let materials = parts.sum::<usize>() * MaterialBuffer::MOST_STRIDE;
        lines + solids + materials + MOST_PARAMS_STRIDE
    });
    targets + (rasters.sum::<usize>() + instances.sum::<usize>()) as u64
}
