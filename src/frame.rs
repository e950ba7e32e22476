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

/// Bytes of a picture.
pub type Pixels = Pooled<u8>;

/// A list whose memory goes back to where it came from once nobody looks at it any more.
#[derive(Debug)]
pub struct Pooled<T> {
    items: Vec<T>,
    home: Option<Arc<Spare<T>>>,
}

/// Memory for lists to come: what is asked for again and again in a few sizes costs more to ask the system for than to fill.
#[derive(Debug)]
pub struct Spare<T>(Mutex<Vec<Vec<T>>>);

impl<T> Default for Spare<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T> Spare<T> {
    /// Lists that are filled, packed or written at a time, about; the memory of more is let go.
    const MOST: usize = 16;
    /// One larger than this costs enough time to fill that its memory may be asked for.
    const MOST_BYTES: usize = 16 << 20;

    fn give_back(&self, items: Vec<T>) {
        if size_of_val(items.as_slice()) > Self::MOST_BYTES {
            return;
        }
        let mut spare = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if spare.len() == Self::MOST {
            // The one that was not wanted for the longest time.
            spare.remove(0);
        }
        spare.push(items);
    }
}

impl<T: Clone + Default> Spare<T> {
    /// So many items of any value.
    pub fn take(self: &Arc<Self>, count: usize) -> Pooled<T> {
        let mut spare = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let fitting = spare.iter().position(|spare| spare.len() == count);
        let found = fitting.map(|fitting| spare.swap_remove(fitting));
        drop(spare);
        Pooled {
            items: found.unwrap_or_else(|| vec![T::default(); count]),
            home: Some(Arc::clone(self)),
        }
    }
}

impl<T> Pooled<T> {
    /// Takes the memory along.
    pub fn into_vec(mut self) -> Vec<T> {
        std::mem::take(&mut self.items)
    }
}

impl<T> Drop for Pooled<T> {
    fn drop(&mut self) {
        if let Some(home) = self.home.take().filter(|_| !self.items.is_empty()) {
            home.give_back(std::mem::take(&mut self.items));
        }
    }
}

impl<T> From<Vec<T>> for Pooled<T> {
    fn from(items: Vec<T>) -> Self {
        Self { items, home: None }
    }
}

impl<T: Clone> Clone for Pooled<T> {
    fn clone(&self) -> Self {
        self.items.clone().into()
    }
}

impl<T: PartialEq> PartialEq for Pooled<T> {
    fn eq(&self, other: &Self) -> bool {
        self.items == other.items
    }
}

/// The memory itself, in the byte order of the machine.
impl<T: bytemuck::NoUninit> AsRef<[u8]> for Pooled<T> {
    fn as_ref(&self) -> &[u8] {
        bytemuck::cast_slice(&self.items)
    }
}

impl<T> Deref for Pooled<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.items
    }
}

impl<T> DerefMut for Pooled<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.items
    }
}

/// Skinned vertices of one mesh, or of a range of it, in the file's own order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SkinnedVertices {
    pub vertex_count: usize,
    /// `3 * vertex_count` numbers in world space, where asked for.
    pub positions: Option<Pooled<f32>>,
    /// `3 * vertex_count` numbers, unit length, where asked for.
    pub normals: Option<Pooled<f32>>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_comes_round_and_never_piles_up() {
        let spare = Arc::new(Spare::<u8>::default());
        let mut first = spare.take(64);
        first[0] = 7;
        let place = first.as_ptr();
        drop(first);
        assert_eq!(spare.take(64).as_ptr(), place);
        assert_eq!(spare.take(64).into_vec().len(), 64);
        let many: Vec<Pixels> = (0..100).map(|_| spare.take(32)).collect();
        drop(many);
        let huge = spare.take(Spare::<u8>::MOST_BYTES + 1);
        drop(huge);
        let kept = spare.0.lock().unwrap();
        assert_eq!(kept.len(), Spare::<u8>::MOST);
        assert!(kept.iter().all(|kept| kept.len() == 32));
    }
}
