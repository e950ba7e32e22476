//! The threads that encode. Never lives here: what they do.

/// Threads for encoding and for writing replies, as many as the machine has cores.
pub struct Pool {
    threads: rayon::ThreadPool,
}

impl Pool {
    /// # Errors
    /// Where the system gives no threads.
    pub fn new() -> Result<Self, rayon::ThreadPoolBuildError> {
        let threads = rayon::ThreadPoolBuilder::new()
            .thread_name(|index| format!("encode-{index}"))
            // Whoever waits for the work is answered as it is dropped; the other threads go on.
            .panic_handler(|_| {})
            .build()?;
        Ok(Self { threads })
    }

    /// Runs `work` some time soon. How much may wait is up to the caller, who admits requests.
    pub fn spawn(&self, work: impl FnOnce() + Send + 'static) {
        self.threads.spawn_fifo(work);
    }
}
