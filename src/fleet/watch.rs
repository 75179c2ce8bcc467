//! Work on many logs that may run into somebody else's code, which may never come back.
//!
//! A thread cannot be ended from outside. Whoever hangs is left behind: its log fails, says so, and
//! another thread goes on with the rest. What hangs is told by counting: each thread counts when it
//! enters a controller and when it leaves; one that stays at the same odd count for too long hangs.
//! The clock is read by who watches, never by who works, so no result can depend on it but
//! the failure of whoever hangs.

use std::cell::{Cell, RefCell};
use std::panic;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc::{self, Sender};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Result, anyhow};

use super::{attempt, staff};
use crate::cli::Common;

/// How often it is looked who hangs.
const LOOK: Duration = Duration::from_millis(50);

/// What a thread tells about itself.
#[derive(Default)]
struct Pulse {
    /// Odd while it is inside a controller.
    beats: AtomicU64,
    /// The item that it works on.
    item: AtomicUsize,
    /// Nobody waits for it any more.
    given_up: AtomicBool,
}

thread_local! {
    /// That of this thread, where it is watched.
    static PULSE: RefCell<Option<Arc<Pulse>>> = const { RefCell::new(None) };
    /// Whether this thread is inside a controller.
    static INSIDE: Cell<bool> = const { Cell::new(false) };
}

/// Leaves the panics of controllers to whoever catches them: they are results, told with their log.
pub fn keep_panics_quiet() {
    let tell = panic::take_hook();
    panic::set_hook(Box::new(move |panic| {
        if !INSIDE.get() {
            tell(panic);
        }
    }));
}

/// While it lives, this thread is inside a controller.
pub struct Inside;

/// Tells that this thread enters a controller.
pub fn enter() -> Inside {
    INSIDE.set(true);
    beat();
    Inside
}

impl Drop for Inside {
    fn drop(&mut self) {
        INSIDE.set(false);
        beat();
    }
}

fn beat() {
    PULSE.with_borrow(|pulse| {
        if let Some(pulse) = pulse {
            pulse.beats.fetch_add(1, Ordering::Relaxed);
        }
    });
}

/// One of the threads, as its watcher sees it.
struct Worker {
    pulse: Arc<Pulse>,
    /// The count seen last, and since when.
    seen: (u64, Instant),
}

impl Worker {
    fn start<I, T>(job: &Arc<Job<I, T>>, tell: &Sender<(usize, Result<T>)>) -> Worker
    where
        I: Send + Sync + 'static,
        T: Send + 'static,
    {
        let pulse = Arc::new(Pulse::default());
        let (own, job, tell) = (Arc::clone(&pulse), Arc::clone(job), tell.clone());
        thread::spawn(move || {
            PULSE.set(Some(Arc::clone(&own)));
            loop {
                let index = job.next.fetch_add(1, Ordering::Relaxed);
                let Some(item) = job.items.get(index) else { break };
                own.item.store(index, Ordering::Relaxed);
                let result = attempt(item, &job.work);
                if own.given_up.load(Ordering::Relaxed) || tell.send((index, result)).is_err() {
                    break;
                }
            }
        });
        Worker { pulse, seen: (0, Instant::now()) }
    }

    /// The item in which it has hung for longer than the limit.
    fn hangs(&mut self, now: Instant, limit: Duration) -> Option<usize> {
        let beats = self.pulse.beats.load(Ordering::Relaxed);
        if beats != self.seen.0 {
            self.seen = (beats, now);
        }
        let hung = beats % 2 == 1 && now.duration_since(self.seen.1) >= limit;
        hung.then(|| {
            self.pulse.given_up.store(true, Ordering::Relaxed);
            self.pulse.item.load(Ordering::Relaxed)
        })
    }
}

/// What all threads share.
struct Job<I, T> {
    items: Vec<I>,
    next: AtomicUsize,
    work: Box<Work<I, T>>,
}

/// What is done to each item.
type Work<I, T> = dyn Fn(&I) -> Result<T> + Send + Sync;

/// As [`super::each`], and a controller that does not answer within `limit` fails its item alone.
pub fn each<I, T>(
    common: &Common,
    items: Vec<I>,
    label: &str,
    limit: Duration,
    work: impl Fn(&I) -> Result<T> + Send + Sync + 'static,
) -> Vec<Result<T>>
where
    I: Send + Sync + 'static,
    T: Send + 'static,
{
    let count = items.len();
    let (threads, bar) = staff(common, count, label);
    let job = Arc::new(Job { items, next: AtomicUsize::new(0), work: Box::new(work) });
    let (tell, told) = mpsc::channel();
    let mut workers: Vec<Worker> = (0..threads).map(|_| Worker::start(&job, &tell)).collect();
    let mut results: Vec<Option<Result<T>>> = (0..count).map(|_| None).collect();
    while results.iter().any(Option::is_none) {
        if let Ok((index, result)) = told.recv_timeout(LOOK) {
            bar.inc(1);
            results[index].get_or_insert(result);
        }
        let now = Instant::now();
        for worker in &mut workers {
            let Some(index) = worker.hangs(now, limit) else { continue };
            let seconds = limit.as_secs_f64();
            let error = anyhow!("the controller hung: it did not answer within {seconds} s");
            bar.inc(1);
            results[index].get_or_insert(Err(error));
            *worker = Worker::start(&job, &tell);
        }
    }
    bar.finish_and_clear();
    results.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::caught;
    use crate::cli::Format;

    fn common(threads: u16) -> Common {
        Common {
            format: Format::Human,
            quiet: true,
            verbose: false,
            force: false,
            threads: Some(threads),
        }
    }

    fn run(
        threads: u16,
        work: impl Fn(&u32) -> Result<u32> + Send + Sync + 'static,
    ) -> Vec<String> {
        let items = (0..6).collect();
        let results = each(&common(threads), items, "testing", Duration::from_millis(300), work);
        results.into_iter().map(|result| format!("{result:?}")).collect()
    }

    /// Hanging, panicking and failing are each the result of one item; the others are worked on, by
    /// however many threads, and results stand in the order of the items.
    #[test]
    fn who_hangs_is_left_behind() {
        for threads in [1, 2] {
            let results = run(threads, |item| match item {
                1 | 3 => caught(|| {
                    loop {
                        thread::park();
                    }
                }),
                2 => caught(|| panic!("on purpose")),
                4 => Err(anyhow!("no")),
                other => caught(|| other * 10),
            });
            assert_eq!((results[0].as_str(), results[5].as_str()), ("Ok(0)", "Ok(50)"));
            for hung in [1, 3] {
                assert!(results[hung].contains("did not answer within 0.3 s"), "{results:?}");
            }
            assert!(results[2].contains("panicked: on purpose"), "{results:?}");
            assert!(results[4].contains("no"), "{results:?}");
        }
    }

    /// Slow work is not hanging: neither many answers that take their time together, nor what is done
    /// between them.
    #[test]
    fn slow_is_not_hung() {
        let results = run(2, |item| {
            for _ in 0..5 {
                caught(|| thread::sleep(Duration::from_millis(80)))?;
            }
            if *item == 0 {
                thread::sleep(Duration::from_millis(700));
            }
            Ok(*item)
        });
        assert_eq!(results, ["Ok(0)", "Ok(1)", "Ok(2)", "Ok(3)", "Ok(4)", "Ok(5)"]);
    }
}
