//! Work on one core or on all of them, as long as it is wanted. Never lives here: the work.

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
pub struct Spread<'a> {
    cores: Cores,
    is_wanted: &'a (dyn Fn() -> bool + Sync),
}

impl<'a> Spread<'a> {
    /// Until `is_wanted` says no, which it then must go on saying. It is asked every few milliseconds at the latest.
    pub fn over(cores: Cores, is_wanted: &'a (dyn Fn() -> bool + Sync)) -> Self {
        Self { cores, is_wanted }
    }

    /// Whatever happens.
    pub fn to_the_end(cores: Cores) -> Spread<'static> {
        Spread::over(cores, &|| true)
    }

    pub(super) fn is_wanted(self) -> bool {
        (self.is_wanted)()
    }

    /// `work` on portions of `items`, each with its number. What comes out must not depend on which is first.
    pub(super) fn portions<T: Send>(
        self,
        items: &mut [T],
        size: usize,
        work: impl Fn(usize, &mut [T]) + Send + Sync,
    ) {
        let work = |(index, portion): (usize, &mut [T])| {
            if self.is_wanted() {
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
            if self.is_wanted() {
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
