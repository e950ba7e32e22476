//! The threads that pack and write out what was drawn, and draw it where there is no GPU. Never lives here: what they do.

use std::collections::VecDeque;
use std::num::NonZeroUsize;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::available_parallelism;

/// Threads for drawing on the CPU, for encoding and for writing replies.
pub(super) struct ThreadPool {
    threads: rayon::ThreadPool,
    queue: Arc<Queue>,
}

/// Work that waits, the oldest first. Threads of rayon's would take what they were given themselves before what others were, so that
/// whoever has much to do, one thing after another, would keep everybody else waiting.
#[derive(Default)]
struct Queue(Mutex<VecDeque<Work>>);

type Work = Box<dyn FnOnce() + Send>;

impl Queue {
    fn push(&self, work: Work) {
        let mut queue = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        queue.push_back(work);
    }

    fn run_oldest(&self) {
        let mut queue = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let oldest = queue.pop_front();
        drop(queue);
        if let Some(work) = oldest {
            work();
        }
    }
}

impl ThreadPool {
    /// How many threads it has where so many are asked for: otherwise one for each core.
    pub(super) fn threads(asked: Option<NonZeroUsize>) -> usize {
        let cores = || available_parallelism().map_or(1, NonZeroUsize::get);
        asked.map_or_else(cores, NonZeroUsize::get)
    }

    /// # Errors
    /// Where the system gives no threads.
    pub(super) fn new(threads: Option<NonZeroUsize>) -> Result<Self, rayon::ThreadPoolBuildError> {
        let threads = rayon::ThreadPoolBuilder::new()
            .num_threads(Self::threads(threads))
            .thread_name(|index| format!("work-{index}"))
            // Whoever waits for the work is answered as it is dropped; the other threads go on.
            .panic_handler(|_| {})
            .build()?;
        Ok(Self {
            threads,
            queue: Arc::default(),
        })
    }

    pub(super) fn thread_count(&self) -> usize {
        self.threads.current_num_threads()
    }

    /// Runs `work` once all that was given before has begun. How much may wait is up to the caller, who admits requests.
    pub(super) fn spawn(&self, work: impl FnOnce() + Send + 'static) {
        self.queue.push(Box::new(work));
        let queue = Arc::clone(&self.queue);
        self.threads.spawn(move || queue.run_oldest());
    }

    /// Lets the oldest work that waits go first, from within other work that takes long.
    pub(super) fn give_way(&self) {
        self.queue.run_oldest();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    #[test]
    fn what_came_first_is_begun_first_whoever_it_came_from() {
        let pool = Arc::new(ThreadPool::new(NonZeroUsize::new(1)).unwrap());
        let (sender, begun) = channel();
        let (go, wait) = channel::<()>();
        let inner = Arc::clone(&pool);
        let told = sender.clone();
        pool.spawn(move || {
            wait.recv().unwrap();
            // From a thread of the pool, after two from without.
            inner.spawn(move || told.send("own").unwrap());
        });
        for name in ["first", "second"] {
            let sender = sender.clone();
            pool.spawn(move || sender.send(name).unwrap());
        }
        go.send(()).unwrap();
        let order: Vec<&str> = begun.iter().take(3).collect();
        assert_eq!(order, ["first", "second", "own"]);
    }
}
