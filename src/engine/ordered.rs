//! Many items of work at a time, a bounded number of them in hand, their outputs delivered one by one in order.
//! Never lives here: what an item is, and where its output goes.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What is done with each item.
pub trait Work: Send + Sync + Sized + 'static {
    /// What work is started on.
    type Item: Send;
    /// What becomes of an item, kept until those before it are delivered.
    type Output: Send;
    /// Why no more is done; the first one is what [`Work::finish`] is given.
    type Error;

    /// Starts work on an item. `done` runs exactly once, on any thread.
    ///
    /// # Errors
    /// Where nothing is to be started any more; `done` is dropped then.
    fn start(
        &self,
        index: usize,
        item: Self::Item,
        done: impl FnOnce(Result<Self::Output, Self::Error>) + Send + 'static,
    ) -> Result<(), Self::Error>;

    /// Takes an output; one at a time, in the order of the items. As long as its `permit` is kept, it counts as being in hand.
    ///
    /// # Errors
    /// Where no more is to be delivered.
    fn deliver(
        &self,
        index: usize,
        output: Self::Output,
        permit: WindowPermit<Self>,
    ) -> Result<(), Self::Error>;

    /// Runs exactly once: all items are delivered, or the first error ended it. Items that are in hand then are finished for nothing.
    fn finish(&self, outcome: Result<(), Self::Error>);

    /// Runs `resume` on another thread some time soon.
    fn spawn(&self, resume: impl FnOnce() + Send + 'static);
}

/// Items on their way through [`Work`].
pub struct Ordered<W: Work> {
    work: W,
    window: usize,
    state: Mutex<State<W>>,
}

struct State<W: Work> {
    /// Those that are not started yet.
    items: std::vec::IntoIter<W::Item>,
    started: usize,
    /// Started, and their permits not given back yet.
    in_hand: usize,
    /// Outputs whose turn has not come.
    outputs: BTreeMap<usize, W::Output>,
    delivered: usize,
    /// Some thread delivers.
    is_delivering: bool,
    is_finished: bool,
}

/// Counts an item among those in hand until it is dropped.
pub struct WindowPermit<W: Work>(Arc<Ordered<W>>);

impl<W: Work> Drop for WindowPermit<W> {
    fn drop(&mut self) {
        let mut state = self.0.lock();
        state.in_hand -= 1;
        // Whoever delivers advances afterwards.
        let resumes = !state.is_delivering && !state.is_finished;
        drop(state);
        if resumes {
            let ordered = Arc::clone(&self.0);
            self.0.work.spawn(move || ordered.advance());
        }
    }
}

impl<W: Work> Ordered<W> {
    /// Starts on `items`, at most `window` of them in hand at a time.
    pub fn run(work: W, items: Vec<W::Item>, window: usize) {
        if items.is_empty() {
            return work.finish(Ok(()));
        }
        let state = State {
            items: items.into_iter(),
            started: 0,
            in_hand: 0,
            outputs: BTreeMap::new(),
            delivered: 0,
            is_delivering: false,
            is_finished: false,
        };
        let ordered = Arc::new(Self {
            work,
            window: window.max(1),
            state: Mutex::new(state),
        });
        ordered.advance();
    }

    /// Starts as many items as may be in hand.
    fn advance(self: &Arc<Self>) {
        loop {
            let mut state = self.lock();
            if state.is_finished || state.in_hand == self.window {
                return;
            }
            let Some(item) = state.items.next() else {
                return;
            };
            let index = state.started;
            state.started += 1;
            state.in_hand += 1;
            drop(state);
            let ordered = Arc::clone(self);
            let done = move |output| ordered.done(index, output);
            if let Err(error) = self.work.start(index, item, done) {
                return self.finish(Err(error));
            }
        }
    }

    fn done(self: &Arc<Self>, index: usize, output: Result<W::Output, W::Error>) {
        match output {
            Ok(output) => {
                self.lock().outputs.insert(index, output);
                self.deliver();
                self.advance();
            }
            Err(error) => self.finish(Err(error)),
        }
    }

    /// Delivers outputs as far as their turn has come. One thread at a time does; what others finish meanwhile it delivers as well.
    fn deliver(self: &Arc<Self>) {
        let mut state = self.lock();
        if state.is_delivering {
            return;
        }
        state.is_delivering = true;
        while !state.is_finished {
            let index = state.delivered;
            let Some(output) = state.outputs.remove(&index) else {
                break;
            };
            state.delivered += 1;
            let is_last = state.delivered == state.started && state.items.len() == 0;
            drop(state);
            let delivered = self
                .work
                .deliver(index, output, WindowPermit(Arc::clone(self)));
            if delivered.is_err() || is_last {
                self.finish(delivered);
            }
            state = self.lock();
        }
        state.is_delivering = false;
    }

    fn finish(&self, outcome: Result<(), W::Error>) {
        let mut state = self.lock();
        if std::mem::replace(&mut state.is_finished, true) {
            return;
        }
        let left = (
            std::mem::take(&mut state.items),
            std::mem::take(&mut state.outputs),
        );
        drop(state);
        drop(left);
        self.work.finish(outcome);
    }

    fn lock(&self) -> MutexGuard<'_, State<W>> {
        // Nothing that holds this lock can leave the state half-written.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::{Receiver, Sender, channel};

    type Done = Box<dyn FnOnce(Result<usize, &'static str>) + Send>;

    enum Event {
        Started(usize, Done),
        Delivered(usize, usize, WindowPermit<Recorder>),
        Finished(Result<(), &'static str>),
    }

    /// Leaves everything to the test.
    struct Recorder(Sender<Event>);

    impl Recorder {
        fn tell(&self, event: Event) {
            // Where a test has failed, nobody looks any more.
            let _ = self.0.send(event);
        }
    }

    impl Work for Recorder {
        type Item = usize;
        type Output = usize;
        type Error = &'static str;

        fn start(
            &self,
            index: usize,
            item: usize,
            done: impl FnOnce(Result<usize, &'static str>) + Send + 'static,
        ) -> Result<(), &'static str> {
            assert_eq!(item, 10 * index);
            self.tell(Event::Started(item, Box::new(done)));
            Ok(())
        }

        fn deliver(
            &self,
            index: usize,
            output: usize,
            permit: WindowPermit<Self>,
        ) -> Result<(), &'static str> {
            self.tell(Event::Delivered(index, output, permit));
            if output == 13 { Err("unlucky") } else { Ok(()) }
        }

        fn finish(&self, outcome: Result<(), &'static str>) {
            self.tell(Event::Finished(outcome));
        }

        fn spawn(&self, resume: impl FnOnce() + Send + 'static) {
            resume();
        }
    }

    struct Run {
        events: Receiver<Event>,
        started: BTreeMap<usize, Done>,
        delivered: Vec<usize>,
        permits: Vec<WindowPermit<Recorder>>,
        finished: Vec<Result<(), &'static str>>,
    }

    impl Run {
        fn of(count: usize, window: usize) -> Self {
            let (sender, events) = channel();
            let items = (0..count).map(|index| 10 * index).collect();
            Ordered::run(Recorder(sender), items, window);
            let mut run = Self {
                events,
                started: BTreeMap::new(),
                delivered: Vec::new(),
                permits: Vec::new(),
                finished: Vec::new(),
            };
            run.look();
            run
        }

        fn look(&mut self) {
            for event in self.events.try_iter() {
                match event {
                    Event::Started(item, done) => drop(self.started.insert(item, done)),
                    Event::Delivered(index, output, permit) => {
                        assert_eq!(index, self.delivered.len());
                        self.delivered.push(output);
                        self.permits.push(permit);
                    }
                    Event::Finished(outcome) => self.finished.push(outcome),
                }
            }
        }

        fn end(&mut self, item: usize, output: Result<usize, &'static str>) {
            self.started.remove(&item).expect("it is in hand")(output);
            self.look();
        }

        fn in_hand(&self) -> Vec<usize> {
            self.started.keys().copied().collect()
        }
    }

    #[test]
    fn outputs_come_in_order_whichever_is_done_first() {
        let mut run = Run::of(4, 4);
        for item in [20, 0, 30] {
            run.end(item, Ok(item + 1));
        }
        assert_eq!(run.delivered, [1]);
        assert!(run.finished.is_empty());
        run.end(10, Ok(11));
        assert_eq!(run.delivered, [1, 11, 21, 31]);
        assert_eq!(run.finished, [Ok(())]);
    }

    #[test]
    fn no_more_are_started_than_the_window_before_a_permit_is_given_back() {
        let mut run = Run::of(5, 2);
        assert_eq!(run.in_hand(), [0, 10]);
        run.end(10, Ok(11));
        run.end(0, Ok(1));
        assert_eq!(run.delivered, [1, 11]);
        assert!(run.in_hand().is_empty(), "both permits are still held");
        run.permits.pop();
        run.look();
        assert_eq!(run.in_hand(), [20]);
        run.permits.clear();
        run.look();
        assert_eq!(run.in_hand(), [20, 30]);
    }

    #[test]
    fn the_first_error_ends_it_once() {
        let mut run = Run::of(5, 3);
        run.end(10, Err("lost"));
        assert_eq!(run.finished, [Err("lost")]);
        run.end(0, Ok(1));
        run.end(20, Err("late"));
        assert!(run.delivered.is_empty() && run.in_hand().is_empty());
        assert_eq!(run.finished.len(), 1);

        let mut run = Run::of(3, 3);
        run.end(0, Ok(13));
        run.end(10, Ok(11));
        assert_eq!(
            (&run.delivered[..], &run.finished[..]),
            (&[13][..], &[Err("unlucky")][..])
        );
    }

    #[test]
    fn nothing_is_done_at_once() {
        assert_eq!(Run::of(0, 1).finished, [Ok(())]);
    }
}
