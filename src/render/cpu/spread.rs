//! Work on one core or on all of them. Never lives here: the work.

use rayon::prelude::*;

/// How many cores one plan is worked on by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spread {
    /// This thread's: for many plans at a time.
    OneCore,
    /// All of the thread pool that the caller runs in: for a lone one.
    AllCores,
}

impl Spread {
    /// `work` on portions of `items`, each with its number. What comes out must not depend on which is first.
    pub(super) fn portions<T: Send>(
        self,
        items: &mut [T],
        size: usize,
        work: impl Fn(usize, &mut [T]) + Send + Sync,
    ) {
        let work = |(index, portion): (usize, &mut [T])| work(index, portion);
        match self {
            Self::OneCore => items.chunks_mut(size).enumerate().for_each(work),
            Self::AllCores => items.par_chunks_mut(size).enumerate().for_each(work),
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
        let work = |(index, (one, other)): (usize, (&mut [T], &mut [U]))| work(index, one, other);
        match self {
            Self::OneCore => {
                let pairs = ones.chunks_mut(size).zip(others.chunks_mut(size));
                pairs.enumerate().for_each(work);
            }
            Self::AllCores => {
                let pairs = ones.par_chunks_mut(size).zip(others.par_chunks_mut(size));
                pairs.enumerate().for_each(work);
            }
        }
    }

    /// Into how many portions to sort so many things of which one core takes `portion` at a time.
    pub(super) fn count(self, things: usize, portion: usize) -> usize {
        match self {
            Self::OneCore => 1,
            // More than there are cores, so that none waits long for the last.
            Self::AllCores => things
                .div_ceil(portion)
                .clamp(1, 4 * rayon::current_num_threads()),
        }
    }
}
