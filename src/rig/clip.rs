//! Animations as data: curves over time. Never lives here: what becomes of a pose that they are applied to.

use glam::DQuat;

/// An animation: each channel sets one DOF or the rotation of one joint.
#[derive(Debug)]
pub struct Clip {
    /// Unique in its rig.
    pub name: String,
    /// From when to when it is meant to be played, in seconds. Reported, never applied.
    pub range: [f64; 2],
    /// What it sets; DOFs and joints that none of them names keep the values of the pose.
    pub channels: Vec<Channel>,
}

/// A curve and what it sets.
#[derive(Debug)]
pub enum Channel {
    /// Sets one DOF.
    Dof {
        /// Index into the rig's DOFs.
        dof: usize,
        /// In the DOF's unit.
        curve: Curve<f64>,
    },
    /// Sets all three angles of a joint at once.
    Rotation {
        /// Index into the skeleton's joints.
        joint: usize,
        /// Of the local rotation; what it comes to is made unit.
        curve: Curve<DQuat>,
    },
}

/// A value over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve<V> {
    /// In ascending order of time, no two at the same; a curve without keys is 0, or no rotation, everywhere.
    pub keys: Vec<Key<V>>,
    /// What holds between keys.
    pub interpolation: Interpolation,
    /// What holds before the first key.
    pub before: Extrapolation,
    /// What holds after the last key.
    pub after: Extrapolation,
}

/// A value at a moment, and the slopes of the curve there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key<V> {
    /// In seconds.
    pub time: f64,
    /// In the unit of what the curve sets.
    pub value: V,
    /// The slope by which the curve comes in, in value per second. Between keys only [`Interpolation::Cubic`] looks at slopes.
    pub slope_in: V,
    /// The slope by which it goes out, in the same unit.
    pub slope_out: V,
}

/// What holds between two keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Interpolation {
    /// The value of the one before.
    Step,
    /// Evenly from one to the other: in a straight line, or by the shorter way around.
    Linear,
    /// A cubic Hermite span.
    #[default]
    Cubic,
}

/// What a curve can be of.
pub trait Value: Copy {
    const NOTHING: Self;

    /// `Σ factor · value`.
    fn sum<const N: usize>(terms: [(f64, Self); N]) -> Self;

    /// Evenly from one to another.
    fn between(from: Self, to: Self, share: f64) -> Self;
}

impl Value for f64 {
    const NOTHING: Self = 0.0;

    fn sum<const N: usize>(terms: [(f64, Self); N]) -> Self {
        terms
            .into_iter()
            .map(|(factor, value)| factor * value)
            .sum()
    }

    fn between(from: Self, to: Self, share: f64) -> Self {
        from + (to - from) * share
    }
}

impl Value for DQuat {
    const NOTHING: Self = Self::IDENTITY;

    fn sum<const N: usize>(terms: [(f64, Self); N]) -> Self {
        let terms = terms.into_iter();
        terms.fold(Self::from_array([0.0; 4]), |sum, (factor, value)| {
            sum + value * factor
        })
    }

    fn between(from: Self, to: Self, share: f64) -> Self {
        slerp(from, to, share)
    }
}

/// From one unit quaternion to another by the shorter way, at an even speed.
pub fn slerp(from: DQuat, to: DQuat, share: f64) -> DQuat {
    let cosine = from.dot(to);
    let to = if cosine < 0.0 { -to } else { to };
    let cosine = cosine.abs();
    // Past this the sine is mostly rounding, and the chord as good as the arc.
    if cosine > 1.0 - 1e-9 {
        return (from * (1.0 - share) + to * share).normalize();
    }
    let angle = libm::acos(cosine);
    let sine = libm::sin(angle);
    from * (libm::sin((1.0 - share) * angle) / sine) + to * (libm::sin(share * angle) / sine)
}

/// How a curve goes on beyond its keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extrapolation {
    /// The value at the end.
    Constant,
    /// Along the slope at the end: into the first key, out of the last.
    Linear,
    /// Over and over.
    Cycle,
    /// Over and over, each time starting where the last one ended.
    CycleOffset,
    /// Over and over, every other time backwards.
    Bounce,
}

/// Rounds of a curve that cycles; more of them than f64 can count one by one.
const MOST_CYCLES: f64 = 1e15;

impl<V: Value> Curve<V> {
    /// # Formula
    /// On a cubic span of `d` seconds, with `u` from 0 to 1: the cubic Hermite polynomial of its end values and of `d` times its end slopes.
    /// Outside of the keys, with `c = floor((t - first) / (last - first))`: `Cycle` goes back by `c` lengths, `CycleOffset` adds
    /// `c · (last value - first value)` to that, `Bounce` mirrors it where `c` is odd. A curve of a single key has its value.
    pub fn at(&self, time: f64) -> V {
        let (Some(first), Some(last)) = (self.keys.first(), self.keys.last()) else {
            return V::NOTHING;
        };
        if self.keys.len() == 1 {
            return first.value;
        }
        let (end, slope, extrapolation) = if time < first.time {
            (first, first.slope_in, self.before)
        } else if time > last.time {
            (last, last.slope_out, self.after)
        } else {
            return self.within(time);
        };
        let length = last.time - first.time;
        // Beyond this, a time inside the curve has no significant digits left.
        let cycles = ((time - first.time) / length)
            .floor()
            .clamp(-MOST_CYCLES, MOST_CYCLES);
        let wrapped = || (time - cycles * length).clamp(first.time, last.time);
        match extrapolation {
            Extrapolation::Constant => end.value,
            Extrapolation::Linear => V::sum([(1.0, end.value), (time - end.time, slope)]),
            Extrapolation::Cycle => self.within(wrapped()),
            Extrapolation::CycleOffset => V::sum([
                (1.0, self.within(wrapped())),
                (cycles, V::sum([(1.0, last.value), (-1.0, first.value)])),
            ]),
            Extrapolation::Bounce if cycles.rem_euclid(2.0) == 1.0 => {
                self.within(first.time + last.time - wrapped())
            }
            Extrapolation::Bounce => self.within(wrapped()),
        }
    }

    /// At a time from the first key's to the last one's.
    fn within(&self, time: f64) -> V {
        let after = self.keys.partition_point(|key| key.time <= time);
        let (Some(from), to) = (
            after.checked_sub(1).map(|i| self.keys[i]),
            self.keys.get(after),
        ) else {
            return self.keys[0].value;
        };
        let Some(to) = to else {
            return from.value;
        };
        let length = to.time - from.time;
        let u = (time - from.time) / length;
        match self.interpolation {
            Interpolation::Step => from.value,
            Interpolation::Linear => V::between(from.value, to.value, u),
            Interpolation::Cubic => {
                let (u2, u3) = (u * u, u * u * u);
                V::sum([
                    (2.0 * u3 - 3.0 * u2 + 1.0, from.value),
                    (3.0 * u2 - 2.0 * u3, to.value),
                    (length * (u3 - 2.0 * u2 + u), from.slope_out),
                    (length * (u3 - u2), to.slope_in),
                ])
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(time: f64, value: f64, slope: f64) -> Key<f64> {
        Key {
            time,
            value,
            slope_in: slope,
            slope_out: slope,
        }
    }

    fn curve(keys: Vec<Key<f64>>, extrapolation: Extrapolation) -> Curve<f64> {
        Curve {
            keys,
            interpolation: Interpolation::Cubic,
            before: extrapolation,
            after: extrapolation,
        }
    }

    #[test]
    fn a_span_meets_its_keys_and_their_slopes() {
        let curve = curve(
            vec![key(1.0, 2.0, -3.0), key(3.0, 5.0, 0.5)],
            Extrapolation::Constant,
        );
        assert_eq!((curve.at(1.0), curve.at(3.0)), (2.0, 5.0));
        let slope = |t: f64| (curve.at(t + 1e-6) - curve.at(t - 1e-6)) / 2e-6;
        assert!(
            (slope(1.0 + 2e-6) + 3.0).abs() < 1e-4,
            "{}",
            slope(1.0 + 2e-6)
        );
        assert!((slope(3.0 - 2e-6) - 0.5).abs() < 1e-4);
        // Where both slopes are those of the straight line, it is one.
        let straight = super::tests::curve(
            vec![key(0.0, 0.0, 2.0), key(4.0, 8.0, 2.0)],
            Extrapolation::Linear,
        );
        for time in [-3.0, 0.0, 0.7, 3.9, 11.0] {
            assert!((straight.at(time) - 2.0 * time).abs() < 1e-12);
        }
    }

    #[test]
    fn each_way_of_going_on_is_its_own() {
        // A ramp from 1 at t = 1 to 3 at t = 3, flat at both ends.
        let keys = vec![key(1.0, 1.0, 0.0), key(3.0, 3.0, 0.0)];
        let at = |extrapolation, time| curve(keys.clone(), extrapolation).at(time);
        let inside = |time| at(Extrapolation::Constant, time);
        for (extrapolation, time, wanted) in [
            (Extrapolation::Constant, -4.0, 1.0),
            (Extrapolation::Constant, 9.0, 3.0),
            (Extrapolation::Linear, 9.0, 3.0),
            (Extrapolation::Cycle, 3.5, inside(1.5)),
            (Extrapolation::Cycle, 0.5, inside(2.5)),
            (Extrapolation::CycleOffset, 3.5, inside(1.5) + 2.0),
            (Extrapolation::CycleOffset, 0.5, inside(2.5) - 2.0),
            (Extrapolation::CycleOffset, 7.5, inside(1.5) + 6.0),
            (Extrapolation::Bounce, 3.5, inside(2.5)),
            (Extrapolation::Bounce, 0.5, inside(1.5)),
            (Extrapolation::Bounce, 5.5, inside(1.5)),
        ] {
            assert_eq!(
                at(extrapolation, time),
                wanted,
                "{extrapolation:?} at {time}"
            );
        }
    }

    #[test]
    fn one_key_is_a_constant_and_none_is_zero() {
        assert_eq!(
            curve(vec![key(1.0, 4.0, 9.0)], Extrapolation::Linear).at(7.0),
            4.0
        );
        assert_eq!(curve(Vec::new(), Extrapolation::Cycle).at(7.0), 0.0);
    }

    #[test]
    fn a_time_astronomically_far_off_is_still_a_number() {
        let lengths = [1e-9, 1e-300, 1e-320].into_iter();
        for keys in lengths.map(|length| vec![key(0.0, 1.0, 0.0), key(length, 2.0, 0.0)]) {
            for extrapolation in [
                Extrapolation::Linear,
                Extrapolation::Cycle,
                Extrapolation::CycleOffset,
                Extrapolation::Bounce,
            ] {
                for time in [1e9, -1e9] {
                    let value = curve(keys.clone(), extrapolation).at(time);
                    assert!(value.is_finite(), "{extrapolation:?} at {time}");
                }
            }
        }
    }
}
