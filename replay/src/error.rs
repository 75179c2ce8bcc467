//! Why a replay could not be done.

use std::sync::Arc;

use schemas::log::LogError;

/// Why a replay could not be done.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The log cannot be read.
    #[error(transparent)]
    Log(Arc<LogError>),
    /// The controller's parameters do not fit.
    #[error(transparent)]
    Spec(#[from] controller::SpecError),
    /// The simulation cannot be built from the log's scenario.
    #[error(transparent)]
    Simulation(#[from] simulator::SimulatorError),
    /// Open loop steps at the recorded times, so the period must be the recorded one.
    #[error(
        "controller steps every {wanted_s} s, but the log was recorded with steps every \
         {recorded_s} s; set control_period_s={recorded_s} or replay with --mode closed"
    )]
    ControlPeriod {
        /// The log's control period, seconds.
        recorded_s: f64,
        /// The controller's, seconds.
        wanted_s: f64,
    },
    /// The log's metadata names a sensor suite that cannot be simulated.
    #[error("sensors \"{0}\" cannot be simulated; replay this log with --mode open")]
    Sensors(String),
    /// There is nothing to make a map from.
    #[error(
        "no echo of a sonar with a pose about it: nothing to map; give a log with /sonar and /step"
    )]
    NoEcho,
    /// Nothing was replayed.
    #[error(
        "no controller step to replay: none in the log (record with a controller first), or none in the part \
         that was asked for (--from, --to)"
    )]
    NoStep,
    /// There is nobody to bring back.
    #[error("no /joystick message in the log: no recorded person to replay; use --mode open")]
    NoJoystick,
}

impl From<LogError> for ReplayError {
    fn from(error: LogError) -> ReplayError {
        ReplayError::Log(Arc::new(error))
    }
}
