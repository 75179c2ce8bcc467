//! Any bytes at all are either a log or an error, never a panic, and never more memory than the
//! bytes themselves could justify.
#![no_main]

use libfuzzer_sys::fuzz_target;
use schemas::log::LogReader;

fuzz_target!(|bytes: &[u8]| {
    let Ok(mut log) = LogReader::new(bytes) else { return };
    while let Ok(Some(_)) = log.next_event() {}
});
