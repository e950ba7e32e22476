//! Rounds taken in turn, so that whatever else the machine does meets all sides. Never lives here: what a round does.

use std::time::Duration;

/// How much of everything to measure.
#[derive(Clone, Copy)]
pub struct Effort {
    pub rounds: usize,
    /// How long a round of either side takes, about.
    pub round: Duration,
}

/// Does so many of something and gives the seconds that each took.
pub type Side<'a> = Box<dyn FnMut(usize) -> f64 + 'a>;

/// Seconds by round and side.
pub struct Rounds(Vec<Vec<f64>>);

/// Of the rounds.
#[derive(Clone, Copy)]
pub struct Spread {
    pub low: f64,
    pub median: f64,
    pub high: f64,
}

impl Effort {
    /// A first go of `least` finds out how many of each make a round.
    pub fn in_turn(self, least: usize, mut sides: Vec<Side<'_>>) -> Rounds {
        let counts: Vec<usize> = sides
            .iter_mut()
            .map(|side| {
                let once = side(least);
                let fitting = (self.round.as_secs_f64() / once / least as f64) as usize;
                least * fitting.clamp(1, 1_000_000)
            })
            .collect();
        let mut round = || {
            let each = sides.iter_mut().zip(&counts);
            each.map(|(side, &count)| side(count)).collect()
        };
        Rounds((0..self.rounds).map(|_| round()).collect())
    }
}

impl Rounds {
    /// Seconds of one thing.
    pub fn median(&self, side: usize) -> f64 {
        self.spread(|round| round[side]).median
    }

    /// Seconds of one thing of the first two sides, in the best round of each.
    pub fn best(&self) -> [f64; 2] {
        [0, 1].map(|side| self.spread(|round| round[side]).low)
    }

    /// How many times as long as the second side's one thing of the first side takes.
    pub fn ratio(&self, one: usize, other: usize) -> Spread {
        self.spread(|round| round[one] / round[other])
    }

    /// Of what `of` makes of the seconds of one round.
    pub fn spread(&self, of: impl Fn(&[f64]) -> f64) -> Spread {
        let mut values: Vec<f64> = self.0.iter().map(|round| of(round)).collect();
        values.sort_by(f64::total_cmp);
        Spread {
            low: values[0],
            median: values[values.len() / 2],
            high: values[values.len() - 1],
        }
    }
}
