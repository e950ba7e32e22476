//! Channels of keys, evaluated at a time: cubic Hermite spans and what goes on before the first key and after the last. Never lives here: what
//! a channel moves.

#[derive(Debug, Clone)]
pub struct Clip {
    pub name: String,
    pub channels: Vec<Channel>,
}

#[derive(Debug, Clone)]
pub struct Channel {
    pub before: Extrapolation,
    pub after: Extrapolation,
    pub keys: Vec<Key>,
}

#[derive(Debug, Clone, Copy)]
pub struct Key {
    pub time: f64,
    pub value: f64,
    pub arriving: Tangent,
    pub leaving: Tangent,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tangent {
    Flat,
    Linear,
    Smooth,
    /// Change of value in a second.
    Fixed(f64),
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Extrapolation {
    Constant,
    Linear,
    Cycle,
    CycleOffset,
    Bounce,
}

impl Channel {
    pub fn at(&self, time: f64) -> f64 {
        let (first, last) = match self.keys.as_slice() {
            [] => return 0.0,
            [only] => return only.value,
            [first, .., last] => (first, last),
        };
        let (mode, end, slope) = if time < first.time {
            let slope = self.slope(0, first.arriving, Side::Arriving);
            (self.before, first, slope)
        } else if time > last.time {
            let slope = self.slope(self.keys.len() - 1, last.leaving, Side::Leaving);
            (self.after, last, slope)
        } else {
            return self.between_keys(time);
        };
        let length = last.time - first.time;
        let cycles = ((time - first.time) / length).floor();
        let wrapped = time - cycles * length;
        match mode {
            Extrapolation::Constant => end.value,
            Extrapolation::Linear => end.value + slope * (time - end.time),
            Extrapolation::Cycle => self.between_keys(wrapped),
            Extrapolation::CycleOffset => {
                self.between_keys(wrapped) + cycles * (last.value - first.value)
            }
            // Every other time backward.
            Extrapolation::Bounce if cycles.rem_euclid(2.0) == 1.0 => {
                self.between_keys(first.time + last.time - wrapped)
            }
            Extrapolation::Bounce => self.between_keys(wrapped),
        }
    }

    /// Rounding may have put the time a little outside, where the ends' values hold.
    fn between_keys(&self, time: f64) -> f64 {
        let next = self.keys.partition_point(|key| key.time <= time);
        if next == 0 {
            return self.keys[0].value;
        }
        let (from, Some(to)) = (&self.keys[next - 1], self.keys.get(next)) else {
            return self.keys[next - 1].value;
        };
        let span = to.time - from.time;
        let leaving = span * self.slope(next - 1, from.leaving, Side::Leaving);
        let arriving = span * self.slope(next, to.arriving, Side::Arriving);
        let u = (time - from.time) / span;
        let (square, cube) = (u * u, u * u * u);
        (2.0 * cube - 3.0 * square + 1.0) * from.value
            + (cube - 2.0 * square + u) * leaving
            + (3.0 * square - 2.0 * cube) * to.value
            + (cube - square) * arriving
    }

    /// Where there is no neighbour on one side, that on the other decides.
    fn slope(&self, index: usize, tangent: Tangent, side: Side) -> f64 {
        let last = self.keys.len() - 1;
        let (previous, next) = (index.saturating_sub(1), (index + 1).min(last));
        let between = |from: usize, to: usize| {
            let [from, to] = [from, to].map(|key| self.keys[key]);
            (to.value - from.value) / (to.time - from.time)
        };
        match (tangent, side) {
            (Tangent::Flat, _) => 0.0,
            (Tangent::Fixed(slope), _) => slope,
            (Tangent::Smooth, _) => between(previous, next),
            (Tangent::Linear, Side::Arriving) if index > 0 => between(previous, index),
            (Tangent::Linear, Side::Leaving) if index < last => between(index, next),
            (Tangent::Linear, _) => between(previous, next),
        }
    }
}

/// Of a key.
#[derive(Debug, Clone, Copy)]
enum Side {
    Arriving,
    Leaving,
}
