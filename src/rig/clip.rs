//! Animations as data: curves over time. Never lives here: what becomes of a pose that they are applied to.

/// An animation: each channel sets one DOF.
#[derive(Debug)]
pub struct Clip {
    /// Unique in its rig.
    pub name: String,
    /// From when to when it is meant to be played, in seconds. Reported, never applied.
    pub range: [f64; 2],
    pub channels: Vec<Channel>,
}

/// A curve and what it sets.
#[derive(Debug)]
pub struct Channel {
    /// Index into the rig's DOFs.
    pub dof: usize,
    pub curve: Curve,
}

/// A value over time: cubic Hermite spans between keys.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// In ascending order of time, no two at the same; a curve without keys is 0 everywhere.
    pub keys: Vec<Key>,
    /// What holds before the first key.
    pub before: Extrapolation,
    /// What holds after the last key.
    pub after: Extrapolation,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key {
    /// In seconds.
    pub time: f64,
    pub value: f64,
    /// Slopes by which the curve comes in and goes out, in value per second.
    pub slope_in: f64,
    pub slope_out: f64,
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

impl Curve {
    /// # Formula
    /// On a span of `d` seconds, with `u` from 0 to 1: the cubic Hermite polynomial of its end values and of `d` times its end slopes.
    /// Outside of the keys, with `c = floor((t - first) / (last - first))`: `Cycle` goes back by `c` lengths, `CycleOffset` adds
    /// `c · (last value - first value)` to that, `Bounce` mirrors it where `c` is odd. A curve of a single key has its value.
    pub fn at(&self, time: f64) -> f64 {
        let (Some(first), Some(last)) = (self.keys.first(), self.keys.last()) else {
            return 0.0;
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
        // Past this nothing is left of a time that it could be told by.
        let cycles = ((time - first.time) / length)
            .floor()
            .clamp(-MOST_CYCLES, MOST_CYCLES);
        let wrapped = || (time - cycles * length).clamp(first.time, last.time);
        match extrapolation {
            Extrapolation::Constant => end.value,
            Extrapolation::Linear => end.value + slope * (time - end.time),
            Extrapolation::Cycle => self.within(wrapped()),
            Extrapolation::CycleOffset => {
                self.within(wrapped()) + cycles * (last.value - first.value)
            }
            Extrapolation::Bounce if cycles.rem_euclid(2.0) == 1.0 => {
                self.within(first.time + last.time - wrapped())
            }
            Extrapolation::Bounce => self.within(wrapped()),
        }
    }

    /// At a time from the first key's to the last one's.
    fn within(&self, time: f64) -> f64 {
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
        let (u2, u3) = (u * u, u * u * u);
        from.value * (2.0 * u3 - 3.0 * u2 + 1.0)
            + to.value * (3.0 * u2 - 2.0 * u3)
            + length * (from.slope_out * (u3 - 2.0 * u2 + u) + to.slope_in * (u3 - u2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(time: f64, value: f64, slope: f64) -> Key {
        Key {
            time,
            value,
            slope_in: slope,
            slope_out: slope,
        }
    }

    fn curve(keys: Vec<Key>, extrapolation: Extrapolation) -> Curve {
        Curve {
            keys,
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
