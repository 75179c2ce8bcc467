//! Work on many logs, several at a time; results come back in the order of the logs.

use std::num::NonZero;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use anyhow::{Result, anyhow};

use crate::cli::Common;
use crate::{interrupt, output};

/// Runs `work` on each log. A failure is the result of its log alone; after Ctrl-C the logs not yet
/// begun fail as interrupted, so that nothing is silently missing.
pub fn each_log<T: Send>(
    common: &Common,
    logs: &[PathBuf],
    label: &str,
    work: impl Fn(&PathBuf) -> Result<T> + Sync,
) -> Vec<Result<T>> {
    let cores = || thread::available_parallelism().map_or(1, NonZero::get);
    let threads = common.threads.map_or_else(cores, usize::from).min(logs.len()).max(1);
    let bar =
        output::bar(common, logs.len() as u64, label, "{msg} {bar:30} {pos}/{len} logs {eta}");
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
                    let result = if interrupt::pressed() {
                        Err(anyhow!("interrupted before this log was begun"))
                    } else {
                        work(log)
                    };
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
            result.unwrap_or_else(|| Err(anyhow!("the worker of this log died")))
        })
        .collect()
}
