//! Faces of any number of corners cut into triangles. Never lives here: what a corner names.
//!
//! A fan from the first corner is right wherever none of its triangles is turned over, as in every convex face. Any other face is cut by the
//! constrained Delaunay triangulation of its outline, which uses every corner, also one in line with its neighbours.

use glam::{DVec2, DVec3, Vec3};
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};
use std::collections::HashMap;

/// Triangulates the faces of one file.
#[derive(Debug)]
pub(super) struct Triangulator {
    /// How much more work faces may be that no fan fits.
    work_left: u64,
}

/// Why a face is cut into a fan that does not fit it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NotTriangulated {
    CrossesItself,
    TooMuchWork,
}

impl Triangulator {
    /// In squares of numbers of corners, for that is how long one face can take. A single face may have 16,384 corners; it all comes to a
    /// few seconds.
    const WORK: u64 = 1 << 28;

    pub(super) fn new() -> Self {
        Self {
            work_left: Self::WORK,
        }
    }

    /// By number of corner, each wound as the face is. `corners` are at least three.
    ///
    /// # Errors
    /// Where only [`fan`] is left.
    pub(super) fn triangulate(
        &mut self,
        corners: &[Vec3],
    ) -> Result<Vec<[usize; 3]>, NotTriangulated> {
        let outline = match outline(corners) {
            Some(outline) if !fan_fits(&outline) => outline,
            // Its parts cancel out.
            None if !is_in_line(corners) => return Err(NotTriangulated::CrossesItself),
            // No cut of a face without an area shows.
            _ => return Ok(fan(corners.len()).collect()),
        };
        let work = (corners.len() as u64).saturating_pow(2);
        self.work_left = self
            .work_left
            .checked_sub(work)
            .ok_or(NotTriangulated::TooMuchWork)?;
        triangulated(&outline).ok_or(NotTriangulated::CrossesItself)
    }
}

/// All triangles that the first of so many corners makes with two neighbours.
pub(super) fn fan(corners: usize) -> impl Iterator<Item = [usize; 3]> {
    (2..corners).map(|corner| [0, corner - 1, corner])
}

/// Newell's normal: half of its length is the area of the face.
pub(super) fn area_vector(corners: &[Vec3]) -> DVec3 {
    // From a corner of its own: far from the origin little would be left of the sum.
    let origin = corners
        .first()
        .map_or(DVec3::ZERO, |first| first.as_dvec3());
    let from_origin = |corner: &Vec3| corner.as_dvec3() - origin;
    let next = corners.iter().cycle().skip(1);
    let edges = corners.iter().zip(next);
    edges
        .map(|(a, b)| from_origin(a).cross(from_origin(b)))
        .sum()
}

/// The corners as seen along the axis that is nearest to the normal, counter-clockwise: coordinates stay as they are, so that what is in
/// line stays in line. `None` for a face without an area.
fn outline(corners: &[Vec3]) -> Option<Vec<DVec2>> {
    let normal = area_vector(corners);
    let axis = normal.abs().max_position();
    let (across, up) = ((axis + 1) % 3, (axis + 2) % 3);
    let (across, up) = match normal[axis] {
        along if along > 0.0 => (across, up),
        along if along < 0.0 => (up, across),
        _ => return None,
    };
    // Adding 0 leaves one zero of the two.
    let seen = |corner: &Vec3| DVec2::new(corner[across].into(), corner[up].into()) + DVec2::ZERO;
    Some(corners.iter().map(seen).collect())
}

fn is_in_line(corners: &[Vec3]) -> bool {
    fan(corners.len())
        .all(|triangle| area_vector(&triangle.map(|corner| corners[corner])) == DVec3::ZERO)
}

fn fan_fits(outline: &[DVec2]) -> bool {
    fan(outline.len()).all(|triangle| twice_the_area(triangle.map(|corner| outline[corner])) >= 0.0)
}

/// Above 0 of what runs counter-clockwise.
fn twice_the_area([a, b, c]: [DVec2; 3]) -> f64 {
    (b - a).perp_dot(c - a)
}

struct Corner {
    number: usize,
    position: DVec2,
}

impl HasPosition for Corner {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        Point2::new(self.position.x, self.position.y)
    }
}

/// `None` of an outline that crosses itself.
fn triangulated(outline: &[DVec2]) -> Option<Vec<[usize; 3]>> {
    let (corners, edges) = distinct(outline);
    let mut crosses_itself = false;
    let triangulation =
        ConstrainedDelaunayTriangulation::<Corner>::try_bulk_load_cdt(corners, edges, |_| {
            crosses_itself = true
        });
    let triangulation = triangulation.ok().filter(|_| !crosses_itself)?;
    let mut triangles = Vec::with_capacity(outline.len());
    let mut area = 0.0;
    for face in triangulation.inner_faces() {
        let corners = face.vertices().map(|vertex| vertex.data().number);
        let positions = corners.map(|corner| outline[corner]);
        let middle = (positions[0] + positions[1] + positions[2]) / 3.0;
        if winding(outline, middle) > 0 {
            triangles.push(corners);
            area += twice_the_area(positions);
        }
    }
    let whole: f64 = fan(outline.len())
        .map(|triangle| twice_the_area(triangle.map(|corner| outline[corner])))
        .sum();
    /// Of the area, for rounding.
    const TOLERANCE: f64 = 1e-6;
    // An outline that touches itself in other ways than one with a seam to a hole has no defined inside.
    ((area - whole).abs() <= TOLERANCE * whole).then_some(triangles)
}

/// The corners that stand apart, and the edges between them, each once.
fn distinct(outline: &[DVec2]) -> (Vec<Corner>, Vec<[usize; 2]>) {
    let mut corners = Vec::with_capacity(outline.len());
    let mut places = HashMap::new();
    let place = |(number, &position): (usize, &DVec2)| {
        let place = places.entry(position.to_array().map(f64::to_bits));
        *place.or_insert_with(|| {
            corners.push(Corner { number, position });
            corners.len() - 1
        })
    };
    let places: Vec<usize> = outline.iter().enumerate().map(place).collect();
    let next = places.iter().cycle().skip(1);
    let pairs = places.iter().zip(next).filter(|(a, b)| a != b);
    let mut edges: Vec<_> = pairs.map(|(&a, &b)| [a.min(b), a.max(b)]).collect();
    edges.sort_unstable();
    edges.dedup();
    (corners, edges)
}

/// How often the outline runs around a point, counter-clockwise.
fn winding(outline: &[DVec2], point: DVec2) -> i32 {
    let next = outline.iter().cycle().skip(1);
    let edges = outline.iter().zip(next);
    let turn = |(&from, &to): (&DVec2, &DVec2)| {
        let side = twice_the_area([from, to, point]);
        match (from.y <= point.y, to.y <= point.y) {
            (true, false) if side > 0.0 => 1,
            (false, true) if side < 0.0 => -1,
            _ => 0,
        }
    };
    edges.map(turn).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners(outline: &[[f32; 2]]) -> Vec<Vec3> {
        let corner = |&[x, y]: &[f32; 2]| Vec3::new(x, y, 0.0);
        outline.iter().map(corner).collect()
    }

    /// The triangles, and the sum of their areas; each runs counter-clockwise.
    fn cut(corners: &[Vec3]) -> (Vec<[usize; 3]>, f64) {
        let triangles = Triangulator::new()
            .triangulate(corners)
            .expect("it can be cut");
        let areas = triangles.iter().map(|triangle| {
            let area = area_vector(&triangle.map(|corner| corners[corner]));
            assert!(area.dot(area_vector(corners)) >= 0.0, "{triangle:?}");
            area.length() / 2.0
        });
        let area = areas.sum();
        (triangles, area)
    }

    #[test]
    fn what_a_fan_fits_is_a_fan() {
        let square = corners(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        assert_eq!(cut(&square).0, [[0, 1, 2], [0, 2, 3]]);
        let in_line = corners(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 2.0]]);
        assert_eq!(cut(&in_line).0, [[0, 1, 2], [0, 2, 3]]);
        let flat = corners(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.0, 0.0]]);
        assert_eq!(cut(&flat).0.len(), 2);
    }

    #[test]
    fn a_concave_face_keeps_its_notches_and_every_corner() {
        // Corners in line with their neighbours on three sides.
        let hook = [
            [0.0, 0.0],
            [1.0, 0.0],
            [2.0, 0.0],
            [2.0, 1.0],
            [2.0, 2.0],
            [1.0, 2.0],
            [1.0, 1.5],
            [1.5, 1.5],
            [1.5, 0.5],
            [0.0, 0.5],
        ];
        for start in 0..hook.len() {
            let mut outline = hook;
            outline.rotate_left(start);
            for is_turned in [false, true] {
                if is_turned {
                    outline.reverse();
                }
                let (triangles, area) = cut(&corners(&outline));
                assert!((area - 2.0).abs() < 1e-9, "{area}");
                assert_eq!(triangles.len(), hook.len() - 2);
                let used = |corner| triangles.as_flattened().contains(&corner);
                assert!((0..hook.len()).all(used), "{triangles:?}");
            }
        }
    }

    #[test]
    fn a_face_is_cut_in_its_own_plane() {
        let notched = [[1.0, 0.5], [0.0, 2.0], [0.0, 0.0], [2.0, 0.0], [2.0, 2.0]];
        let placed: [fn([f32; 2]) -> Vec3; 4] = [
            |[a, b]| Vec3::new(5.0, a, b),
            |[a, b]| Vec3::new(a, -5.0, b),
            |[a, b]| Vec3::new(a, b, 1e6),
            |[a, b]| Vec3::new(a, b, a - 3.0 * b),
        ];
        for place in placed {
            let corners: Vec<_> = notched.iter().map(|&at| place(at)).collect();
            let (triangles, area) = cut(&corners);
            assert_eq!(triangles.len(), 3);
            assert!((area - area_vector(&corners).length() / 2.0).abs() < 1e-6);
        }
    }

    #[test]
    fn a_hole_that_a_seam_leads_to_stays_open() {
        // The outer square, a seam inward, the inner square the other way round, and back along the seam.
        let framed = corners(&[
            [0.0, 0.0],
            [4.0, 0.0],
            [4.0, 4.0],
            [0.0, 4.0],
            [0.0, 0.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [3.0, 3.0],
            [3.0, 1.0],
            [1.0, 1.0],
        ]);
        let (triangles, area) = cut(&framed);
        assert_eq!(triangles.len(), 8);
        assert!((area - 12.0).abs() < 1e-9);
    }

    #[test]
    fn a_face_that_crosses_itself_is_told() {
        let bow = corners(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 1.0]]);
        assert_eq!(
            Triangulator::new().triangulate(&bow),
            Err(NotTriangulated::CrossesItself)
        );
        let even_bow = corners(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]]);
        assert_eq!(
            Triangulator::new().triangulate(&even_bow),
            Err(NotTriangulated::CrossesItself)
        );
        let in_line = corners(&[[0.0, 0.0], [1.0, 1.0], [3.0, 3.0], [2.0, 2.0]]);
        assert_eq!(
            Triangulator::new().triangulate(&in_line),
            Ok(fan(4).collect())
        );
        let star = (0..5).map(|corner| {
            let angle = f64::from(corner) * 0.8 * std::f64::consts::PI;
            [libm::cos(angle) as f32, libm::sin(angle) as f32]
        });
        let star = corners(&star.collect::<Vec<_>>());
        assert_eq!(
            Triangulator::new().triangulate(&star),
            Err(NotTriangulated::CrossesItself)
        );
    }

    #[test]
    fn work_is_bounded_over_all_faces() {
        let comb = |teeth: u32| {
            let tooth = |at: u32| [[at as f32, 1.0], [at as f32 + 0.5, 0.5]];
            let mut outline: Vec<_> = (0..teeth).flat_map(tooth).collect();
            outline.extend([[teeth as f32, 0.0], [0.0, 0.0]]);
            outline.reverse();
            corners(&outline)
        };
        assert_eq!(
            Triangulator::new().triangulate(&comb(10_000)),
            Err(NotTriangulated::TooMuchWork)
        );
        let mut triangulator = Triangulator {
            work_left: 1_000_000,
        };
        let few = comb(100);
        let cuts = (0..200).map(|_| triangulator.triangulate(&few));
        // The square of 202 corners goes 24 times into the work.
        assert_eq!(cuts.filter(Result::is_ok).count(), 24);
    }
}
