//! Any text at all is either a scenario or an error; a scenario survives being written and read.
#![no_main]

use libfuzzer_sys::fuzz_target;
use schemas::Scenario;

fuzz_target!(|text: &str| {
    if let Ok(scenario) = Scenario::from_toml(text) {
        let again = Scenario::from_toml(&scenario.to_toml()).expect("what was written is read");
        assert_eq!(scenario, again);
    }
});
