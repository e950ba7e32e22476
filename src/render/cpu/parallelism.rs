//! Work on one core or on all of them, until it is cancelled. Never lives here: the work.

use rayon::prelude::*;

/// How many cores one plan is worked on by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cores {
    /// This thread's: for many plans at a time.
    One,
    /// All of the thread pool that the caller runs in: for a lone one.
    All,
}

/// How a plan is worked on.
#[derive(Clone, Copy)]
pub struct Parallelism<'a> {
    cores: Cores,
    is_cancelled: &'a (dyn Fn() -> bool + Sync),
}

impl<'a> Parallelism<'a> {
    /// `is_cancelled` is called every few milliseconds at the latest. Cancellation is sticky: once it returns true, it always does.
    pub fn cancellable(cores: Cores, is_cancelled: &'a (dyn Fn() -> bool + Sync)) -> Self {
        Self {
            cores,
            is_cancelled,
        }
    }

    /// Runs to completion.
    pub fn uncancelled(cores: Cores) -> Parallelism<'static> {
        Parallelism::cancellable(cores, &|| false)
    }

    pub(super) fn is_cancelled(self) -> bool {
        (self.is_cancelled)()
    }

    /// `work` on portions of `items`, each with its number. What comes out must not depend on which is first.
    pub(super) fn portions<T: Send>(
        self,
        items: &mut [T],
        size: usize,
        work: impl Fn(usize, &mut [T]) + Send + Sync,
    ) {
        let work = |(index, portion): (usize, &mut [T])| {
            if !self.is_cancelled() {
                work(index, portion);
            }
        };
        match self.cores {
            Cores::One => items.chunks_mut(size).enumerate().for_each(work),
            Cores::All => items.par_chunks_mut(size).enumerate().for_each(work),
        }
    }

    /// The same on like portions of two lists.
    pub(super) fn pairs_of_portions<T: Send, U: Send>(
        self,
        ones: &mut [T],
        others: &mut [U],
        size: usize,
        work: impl Fn(usize, &mut [T], &mut [U]) + Send + Sync,
    ) {
        let work = |(index, (one, other)): (usize, (&mut [T], &mut [U]))| {
            if !self.is_cancelled() {
                work(index, one, other);
            }
        };
        match self.cores {
            Cores::One => {
                let pairs = ones.chunks_mut(size).zip(others.chunks_mut(size));
                pairs.enumerate().for_each(work);
            }
            Cores::All => {
                let pairs = ones.par_chunks_mut(size).zip(others.par_chunks_mut(size));
                pairs.enumerate().for_each(work);
            }
        }
    }

    /// Into how many portions to sort so many things of which one core takes `portion` at a time.
    pub(super) fn count(self, things: usize, portion: usize) -> usize {
        match self.cores {
            Cores::One => 1,
            // More than there are cores, so that none waits long for the last.
            Cores::All => things
                .div_ceil(portion)
                .clamp(1, 4 * rayon::current_num_threads()),
        }
    }
}
