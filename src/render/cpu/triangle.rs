//! The geometry of one triangle on the picture: its corners, which side is seen, and how a quantity changes over it.
//! Never lives here: which samples it covers.

use super::project::{Projected, STEPS};
use crate::render::cull::Side;

/// A vertex of a triangle with all that is interpolated over it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Corner {
    pub projected: Projected,
    /// Position and normal are in world space.
    pub position: [f32; 3],
    pub normal: [f32; 3],
    pub texcoord: [f32; 2],
    /// Linear RGB and opacity.
    pub color: [f32; 4],
}

/// Which side of a triangle is seen; `None` of one that is a line.
#[inline(always)]
pub(super) fn side(corners: [Projected; 3]) -> Option<Side> {
    match doubled_area(corners) {
        0 => None,
        // The picture's rows run downward.
        area if area < 0 => Some(Side::Front),
        _ => Some(Side::Back),
    }
}

/// In squared steps; positive where the corners run clockwise on the picture.
#[inline(always)]
pub(super) fn doubled_area([a, b, c]: [Projected; 3]) -> i64 {
    let (bx, by) = (i64::from(b.x - a.x), i64::from(b.y - a.y));
    let (cx, cy) = (i64::from(c.x - a.x), i64::from(c.y - a.y));
    bx * cy - cx * by
}

/// A quantity that is linear over the picture: its value at a point, and how it changes from pixel to pixel.
#[derive(Clone, Copy)]
pub(super) struct Slope {
    pub origin: [f32; 2],
    pub by_x: [f32; 2],
    pub by_y: [f32; 2],
}

impl Slope {
    /// Over a triangle that is no line: a quantity with the values `a`, `b`, `c` at the corners changes by
    /// `(b − a) · by_x[0] + (c − a) · by_x[1]` to the right, and likewise downward.
    #[inline(always)]
    pub(super) fn of(corners: [Projected; 3]) -> Self {
        let step = 1.0 / STEPS as f32;
        // Of whole numbers, so that no sliver's comes to nothing.
        let rounded_area = doubled_area(corners) as f32 * (step * step);
        let unrounded = [corners[0].pixel, corners[1].pixel, corners[2].pixel];
        let area = Sides::of(unrounded).doubled_area();
        // The rounded corners say what is covered, the unrounded ones what is there: over a triangle of less than a pixel rounding would
        // bend everything. A sliver that rounding makes another one of is taken as rounded.
        let (alike, squared) = (area * rounded_area, rounded_area * rounded_area);
        if alike > 0.5 * squared && alike < 2.0 * squared {
            Self::between(unrounded, area)
        } else {
            let [a, b, c] = corners;
            let rounded = [[a.x, a.y], [b.x, b.y], [c.x, c.y]];
            Self::between(
                rounded.map(|at| at.map(|steps| steps as f32 * step)),
                rounded_area,
            )
        }
    }

    #[inline(always)]
    fn between(corners: [[f32; 2]; 3], doubled_area: f32) -> Self {
        let Sides { ab, ac } = Sides::of(corners);
        let share = 1.0 / doubled_area;
        Self {
            origin: corners[0],
            by_x: [ac[1] * share, -ab[1] * share],
            by_y: [-ac[0] * share, ab[0] * share],
        }
    }
}

/// From the first corner of a triangle to the others, in pixels.
struct Sides {
    ab: [f32; 2],
    ac: [f32; 2],
}

impl Sides {
    #[inline(always)]
    fn of([a, b, c]: [[f32; 2]; 3]) -> Self {
        Self {
            ab: [b[0] - a[0], b[1] - a[1]],
            ac: [c[0] - a[0], c[1] - a[1]],
        }
    }

    #[inline(always)]
    fn doubled_area(&self) -> f32 {
        self.ab[0] * self.ac[1] - self.ac[0] * self.ab[1]
    }
}
