//! What came out of a renderer: rasters and vertices, not yet encoded. The table of [kinds](ImageKind) says what a pixel of each is.

use crate::scene::Size;
use std::ops::{Deref, DerefMut};
use std::sync::{Arc, Mutex, PoisonError};

/// What the pixels of a raster tell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ImageKind {
    /// The lit picture.
    Color,
}

/// How a pixel is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TexelFormat {
    /// Red, green, blue and alpha, a byte each: sRGB, straight alpha.
    Rgba8Srgb,
}

impl ImageKind {
    /// How the pixels of a raster of this kind are stored.
    pub fn texel_format(self) -> TexelFormat {
        match self {
            Self::Color => TexelFormat::Rgba8Srgb,
        }
    }

    /// Of a raster of this kind.
    pub fn bytes(self, size: Size) -> usize {
        self.texel_format().bytes() * size.pixels()
    }
}

impl TexelFormat {
    /// Of one pixel.
    pub fn bytes(self) -> usize {
        match self {
            Self::Rgba8Srgb => 4,
        }
    }
}

/// One value for each pixel of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Raster {
    /// What its pixels tell, and so how they are stored.
    pub kind: ImageKind,
    /// In pixels.
    pub size: Size,
    /// [As many](ImageKind::bytes) as the kind takes: rows from the top, without padding.
    pub bytes: Pooled<u8>,
}

/// What a plan came to: all that it asked for, and nothing else.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Outputs {
    /// One for each kind that was asked for, in the order of the kinds.
    pub images: Vec<Raster>,
    /// One for each query, in their order.
    pub vertices: Vec<SkinnedVertices>,
}

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
    /// Vertices of the mesh or of the range that was asked for.
    pub vertex_count: usize,
    /// `3 * vertex_count` numbers in model space, where asked for.
    pub positions: Option<Pooled<f32>>,
    /// `3 * vertex_count` numbers in model space, of unit length, where asked for.
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
        let many: Vec<Pooled<u8>> = (0..100).map(|_| spare.take(32)).collect();
        drop(many);
        let huge = spare.take(Spare::<u8>::MOST_BYTES + 1);
        drop(huge);
        let kept = spare.0.lock().unwrap();
        assert_eq!(kept.len(), Spare::<u8>::MOST);
        assert!(kept.iter().all(|kept| kept.len() == 32));
    }
}
