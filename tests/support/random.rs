//! Numbers for tests that try many cases, the same on every run and machine. Unit tests of the crate include this file as well.
//! Never lives here: what is done with them.

/// SplitMix64.
pub(crate) struct Random(pub u64);

#[allow(dead_code, reason = "each test uses a part")]
impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        bits ^ (bits >> 31)
    }

    pub(crate) fn below(&mut self, end: usize) -> usize {
        (self.bits() % end as u64) as usize
    }

    /// From 0 to below 1.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// From `-most` to `most`.
    pub(crate) fn within(&mut self, most: f64) -> f64 {
        ((self.bits() >> 11) as f64 / (1u64 << 52) as f64 - 1.0) * most
    }

    /// Within a cube from -1 to 1.
    pub(crate) fn point(&mut self) -> [f64; 3] {
        [0; 3].map(|_| self.within(1.0))
    }
}
