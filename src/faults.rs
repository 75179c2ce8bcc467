//! `--fault`: what is put between sensors and controller, the same for every controller.

use anyhow::{Result, ensure};
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
    /// Seed of what is random about the faults; 0 if not given
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    fault_seed: Option<u64>,
}

impl FaultArgs {
    /// The faults.
    ///
    /// # Errors
    /// One is named twice, or there is a seed for none.
    pub fn faults(&self) -> Result<Faults> {
        ensure!(
            self.fault_seed.is_none() || !self.faults.is_empty(),
            "--fault-seed is for what is random about faults, and there is none: leave it out, or add --fault"
        );
        Ok(Faults::new(self.faults.clone(), self.fault_seed.unwrap_or(0))?)
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.faults.is_empty()
    }
}

/// A fault that met nothing that it could change, in words.
pub fn unmet(fault: &Fault) -> String {
    format!("--fault {fault} changed nothing: there was {}", fault.misses())
}
