//! `tandem explain`: why the controller did what it did at one instant.

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;

use crate::cli::Common;
use crate::explain::{self, Instant};
use crate::output;
use crate::status::Status;

/// Why the controller did what it did at one instant, in words and numbers
///
/// Tells who drove and why: the distance D, the ray it was measured along and the echo or wall that
/// ends it; the critical distances it was compared with; the side, frame and branch of the feedback
/// law; what saturation and safety layer took away; what the person asked for and what was
/// commanded; what changed since the step before and since k last changed; and, in simulated logs,
/// what really was nearest.
///
/// Numbers are those of the recorded step. To name echoes, the recorded controller is stepped over
/// the log again; where this build does not give the same step, it says so and names none.
#[derive(Args)]
#[command(after_help = "\
Examples:
  tandem explain session.mcap --at 12.4
  tandem explain session.mcap --at 2025-01-01T00:00:12.4Z --format json

When to look: `tandem diff` and the moments of `tandem compare` name times; `tandem plot` shows when
k changes. The words are those of docs/controller.md: sets and k in its section 5, the frame and the
sides in section 6, the safety layer in section 9, every `reason` in section 10.")]
pub struct Explain {
    /// The log: recorded, or written by `tandem replay -o`
    #[arg(value_name = "LOG")]
    log: PathBuf,
    /// When: seconds from the start of the log, or an ISO 8601 instant with its zone
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    at: Instant,
}

impl Explain {
    pub fn run(&self, common: &Common) -> Result<Status> {
        let told = explain::explain(&self.log, self.at)?;
        output::print(common, &told, explain::text)?;
        Ok(Status::Done)
    }
}
