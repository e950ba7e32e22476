//! What came out of a renderer: pixels and vertices, not yet encoded.

use crate::scene::Size;
use std::ops::{Deref, DerefMut};
use std::sync::{Arc, Mutex, PoisonError};

/// A picture: RGBA8, sRGB, straight alpha, rows from the top, no padding.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    pub size: Size,
    /// `4 * width * height` bytes.
    pub pixels: Pixels,
}

/// Bytes of a picture, whose memory goes back to where it came from once nobody looks at them any more.
#[derive(Debug, Default)]
pub struct Pixels {
    bytes: Vec<u8>,
    home: Option<Arc<SparePixels>>,
}

/// Memory for pictures to come.
#[derive(Debug, Default)]
pub struct SparePixels(Mutex<Vec<Vec<u8>>>);

impl SparePixels {
    /// Pictures that are drawn or encoded at a time, about; the memory of more is let go.
    const MOST: usize = 16;
    /// A picture larger than this costs enough time to ask the system for its memory.
    const MOST_BYTES: usize = 16 << 20;

    /// So many bytes of any value.
    pub fn take(self: &Arc<Self>, bytes: usize) -> Pixels {
        let mut spare = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let fitting = spare.iter().position(|spare| spare.len() == bytes);
        let found = fitting.map(|fitting| spare.swap_remove(fitting));
        drop(spare);
        Pixels {
            bytes: found.unwrap_or_else(|| vec![0; bytes]),
            home: Some(Arc::clone(self)),
        }
    }

    fn give_back(&self, bytes: Vec<u8>) {
        let mut spare = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if bytes.len() <= Self::MOST_BYTES {
            if spare.len() == Self::MOST {
                // The one that was not wanted for the longest time.
                spare.remove(0);
            }
            spare.push(bytes);
        }
    }
}

impl Pixels {
    /// Takes the memory along.
    pub fn into_vec(mut self) -> Vec<u8> {
        std::mem::take(&mut self.bytes)
    }
}

impl Drop for Pixels {
    fn drop(&mut self) {
        if let Some(home) = self.home.take().filter(|_| !self.bytes.is_empty()) {
            home.give_back(std::mem::take(&mut self.bytes));
        }
    }
}

impl From<Vec<u8>> for Pixels {
    fn from(bytes: Vec<u8>) -> Self {
        Self { bytes, home: None }
    }
}

impl Clone for Pixels {
    fn clone(&self) -> Self {
        self.bytes.clone().into()
    }
}

impl PartialEq for Pixels {
    fn eq(&self, other: &Self) -> bool {
        self.bytes == other.bytes
    }
}

impl Deref for Pixels {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.bytes
    }
}

impl DerefMut for Pixels {
    fn deref_mut(&mut self) -> &mut [u8] {
        &mut self.bytes
    }
}

/// Skinned vertices of one mesh, or of a range of it, in the file's own order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SkinnedVertices {
    pub vertex_count: usize,
    /// `3 * vertex_count` numbers in world space, where asked for.
    pub positions: Option<Vec<f32>>,
    /// `3 * vertex_count` numbers, unit length, where asked for.
    pub normals: Option<Vec<f32>>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_comes_round_and_never_piles_up() {
        let spare = Arc::new(SparePixels::default());
        let mut first = spare.take(64);
        first[0] = 7;
        let place = first.as_ptr();
        drop(first);
        assert_eq!(spare.take(64).as_ptr(), place);
        assert_eq!(spare.take(64).into_vec().len(), 64);
        let many: Vec<Pixels> = (0..100).map(|_| spare.take(32)).collect();
        drop(many);
        let huge = spare.take(SparePixels::MOST_BYTES + 1);
        drop(huge);
        let kept = spare.0.lock().unwrap();
        assert_eq!(kept.len(), SparePixels::MOST);
        assert!(kept.iter().all(|kept| kept.len() == 32));
    }
}
