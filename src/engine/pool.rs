//! The threads that pack and write out what was drawn, and draw it where there is no GPU. Never lives here: what they do.

use std::num::NonZeroUsize;
use std::thread::available_parallelism;

/// Threads for drawing on the CPU, for encoding and for writing replies.
pub struct Pool {
    threads: rayon::ThreadPool,
}

impl Pool {
    /// How many threads it has where so many are asked for: otherwise one for each core.
    pub fn threads(asked: Option<NonZeroUsize>) -> usize {
        let cores = || available_parallelism().map_or(1, NonZeroUsize::get);
        asked.map_or_else(cores, NonZeroUsize::get)
    }

    /// # Errors
    /// Where the system gives no threads.
    pub fn new(threads: Option<NonZeroUsize>) -> Result<Self, rayon::ThreadPoolBuildError> {
        let threads = rayon::ThreadPoolBuilder::new()
            .num_threads(Self::threads(threads))
            .thread_name(|index| format!("work-{index}"))
            // Whoever waits for the work is answered as it is dropped; the other threads go on.
            .panic_handler(|_| {})
            .build()?;
        Ok(Self { threads })
    }

    pub fn thread_count(&self) -> usize {
        self.threads.current_num_threads()
    }

    /// Runs `work` some time soon. How much may wait is up to the caller, who admits requests.
    pub fn spawn(&self, work: impl FnOnce() + Send + 'static) {
        self.threads.spawn_fifo(work);
    }
}
