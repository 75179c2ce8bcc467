//! What can be wrong with a simulation before it starts; once it runs it cannot fail.

use schemas::ScenarioError;

/// Why there is no simulation.
#[derive(Debug, thiserror::Error)]
pub enum SimulatorError {
    /// No scenario of that name.
    #[error("unknown scenario {name:?}; did you mean {nearest:?}? known: {known}")]
    UnknownScenario {
        /// What was asked for.
        name: String,
        /// The known name that looks most like it.
        nearest: String,
        /// All known names.
        known: String,
    },
    /// A `random:` scenario whose parts do not read.
    #[error(
        "bad scenario name {name:?}: expected random:N or random:rect|slant|disc:goal|joystick|hesitant|flowing|explorer|tracker:N with a whole number N, got {part:?}"
    )]
    RandomName {
        /// What was asked for.
        name: String,
        /// The part that does not fit.
        part: String,
    },
    /// A scenario whose numbers make no sense.
    #[error("scenario {name:?}: {why}")]
    Scenario {
        /// Its name.
        name: String,
        /// What is wrong.
        why: ScenarioError,
    },
    /// A driver that the scenario does not describe.
    #[error("scenario {scenario:?} cannot be driven by {driver:?}: it has no {missing}")]
    Driver {
        /// The scenario's name.
        scenario: String,
        /// Who was to drive.
        driver: &'static str,
        /// The table that the scenario lacks.
        missing: &'static str,
    },
    /// A control period too short to simulate.
    #[error("the control period must be at least {least_ns} ns, got {got_ns} ns")]
    ControlPeriod {
        /// The shortest one.
        least_ns: u64,
        /// What was asked for.
        got_ns: u64,
    },
}
