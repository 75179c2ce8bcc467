//! Work on many logs, several at a time; results come back in the order of the logs.

pub mod watch;

use std::num::NonZero;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use anyhow::{Result, anyhow};
use indicatif::ProgressBar;

use crate::cli::Common;
use crate::interrupt::{self, Interrupted};
use crate::output;

/// How many threads work, and a bar for what they have done.
fn staff(common: &Common, count: usize, label: &str) -> (usize, ProgressBar) {
    let cores = || thread::available_parallelism().map_or(1, NonZero::get);
    let threads = common.threads.map_or_else(cores, usize::from).min(count).max(1);
    (threads, output::bar(common, count as u64, label, "{msg} {bar:30} {pos}/{len} logs {eta}"))
}

/// Works on one item. A panic is its result.
fn attempt<I, T>(item: &I, work: impl Fn(&I) -> Result<T>) -> Result<T> {
    if interrupt::pressed() {
        return Err(Interrupted::NotBegun.into());
    }
    panic::catch_unwind(AssertUnwindSafe(|| work(item)))
        .unwrap_or_else(|_| Err(anyhow!("a fault of the program; please report it")))
}

/// Runs `work` on each log. A failure, even a panic, is the result of its log alone; after Ctrl-C the logs not yet
/// begun fail as interrupted, so that nothing is silently missing.
pub fn each<I: Sync, T: Send>(
    common: &Common,
    logs: &[I],
    label: &str,
    work: impl Fn(&I) -> Result<T> + Sync,
) -> Vec<Result<T>> {
    let (threads, bar) = staff(common, logs.len(), label);
    let next = AtomicUsize::new(0);
    let results: Vec<Mutex<Option<Result<T>>>> = logs.iter().map(|_| Mutex::new(None)).collect();
    thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let (Some(log), Some(slot)) = (logs.get(index), results.get(index)) else {
                        break;
                    };
                    let result = attempt(log, &work);
                    if let Ok(mut slot) = slot.lock() {
                        *slot = Some(result);
                    }
                    bar.inc(1);
                }
            });
        }
    });
    bar.finish_and_clear();
    results
        .into_iter()
        .map(|slot| {
            let result = slot.into_inner().ok().flatten();
            result.unwrap_or_else(|| Err(anyhow!("not worked on")))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::Format;

    #[test]
    fn a_panic_is_the_failure_of_its_own_item() {
        let common = Common {
            format: Format::Human,
            quiet: true,
            verbose: false,
            force: false,
            threads: Some(2),
        };
        let results = each(&common, &[1, 2, 3], "testing", |item| {
            assert_ne!(*item, 2, "on purpose");
            Ok(item * 10)
        });
        let shown: Vec<String> = results.iter().map(|result| format!("{result:?}")).collect();
        assert_eq!((shown[0].as_str(), shown[2].as_str()), ("Ok(10)", "Ok(30)"));
        assert!(results[1].is_err());
    }
}
