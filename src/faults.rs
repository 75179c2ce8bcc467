//! `--fault`: what is put between sensors and controller, the same for every controller.

use anyhow::Result;
use clap::Args;
use replay::{Fault, Faults};

/// Which faults.
#[derive(Args, Clone, Debug, Default)]
pub struct FaultArgs {
    /// Put a fault between sensors and controller, the same for every controller; may be repeated.
    /// sonar-dropout, cross-talk, encoder-slip take a share, sonar-bias metres, sonar-dead an id,
    /// gyro-bias rad/s, latency and jitter seconds, joystick-freeze FROM-TO in seconds;
    /// controller-hang and controller-panic rehearse a controller that fails after so many seconds
    #[arg(long = "fault", value_name = "NAME=VALUE")]
    faults: Vec<Fault>,
    /// Seed of what is random about the faults
    #[arg(long, default_value_t = 0, value_name = "N")]
    fault_seed: u64,
}

impl FaultArgs {
    /// The faults.
    ///
    /// # Errors
    /// One is named twice.
    pub fn faults(&self) -> Result<Faults> {
        Ok(Faults::new(self.faults.clone(), self.fault_seed)?)
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.faults.is_empty()
    }
}
