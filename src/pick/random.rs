//! Numbers for tests that try many cases, the same on every run. Never lives here: anything that a user meets.

use glam::DVec3;

/// A linear congruential generator with the constants of Knuth's MMIX.
pub(super) struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// 0..1, without 1.
    pub fn number(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Within a cube from -1 to 1.
    pub fn point(&mut self) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|_| 2.0 * self.number() - 1.0))
    }
}
