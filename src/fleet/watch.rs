//! Work on many logs that may run into somebody else's code, which may never come back.
//!
//! A thread cannot be ended from outside. Whoever hangs is left behind: its log fails, says so, and
//! another thread goes on with the rest. What hangs is told by counting: each thread counts when it
//! enters a controller and when it leaves; one that stays at the same odd count for too long hangs.
//! Giving up is one exchange of that count, which fails if the thread has left in the meantime: nobody
//! who answers at the last moment is given up, nor is the next item in place of this one. Who comes back
//! after all finds out, and stops.
//! The clock is read by who watches, never by who works, so no result can depend on it but
//! the failure of whoever hangs.

use std::cell::{Cell, RefCell};
use std::panic;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc::{self, Sender};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Result, anyhow};

use super::{attempt, staff};
use crate::cli::Common;

/// How often it is looked who hangs, at least.
const LOOK: Duration = Duration::from_millis(50);

/// The count of a thread that nobody waits for any more.
const GIVEN_UP: u64 = u64::MAX;

/// What a thread tells about itself.
#[derive(Default)]
struct Pulse {
    /// Odd while it is inside a controller.
    beats: AtomicU64,
    /// The item that it works on; it changes only while the count is even.
    item: AtomicUsize,
}

impl Pulse {
    /// Counts. Only the thread itself does, so that no other count can come between.
    fn beat(&self) {
        let before = self.beats.load(Ordering::Acquire);
        if before != GIVEN_UP {
            // It fails only where the thread is given up just now, and then that stays.
            let _ = self.beats.compare_exchange(
                before,
                before + 1,
                Ordering::AcqRel,
                Ordering::Acquire,
            );
        }
    }

    fn is_given_up(&self) -> bool {
        self.beats.load(Ordering::Acquire) == GIVEN_UP
    }
}

thread_local! {
    /// That of this thread, where it is watched.
    static PULSE: RefCell<Option<Arc<Pulse>>> = const { RefCell::new(None) };
    /// How many controllers, one within the other, this thread is inside of.
    static DEPTH: Cell<u32> = const { Cell::new(0) };
}

/// Leaves the panics of controllers to whoever catches them: they are results, told with their log.
pub fn keep_panics_quiet() {
    let tell = panic::take_hook();
    panic::set_hook(Box::new(move |panic| {
        if DEPTH.get() == 0 {
            tell(panic);
        }
    }));
}

/// While it lives, this thread is inside a controller.
pub struct Inside;

/// Tells that this thread enters a controller.
pub fn enter() -> Inside {
    if DEPTH.replace(DEPTH.get() + 1) == 0 {
        of_this_thread(Pulse::beat);
    }
    Inside
}

impl Drop for Inside {
    fn drop(&mut self) {
        let depth = DEPTH.get() - 1;
        DEPTH.set(depth);
        if depth == 0 {
            of_this_thread(Pulse::beat);
        }
    }
}

/// Whether this thread took so long that nobody waits for its result.
pub fn is_given_up() -> bool {
    of_this_thread(Pulse::is_given_up).unwrap_or(false)
}

fn of_this_thread<T>(ask: impl FnOnce(&Pulse) -> T) -> Option<T> {
    PULSE.with_borrow(|pulse| pulse.as_deref().map(ask))
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
                own.item.store(index, Ordering::Release);
                let result = attempt(item, &job.work);
                // In this item or in none: whoever is given up takes no other.
                if own.is_given_up() || tell.send((index, result)).is_err() {
                    break;
                }
            }
        });
        Worker { pulse, seen: (0, Instant::now()) }
    }

    /// Gives up the thread if it has been inside for longer than the limit; says in which item.
    fn give_up(&mut self, now: Instant, limit: Duration) -> Option<usize> {
        let beats = self.pulse.beats.load(Ordering::Acquire);
        if beats != self.seen.0 {
            self.seen = (beats, now);
        }
        let outside = beats.is_multiple_of(2) || beats == GIVEN_UP;
        if outside || now.duration_since(self.seen.1) < limit {
            return None;
        }
        let item = self.pulse.item.load(Ordering::Acquire);
        let exchanged =
            self.pulse.beats.compare_exchange(beats, GIVEN_UP, Ordering::AcqRel, Ordering::Acquire);
        exchanged.is_ok().then_some(item)
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
    // Several looks within the limit, or what has just begun would pass for what has long been seen.
    let look = LOOK.min(limit / 4);
    while results.iter().any(Option::is_none) {
        if let Ok((index, result)) = told.recv_timeout(look) {
            bar.inc(1);
            results[index] = Some(result);
        }
        let now = Instant::now();
        for worker in &mut workers {
            let Some(index) = worker.give_up(now, limit) else { continue };
            let seconds = limit.as_secs_f64();
            let error = anyhow!("the controller hung: it did not answer within {seconds} s");
            bar.inc(1);
            results[index] = Some(Err(error));
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

    /// Whoever answers at the last moment is either heard or given up, never both and never neither; and
    /// who is given up is who hung, not who comes next.
    #[test]
    fn nobody_is_lost_at_the_last_moment() {
        let limit = Duration::from_millis(4);
        let items: Vec<u64> = (0..400).collect();
        let results = each(&common(2), items, "testing", limit, |item| {
            if item % 2 == 0 {
                // Not inside: no hanging, however long it takes.
                thread::sleep(Duration::from_micros(500));
                return Ok(*item);
            }
            // From well within the limit to well beyond it.
            caught(|| thread::sleep(Duration::from_micros(item * 20)))?;
            Ok(*item)
        });
        let (mut heard, mut hung) = (0, 0);
        for (item, result) in (0_u64..).zip(&results) {
            match result {
                Ok(said) => assert_eq!(*said, item),
                Err(error) => assert!(error.to_string().contains("0.004 s"), "{error}"),
            }
            assert!(item % 2 == 1 || result.is_ok(), "{item}: {result:?}");
            heard += u64::from(result.is_ok());
            hung += u64::from(result.is_err());
        }
        assert_eq!(heard + hung, 400);
        assert!(hung > 0, "the last take 8 ms");
    }

    /// Whoever comes back after being given up is told so, and does nothing more.
    #[test]
    fn who_comes_back_too_late_stops() {
        let (went_on, stopped) = (Arc::new(AtomicU64::new(0)), Arc::new(AtomicU64::new(0)));
        let (on, off) = (Arc::clone(&went_on), Arc::clone(&stopped));
        let results = run(1, move |item| {
            if *item == 2 {
                let back = caught(|| thread::sleep(Duration::from_millis(900)));
                if back.is_err() { &off } else { &on }.fetch_add(1, Ordering::Relaxed);
                back?;
            }
            Ok(*item)
        });
        assert!(results[2].contains("did not answer within 0.3 s"), "{results:?}");
        assert_eq!((results[3].as_str(), results[5].as_str()), ("Ok(3)", "Ok(5)"));
        let waited = Instant::now();
        while stopped.load(Ordering::Relaxed) == 0 && waited.elapsed() < Duration::from_secs(30) {
            thread::sleep(Duration::from_millis(20));
        }
        assert_eq!((went_on.load(Ordering::Relaxed), stopped.load(Ordering::Relaxed)), (0, 1));
    }

    /// One controller within another is one stay.
    #[test]
    fn a_stay_within_a_stay_is_one() {
        let results = run(1, |item| {
            caught(|| {
                for _ in 0..4 {
                    caught(|| thread::sleep(Duration::from_millis(200))).expect("not too long");
                }
            })?;
            Ok(*item)
        });
        assert!(results.iter().all(|result| result.contains("did not answer")), "{results:?}");
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
