//! Memory that is worked in and kept: in a steady stream of like pictures none is asked for. Never lives here: what is in it.

use std::ops::{Deref, DerefMut};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Values that nobody works in: as many as were ever used at a time.
pub(super) struct ScratchPool<T>(Mutex<Kept<T>>);

struct Kept<T> {
    free: Vec<Box<T>>,
    /// How often they were cleared: what was taken before that is not kept when it comes back.
    clearings: u64,
}

impl<T> Default for ScratchPool<T> {
    fn default() -> Self {
        Self(Mutex::new(Kept {
            free: Vec::new(),
            clearings: 0,
        }))
    }
}

impl<T> ScratchPool<T> {
    /// Frees all of them; those in use as soon as they come back.
    pub(super) fn clear(&self) {
        let mut kept = self.kept();
        kept.free.clear();
        kept.clearings += 1;
    }

    fn kept(&self) -> MutexGuard<'_, Kept<T>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<T: Default> ScratchPool<T> {
    pub(super) fn take(self: &Arc<Self>) -> Scratch<T> {
        let mut kept = self.kept();
        let (value, clearings) = (kept.free.pop(), kept.clearings);
        drop(kept);
        Scratch {
            value: Some(value.unwrap_or_default()),
            pool: Arc::clone(self),
            clearings,
        }
    }
}

/// A value in use, given back on drop.
pub(super) struct Scratch<T> {
    value: Option<Box<T>>,
    pool: Arc<ScratchPool<T>>,
    clearings: u64,
}

impl<T> Deref for Scratch<T> {
    type Target = T;

    fn deref(&self) -> &T {
        self.value.as_deref().expect("there until it is dropped")
    }
}

impl<T> DerefMut for Scratch<T> {
    fn deref_mut(&mut self) -> &mut T {
        self.value
            .as_deref_mut()
            .expect("there until it is dropped")
    }
}

impl<T> Drop for Scratch<T> {
    fn drop(&mut self) {
        let mut kept = self.pool.kept();
        if kept.clearings == self.clearings {
            kept.free.extend(self.value.take());
        }
    }
}
