//! An axis-aligned box.

use glam::{DVec3, Vec3};

/// Smallest and largest corner, in the space of the points that it is made of; `min <= max` on every axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The smallest coordinate of each axis.
    pub min: DVec3,
    /// The largest coordinate of each axis.
    pub max: DVec3,
}

impl Bounds {
    /// Of a rig that has nothing: a point at the origin.
    pub const ORIGIN: Self = Self {
        min: DVec3::ZERO,
        max: DVec3::ZERO,
    };

    /// `None` where there are no points.
    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Option<Self> {
        points
            .into_iter()
            .map(|point| Self {
                min: point,
                max: point,
            })
            .reduce(|a, b| a.and(&b))
    }

    /// Of vertices, three numbers each. `None` where there are none.
    pub fn of_positions(positions: &[f32]) -> Option<Self> {
        // Four at a time, which the compiler makes vectors of.
        let (fours, rest) = positions.as_chunks::<12>();
        let (mut least, mut most) = ([f32::INFINITY; 12], [f32::NEG_INFINITY; 12]);
        for four in fours {
            for lane in 0..12 {
                least[lane] = least[lane].min(four[lane]);
                most[lane] = most[lane].max(four[lane]);
            }
        }
        let min = points(&least).chain(points(rest)).reduce(Vec3::min)?;
        let max = points(&most).chain(points(rest)).reduce(Vec3::max)?;
        (min.x <= max.x).then(|| Self {
            min: min.as_dvec3(),
            max: max.as_dvec3(),
        })
    }

    /// Of what either has.
    pub fn and(&self, other: &Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// All eight; x changes from each to the next, y after two, z after four.
    pub fn corners(&self) -> impl Iterator<Item = DVec3> + use<> {
        let Self { min, max } = *self;
        (0..8).map(move |corner: usize| {
            let side = |axis: usize| {
                if corner >> axis & 1 == 0 {
                    min[axis]
                } else {
                    max[axis]
                }
            };
            DVec3::new(side(0), side(1), side(2))
        })
    }

    /// The middle of both corners.
    pub fn center(&self) -> DVec3 {
        (self.min + self.max) / 2.0
    }

    /// The length of the diagonal, which is what `size` means where a rule speaks of the size of a rig.
    pub fn size(&self) -> f64 {
        self.min.distance(self.max)
    }

    /// Radius of the sphere about the box. A rig that is a single point gets one of 1, so that there is something to look at.
    pub fn radius(&self) -> f64 {
        match self.size() / 2.0 {
            0.0 => 1.0,
            radius => radius,
        }
    }
}

fn points(numbers: &[f32]) -> impl Iterator<Item = Vec3> {
    let points = numbers.as_chunks().0.iter();
    points.map(|point| Vec3::from_array(*point))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn those_of_vertices_are_those_of_their_points() {
        for count in [1, 3, 4, 5, 9, 40] {
            let number = |index: usize| ((index * 7919) % 1013) as f32 - 500.0;
            let positions: Vec<f32> = (0..3 * count).map(number).collect();
            let wanted = Bounds::of(points(&positions).map(Vec3::as_dvec3));
            assert_eq!(Bounds::of_positions(&positions), wanted, "{count}");
        }
        assert_eq!(Bounds::of_positions(&[]), None);
    }
}
