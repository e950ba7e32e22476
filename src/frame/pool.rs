//! Memory that is used again: what is asked for over and over costs more to get from the system than to fill. Never lives here: what it is for.

use std::ops::{Deref, DerefMut};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Values that nobody uses now.
#[derive(Debug)]
pub struct Pool<T> {
    free: Mutex<Free<T>>,
    /// Of more than that, the one that was not wanted for the longest time is let go.
    most: usize,
}

#[derive(Debug)]
struct Free<T> {
    values: Vec<T>,
    /// How often they were cleared: what was taken before that is not kept when it comes back.
    clearings: u64,
}

/// A value in use. On drop it goes back to its pool, if it is of one.
#[derive(Debug)]
pub struct Pooled<T> {
    /// `None` only while it is dropped.
    value: Option<T>,
    home: Option<Home<T>>,
}

#[derive(Debug)]
struct Home<T> {
    pool: Arc<Pool<T>>,
    clearings: u64,
}

/// Keeps as many as were ever in use at a time.
impl<T> Default for Pool<T> {
    fn default() -> Self {
        Self::bounded(usize::MAX)
    }
}

impl<T> Pool<T> {
    /// Keeps so many at most.
    fn bounded(most: usize) -> Self {
        let free = Free {
            values: Vec::new(),
            clearings: 0,
        };
        Self {
            free: Mutex::new(free),
            most,
        }
    }

    /// Frees all values; those in use as soon as they come back.
    pub fn clear(&self) {
        let mut free = self.lock();
        free.values.clear();
        free.clearings += 1;
    }

    fn lock(&self) -> MutexGuard<'_, Free<T>> {
        self.free.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<T: Default> Pool<T> {
    /// A value as its last user left it, or a new one.
    pub fn take(self: &Arc<Self>) -> Pooled<T> {
        self.take_or(Vec::pop, T::default)
    }

    fn take_or(
        self: &Arc<Self>,
        find: impl FnOnce(&mut Vec<T>) -> Option<T>,
        new: impl FnOnce() -> T,
    ) -> Pooled<T> {
        let mut free = self.lock();
        let found = find(&mut free.values);
        let clearings = free.clearings;
        drop(free);
        Pooled {
            value: Some(found.unwrap_or_else(new)),
            home: Some(Home {
                pool: Arc::clone(self),
                clearings,
            }),
        }
    }
}

impl<T: Clone + Default> Pool<Vec<T>> {
    /// Lists that are filled, packed or written at a time, about.
    const MOST_LISTS: usize = 16;
    /// One larger than this costs enough time to fill that its memory may be asked for.
    const MOST_BYTES: usize = 16 << 20;

    /// For lists of a few sizes that are asked for again and again.
    pub fn of_lists() -> Self {
        Self::bounded(Self::MOST_LISTS)
    }

    /// So many items of any value.
    pub fn take_list(self: &Arc<Self>, count: usize) -> Pooled<Vec<T>> {
        let new = || vec![T::default(); count];
        if size_of::<T>().saturating_mul(count) > Self::MOST_BYTES {
            return new().into();
        }
        let fitting = |free: &mut Vec<Vec<T>>| {
            let index = free.iter().position(|list| list.len() == count)?;
            Some(free.remove(index))
        };
        self.take_or(fitting, new)
    }
}

impl<T> Pooled<T> {
    const THERE: &str = "it is there until it is dropped";

    /// Takes the value out of the pool.
    pub fn into_inner(mut self) -> T {
        self.value.take().expect(Self::THERE)
    }
}

impl<T> Drop for Pooled<T> {
    fn drop(&mut self) {
        let (Some(value), Some(Home { pool, clearings })) = (self.value.take(), self.home.take())
        else {
            return;
        };
        let mut free = pool.lock();
        if free.clearings != clearings {
            return;
        }
        if free.values.len() == pool.most {
            free.values.remove(0);
        }
        free.values.push(value);
    }
}

/// Of no pool.
impl<T> From<T> for Pooled<T> {
    fn from(value: T) -> Self {
        let value = Some(value);
        Self { value, home: None }
    }
}

impl<T: Clone> Clone for Pooled<T> {
    fn clone(&self) -> Self {
        T::clone(self).into()
    }
}

impl<T: PartialEq> PartialEq for Pooled<T> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

/// The memory itself, in the byte order of the machine.
impl<T: bytemuck::NoUninit> AsRef<[u8]> for Pooled<Vec<T>> {
    fn as_ref(&self) -> &[u8] {
        bytemuck::cast_slice(self.as_slice())
    }
}

impl<T> Deref for Pooled<T> {
    type Target = T;

    fn deref(&self) -> &T {
        self.value.as_ref().expect(Self::THERE)
    }
}

impl<T> DerefMut for Pooled<T> {
    fn deref_mut(&mut self) -> &mut T {
        self.value.as_mut().expect(Self::THERE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_comes_round_and_never_piles_up() {
        let pool = Arc::new(Pool::<Vec<u8>>::of_lists());
        let mut first = pool.take_list(64);
        first[0] = 7;
        let memory = first.as_ptr();
        drop(first);
        assert_eq!(pool.take_list(64).as_ptr(), memory);
        assert_eq!(pool.take_list(64).into_inner().len(), 64);
        let many: Vec<Pooled<Vec<u8>>> = (0..100).map(|_| pool.take_list(32)).collect();
        drop(many);
        let huge = pool.take_list(Pool::<Vec<u8>>::MOST_BYTES + 1);
        drop(huge);
        let free = pool.lock();
        assert_eq!(free.values.len(), Pool::<Vec<u8>>::MOST_LISTS);
        assert!(free.values.iter().all(|list| list.len() == 32));
    }

    #[test]
    fn what_was_taken_before_a_clearing_is_not_kept() {
        let pool = Arc::new(Pool::<Vec<u8>>::default());
        let (one, other) = (pool.take(), pool.take());
        drop(one);
        assert_eq!(pool.lock().values.len(), 1);
        pool.clear();
        drop(other);
        assert!(pool.lock().values.is_empty());
        drop(pool.take());
        assert_eq!(pool.lock().values.len(), 1);
    }
}
