//! Work beside the window: threads that answer, so that the window never waits for a simulation or a file.
//!
//! Asked with [`Worker::ask_only`], it keeps only the newest question: an edit while the last one is still simulated replaces what waits.
//! Asked with [`Worker::ask`], it does everything, in order. It wakes the window when an answer is there, and a panic in the work, which
//! would be a bug, becomes an answer too.

use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

/// Called when an answer is there.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// Where a worker puts answers; one question may have several, each better than the last.
pub struct Reply<A> {
    answers: Sender<A>,
    wake: Wake,
}

impl<A> Reply<A> {
    /// Gives an answer.
    pub fn give(&self, answer: A) {
        if self.answers.send(answer).is_ok() {
            (self.wake)();
        }
    }
}

/// A thread that answers. Dropped, it finishes what it was given and ends.
pub struct Worker<Q: Send + 'static, A: Send + 'static> {
    queue: Arc<Queue<Q>>,
    answers: Receiver<A>,
    thread: Option<JoinHandle<()>>,
}

struct Queue<Q> {
    state: Mutex<State<Q>>,
    ready: Condvar,
}

struct State<Q> {
    waiting: VecDeque<Q>,
    working: bool,
    ended: bool,
}

impl<Q: Send + 'static, A: Send + 'static> Worker<Q, A> {
    /// Starts it. `work` gives its answers by itself and may ask whether something newer waits; `broke` is the answer to a panic.
    pub fn start(
        name: &str,
        wake: Wake,
        mut work: impl FnMut(Q, &Reply<A>, &dyn Fn() -> bool) + Send + 'static,
        broke: impl Fn(String) -> A + Send + 'static,
    ) -> Worker<Q, A> {
        let state = State { waiting: VecDeque::new(), working: false, ended: false };
        let queue = Arc::new(Queue { state: Mutex::new(state), ready: Condvar::new() });
        let (sender, answers) = channel();
        let reply = Reply { answers: sender, wake };
        let own = Arc::clone(&queue);
        let run = move || {
            while let Some(question) = own.next() {
                let stale = || !own.lock().waiting.is_empty();
                if let Err(payload) = catch_unwind(AssertUnwindSafe(|| work(question, &reply, &stale))) {
                    reply.give(broke(said(payload.as_ref())));
                }
                own.lock().working = false;
                (reply.wake)();
            }
        };
        // Without a thread there are no answers; the window says that it is still working.
        let thread = std::thread::Builder::new().name(name.to_owned()).spawn(run).ok();
        Worker { queue, answers, thread }
    }

    /// Asks; what was asked before and not begun is forgotten.
    pub fn ask_only(&self, question: Q) {
        let mut state = self.queue.lock();
        state.waiting.clear();
        state.waiting.push_back(question);
        drop(state);
        self.queue.ready.notify_one();
    }

    /// Asks; it is answered after what was asked before.
    pub fn ask(&self, question: Q) {
        self.queue.lock().waiting.push_back(question);
        self.queue.ready.notify_one();
    }

    /// The answers since the last time, oldest first.
    pub fn answers(&self) -> Vec<A> {
        self.answers.try_iter().collect()
    }

    /// Whether a question waits or is worked on.
    pub fn is_busy(&self) -> bool {
        let state = self.queue.lock();
        state.working || !state.waiting.is_empty()
    }
}

impl<Q: Send + 'static, A: Send + 'static> Drop for Worker<Q, A> {
    fn drop(&mut self) {
        self.queue.lock().ended = true;
        self.queue.ready.notify_one();
        if let Some(thread) = self.thread.take() {
            drop(thread.join());
        }
    }
}

impl<Q> Queue<Q> {
    fn lock(&self) -> MutexGuard<'_, State<Q>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The next question; `None` at the end.
    fn next(&self) -> Option<Q> {
        let mut state = self.lock();
        loop {
            if let Some(question) = state.waiting.pop_front() {
                state.working = true;
                return Some(question);
            }
            if state.ended {
                return None;
            }
            state = self.ready.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

/// The words of a panic.
fn said(payload: &(dyn std::any::Any + Send)) -> String {
    let words = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
    words.or_else(|| payload.downcast_ref::<String>().cloned()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn settle<Q: Send, A: Send>(worker: &Worker<Q, A>) -> Vec<A> {
        for _ in 0..1000 {
            if !worker.is_busy() {
                break;
            }
            std::thread::sleep(Duration::from_millis(2));
        }
        worker.answers()
    }

    fn slow(question: u32, reply: &Reply<String>, stale: &dyn Fn() -> bool) {
        assert_ne!(question, 13, "thirteen");
        std::thread::sleep(Duration::from_millis(30));
        reply.give(format!("{question}{}", if stale() { " stale" } else { "" }));
    }

    #[test]
    fn only_the_newest_of_what_waits_is_answered() {
        let worker = Worker::start("test", Arc::new(|| {}), slow, |words| words);
        worker.ask_only(1);
        std::thread::sleep(Duration::from_millis(10));
        for question in 2..=5 {
            worker.ask_only(question);
        }
        assert_eq!(settle(&worker), ["1 stale", "5"]);
    }

    #[test]
    fn errands_are_all_done_in_order_and_at_the_end_too() {
        let done = Arc::new(Mutex::new(Vec::new()));
        let seen = Arc::clone(&done);
        let work = move |question: u32, _: &Reply<()>, _: &dyn Fn() -> bool| {
            std::thread::sleep(Duration::from_millis(5));
            seen.lock().expect("whole").push(question);
        };
        let worker = Worker::start("test", Arc::new(|| {}), work, |_| ());
        (0..4).for_each(|question| worker.ask(question));
        drop(worker);
        assert_eq!(*done.lock().expect("whole"), [0, 1, 2, 3]);
    }

    #[test]
    fn a_panic_is_an_answer_and_the_work_goes_on() {
        let worker = Worker::start("test", Arc::new(|| {}), slow, |words| words);
        worker.ask(13);
        worker.ask(14);
        let answers = settle(&worker);
        assert!(answers[0].contains("thirteen") && answers[1].starts_with("14"), "{answers:?}");
    }
}
