//! `tandem plot`: one run as a picture.

use std::fmt::Write as _;
use std::path::PathBuf;

use anyhow::{Context as _, Result, anyhow, ensure};
use clap::Args;
use compare::figure::{Facts, Recording, figure};
use compare::report::{number, with_unit};
use schemas::log::LogError;
use serde::Serialize;

use crate::cli::Common;
use crate::status::Status;
use crate::{logs, output};

/// Draw a run: a map with the way and who drove on it, and quantities over time
///
/// The picture is one SVG file that needs nothing else and follows the reader's light or dark mode.
/// The panels show the danger shown to the person; forward speed and turn rate, asked for and
/// commanded; D as compared, with the critical distances Dc(b1) and Dc(b2); the distances of the
/// law; its Lyapunov function; and the footprint's clearance where the log has the truth. Shaded is
/// the time in which the feedback law drives (k = 0).
#[derive(Args)]
#[command(after_help = "\
Examples:
  tandem plot session.mcap -o session.svg
  tandem plot replayed.mcap -o replayed.svg --format json     # what can be read off it, as numbers

To see two controllers on the same person, use the report of `tandem compare`; to know why k changed
at one instant, `tandem explain`.

Exit status: 1 when a damaged log could be drawn in part only; the picture says so.")]
pub struct Plot {
    /// The run: a recorded or replayed log
    #[arg(value_name = "LOG")]
    log: PathBuf,
    /// Where to write the picture
    #[arg(long, short, value_name = "FILE.svg")]
    output: PathBuf,
}

#[derive(Serialize)]
struct Drawn {
    log: String,
    output: String,
    bytes: usize,
    /// Whether the log could be read to its end, and what was in the way.
    whole: bool,
    damage: Option<String>,
    #[serde(flatten)]
    facts: Facts,
}

impl Plot {
    pub fn run(&self, common: &Common) -> Result<Status> {
        let name = || self.log.display().to_string();
        let mut log = logs::open(&self.log)?;
        logs::guard(&self.output, common.force)?;
        logs::guard_input(&self.output, &self.log)?;
        let picture_file = self.output.extension().is_some_and(|end| end == "svg");
        ensure!(picture_file, "{}: the picture is an .svg file", self.output.display());
        let mut recording = Recording::new(log.header());
        let damage =
            logs::each_event(&mut log, |event| recording.observe(event)).with_context(name)?;
        if damage.is_some() {
            recording.cut_short();
        }
        let ((picture, facts), damage) = match (figure(recording), damage) {
            (Ok(drawn), damage) => (drawn, damage),
            // What is too little to be drawn is so because of what cut it.
            (Err(_), Some(damage)) => return Err(anyhow!(damage)).with_context(name),
            (Err(error), None) => return Err(anyhow!(error)).with_context(name),
        };
        output::file(&self.output, &picture)?;
        let drawn = Drawn {
            log: name(),
            output: self.output.display().to_string(),
            bytes: picture.len(),
            whole: damage.is_none(),
            damage: damage.as_ref().map(LogError::to_string),
            facts,
        };
        output::print(common, &drawn, text)?;
        Ok(damage.map_or(Status::Done, |damage| {
            output::note(&format!("error: {}: {damage}; drawn as far as that", drawn.log));
            Status::Differs
        }))
    }
}

fn text(drawn: &Drawn) -> String {
    let facts = &drawn.facts;
    let mut text = format!("{}\n", drawn.log);
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "  feedback law drives   {} % of {}, in {} {}{}",
        number(Some((1000.0 * facts.feedback_share).round() / 10.0)),
        with_unit(&number(Some(facts.duration_s)), "s"),
        facts.feedback_s.len(),
        if facts.feedback_s.len() == 1 { "stretch" } else { "stretches" },
        facts
            .feedback_s
            .first()
            .map_or_else(String::new, |[from_s, _]| format!(", the first from {from_s:.2} s")),
    );
    if let (Some(least_m), Some(at_s)) = (facts.least_clearance_m, facts.least_clearance_at_s) {
        let least = with_unit(&number(Some(least_m)), "m");
        let _ = writeln!(text, "  least clearance       {least} at {at_s:.2} s");
    }
    let [x_m, y_m] = facts.end_m;
    let _ = writeln!(text, "  ends at               ({x_m:.3}, {y_m:.3}) m");
    let _ = writeln!(text, "  written to            {}", drawn.output);
    text
}
