//! Triangles that reach before the near plane or far out of the picture, cut down to what fixed point holds (Sutherland and Hodgman,
//! "Reentrant polygon clipping", 1974). Few are; most are drawn as they are.

use super::project::{GUARD, Projection};
use super::triangle::Corner;

/// A corner that need not fall anywhere.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unplaced {
    pub clip: [f32; 4],
    pub corner: Corner,
}

/// Three corners, and one more for each plane that may cut one off.
const MOST_CORNERS: usize = 3 + PLANES;
const PLANES: usize = 5;
/// The first.
const NEAR: usize = 0;

/// What is left of a triangle.
pub(super) fn clip(
    corners: [Unplaced; 3],
    projection: &Projection,
) -> impl Iterator<Item = [Corner; 3]> {
    let is_finite = |corner: &Unplaced| corner.clip.iter().all(|number| number.is_finite());
    let mut polygon = if corners.iter().all(is_finite) {
        Polygon::of(corners)
    } else {
        Polygon::empty()
    };
    for plane in 0..PLANES {
        polygon = polygon.cut(plane == NEAR, |clip| {
            distance_inside(plane, clip, projection)
        });
    }
    let corner = move |index: usize| polygon.corners[index];
    (2..polygon.count).filter_map(move |third| {
        let corners = [corner(0)?, corner(third - 1)?, corner(third)?];
        // What is left before the near plane is ahead of the eye, but for pieces that rounding made of nothing.
        let is_ahead = corners.iter().all(|corner| corner.clip[3] > 0.0);
        is_ahead.then(|| {
            corners.map(|Unplaced { clip, corner }| Corner {
                projected: projection.place_inside(clip),
                ..corner
            })
        })
    })
}

/// Positive inside: behind the near plane first, for only there the rest makes sense; then within the guard band.
fn distance_inside(plane: usize, [x, y, z, w]: [f32; 4], projection: &Projection) -> f32 {
    let [half_width, half_height] = projection.half_size();
    let [low, high] = GUARD;
    match plane {
        NEAR => w - z,
        1 => x * half_width + w * (half_width - low),
        2 => w * (high - half_width) - x * half_width,
        3 => w * (half_height - low) - y * half_height,
        _ => y * half_height + w * (high - half_height),
    }
}

struct Polygon {
    corners: [Option<Unplaced>; MOST_CORNERS],
    count: usize,
}

impl Polygon {
    fn of(corners: [Unplaced; 3]) -> Self {
        let mut polygon = Self::empty();
        corners.into_iter().for_each(|corner| polygon.add(corner));
        polygon
    }

    fn empty() -> Self {
        Self {
            corners: [None; MOST_CORNERS],
            count: 0,
        }
    }

    fn add(&mut self, corner: Unplaced) {
        // Where rounding bent a sliver so that a plane cuts it more than twice, what is too much is too thin to be seen.
        if let Some(free) = self.corners.get_mut(self.count) {
            *free = Some(corner);
            self.count += 1;
        }
    }

    fn corners(&self) -> impl Iterator<Item = Unplaced> + Clone {
        self.corners[..self.count].iter().flatten().copied()
    }

    fn cut(&self, is_near: bool, distance: impl Fn([f32; 4]) -> f32) -> Self {
        let between = |inside: Unplaced, outside: Unplaced, share: f32| {
            let mut cut = inside.toward(outside, share);
            if is_near {
                // There z is w. Whichever of them is the same at both ends is right to the last bit, and the other one may be nothing but
                // rounding where the plane is close to the eye.
                if inside.clip[3] == outside.clip[3] {
                    cut.clip[2] = cut.clip[3];
                } else {
                    cut.clip[3] = cut.clip[2];
                }
            }
            cut
        };
        let mut left = Self::empty();
        let next = self.corners().cycle().skip(1);
        for (corner, next) in self.corners().zip(next) {
            let (here, there) = (distance(corner.clip), distance(next.clip));
            if here >= 0.0 {
                left.add(corner);
            }
            // Always from the inside out, so that both triangles at an edge are cut at the same point.
            if here >= 0.0 && there < 0.0 {
                left.add(between(corner, next, here / (here - there)));
            } else if here < 0.0 && there >= 0.0 {
                left.add(between(next, corner, there / (there - here)));
            }
        }
        left
    }
}

impl Unplaced {
    fn toward(self, other: Self, share: f32) -> Self {
        fn mix<const N: usize>(a: [f32; N], b: [f32; N], share: f32) -> [f32; N] {
            std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share)
        }
        let (from, to) = (self.corner, other.corner);
        Self {
            clip: mix(self.clip, other.clip, share),
            corner: Corner {
                position: mix(from.position, to.position, share),
                normal: mix(from.normal, to.normal, share),
                texcoord: mix(from.texcoord, to.texcoord, share),
                color: mix(from.color, to.color, share),
                ..from
            },
        }
    }
}
