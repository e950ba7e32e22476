//! Lines of constant width in pixels as pairs of triangles: in parity with `shaders/lines.wgsl`.

use super::project::Projection;
use crate::render::Segment;
use std::ops::Range;

/// Four to a segment.
pub(super) const CORNERS: usize = 4;

/// Those of some lines among the corners of all.
pub(super) fn corners(lines: &Range<usize>) -> Range<usize> {
    CORNERS * lines.start..CORNERS * lines.end
}

/// Those of some lines among the triangles of all.
pub(super) fn triangles(lines: &Range<usize>) -> Range<usize> {
    TRIANGLES.len() * lines.start..TRIANGLES.len() * lines.end
}

/// Of each segment, by its corners.
const TRIANGLES: [[u32; 3]; 2] = [[0, 1, 2], [2, 1, 3]];

/// Where a line is cut so that its pixels are defined: a little before the eye's own plane.
const LEAST_W: f32 = 1e-6;
/// Outside the picture: a line that is wholly before the near plane.
const NOWHERE: [f32; 4] = [2.0, 2.0, 2.0, 1.0];

/// Adds corners in clip space and triangles of all `segments`.
pub(super) fn add(
    segments: &[Segment],
    projection: &Projection,
    corners: &mut Vec<[f32; 4]>,
    triangles: &mut Vec<[u32; 3]>,
) {
    for segment in segments {
        let first = corners.len() as u32;
        corners.extend(quad(segment, projection));
        triangles.extend(TRIANGLES.map(|triangle| triangle.map(|corner| first + corner)));
    }
}

/// Left of the start, left of the end, right of the start, right of the end.
fn quad(segment: &Segment, projection: &Projection) -> [[f32; 4]; CORNERS] {
    let mut from = projection.clip_of(segment.from_in_model.to_array());
    let mut to = projection.clip_of(segment.to_in_model.to_array());
    // Distance inside the near plane: depth at most 1.
    let inside = |clip: [f32; 4]| clip[3] - clip[2];
    let (from_inside, to_inside) = (inside(from), inside(to));
    if from_inside < 0.0 && to_inside < 0.0 {
        return [NOWHERE; CORNERS];
    }
    let mix = |a: [f32; 4], b: [f32; 4], share: f32| {
        [0, 1, 2, 3].map(|i| a[i] * (1.0 - share) + b[i] * share)
    };
    if from_inside < 0.0 {
        from = mix(from, to, from_inside / (from_inside - to_inside));
    } else if to_inside < 0.0 {
        to = mix(to, from, to_inside / (to_inside - from_inside));
    }
    // A corner on the near plane is not to be before it by rounding.
    for end in [&mut from, &mut to] {
        end[3] = end[3].max(LEAST_W);
        end[2] = end[2].min(end[3]);
    }
    let half_size = projection.half_size();
    let pixels = |clip: [f32; 4]| [0, 1].map(|axis| clip[axis] / clip[3] * half_size[axis]);
    let (start, end) = (pixels(from), pixels(to));
    let along = [end[0] - start[0], end[1] - start[1]];
    let length_squared = along[0] * along[0] + along[1] * along[1];
    let direction = if length_squared > 1e-12 {
        along.map(|it| it / length_squared.sqrt())
    } else {
        [1.0, 0.0]
    };
    let half_width = segment.width_pixels / 2.0;
    // Ends reach half a width further, so that bones meet without a notch and a point becomes a square.
    let corner = |end: [f32; 4], side: f32, beyond: f32| {
        let offset = [
            -direction[1] * side + direction[0] * beyond,
            direction[0] * side + direction[1] * beyond,
        ];
        let [x, y] = [0, 1].map(|axis| end[axis] + offset[axis] / half_size[axis] * end[3]);
        [x, y, end[2], end[3]]
    };
    [
        corner(from, half_width, -half_width),
        corner(to, half_width, half_width),
        corner(from, -half_width, -half_width),
        corner(to, -half_width, half_width),
    ]
}
