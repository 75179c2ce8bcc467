//! `tandem check`: every fixture against its golden result.

use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use anyhow::{Context as _, Result};
use clap::Args;
use compare::golden::{self, Golden, Problem};
use serde::Serialize;

use crate::cli::Common;
use crate::command::replay::patience;
use crate::fixture::{self, Fixture};
use crate::fleet::watch;
use crate::output;
use crate::status::Status;

/// Replay every fixture with today's controller and compare it with its golden result.
///
/// A fixture is a folder with a recorded session, a `fixture.toml` that names the controller and
/// the mode, and the golden result that was once approved. The controller runs with the defaults
/// of this build, so a changed default shows up here.
#[derive(Args)]
#[command(after_help = "\
Exit status: 1 when a fixture gives something else than its golden result.
If the change is meant: tandem approve --reason TEXT")]
pub struct Check {
    /// Folder of fixtures, or one fixture
    #[arg(value_name = "DIR", default_value = "fixtures")]
    folder: PathBuf,
    /// Give up on a controller that does not answer for so many seconds; its fixture then has failed
    #[arg(long, default_value = "30", value_name = "SECONDS", value_parser = patience,
          allow_negative_numbers = true)]
    hang_after: Duration,
}

#[derive(Serialize)]
struct Report {
    ok: bool,
    problems: Vec<Problem>,
    fixtures: Vec<Checked>,
}

#[derive(Serialize)]
struct Checked {
    fixture: String,
    ok: bool,
    steps: u64,
    output_hash: Option<String>,
}

impl Check {
    pub fn run(&self, common: &Common) -> Result<Status> {
        let fixtures = fixture::find(&self.folder)?;
        let results = watch::each(common, fixtures.clone(), "checking", self.hang_after, check);
        let mut report = Report { ok: true, problems: Vec::new(), fixtures: Vec::new() };
        for (fixture, result) in fixtures.iter().zip(results) {
            let fixture = fixture.folder.display().to_string();
            let (problems, today) = result.unwrap_or_else(|error| {
                let problem = Problem {
                    at: fixture.clone(),
                    what: format!("{error:#}"),
                    remedy: "mend the controller, or restore the fixture: fixtures/README.md"
                        .to_owned(),
                };
                (vec![problem], None)
            });
            report.ok &= problems.is_empty();
            report.fixtures.push(Checked {
                fixture,
                ok: problems.is_empty(),
                steps: today.as_ref().map_or(0, |golden| golden.steps),
                output_hash: today.map(|golden| golden.output_hash),
            });
            report.problems.extend(problems);
        }
        output::print(common, &report, text)?;
        Ok(if report.ok { Status::Done } else { Status::Differs })
    }
}

fn check(fixture: &Fixture) -> Result<(Vec<Problem>, Option<Golden>)> {
    let today = fixture.replay()?;
    let name = fixture.folder.display().to_string();
    let path = fixture.golden_toml();
    let path_name = || path.display().to_string();
    let problems = if path.is_file() {
        let text = fs::read_to_string(&path).with_context(path_name)?;
        let golden = Golden::from_toml(&text).with_context(path_name)?;
        match fixture.diff(&today) {
            Ok(diff) => golden::check(&name, &golden, &today.golden, Some(&diff)),
            Err(error) => {
                let mut problems = golden::check(&name, &golden, &today.golden, None);
                problems.push(Problem {
                    at: name.clone(),
                    what: format!("the golden run cannot be read: {error:#}"),
                    remedy: format!(
                        "restore golden.mcap, or write it anew: tandem approve {name} --reason TEXT"
                    ),
                });
                problems
            }
        }
    } else {
        vec![Problem {
            at: name.clone(),
            what: "there is no golden result yet (golden.toml)".to_owned(),
            remedy: format!("look at the session, then: tandem approve {name} --reason TEXT"),
        }]
    };
    Ok((problems, Some(today.golden)))
}

fn text(report: &Report) -> String {
    let mut text = String::new();
    for fixture in &report.fixtures {
        let mark = if fixture.ok { "ok      " } else { "DIFFERS " };
        let _ = writeln!(text, "{mark} {} ({} steps)", fixture.fixture, fixture.steps);
    }
    for problem in &report.problems {
        let _ = writeln!(text, "\n{}: {}", problem.at, problem.what);
        let _ = writeln!(text, "  {}", problem.remedy);
    }
    text
}
