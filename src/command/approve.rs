//! `tandem approve`: today's results become the golden ones.

use std::fs;
use std::io;
use std::path::PathBuf;

use anyhow::{Context as _, Result};
use clap::Args;
use compare::golden::Golden;
use serde::Serialize;

use crate::cli::Common;
use crate::fixture::{self, Fixture, Today};
use crate::status::Status;
use crate::{interrupt, output};

/// Accept today's results as the golden ones, and keep the reason.
///
/// Fixtures whose result has not changed are left as they are.
#[derive(Args)]
pub struct Approve {
    /// Folder of fixtures, or one fixture
    #[arg(value_name = "DIR", default_value = "fixtures")]
    folder: PathBuf,
    /// Why the new results are right
    #[arg(long, value_name = "TEXT", value_parser = clap::builder::NonEmptyStringValueParser::new())]
    reason: String,
}

#[derive(Serialize)]
struct Report {
    approved: Vec<String>,
    unchanged: Vec<String>,
}

impl Approve {
    pub fn run(&self, common: &Common) -> Result<Status> {
        let fixtures = fixture::find(&self.folder)?;
        let name = |fixture: &Fixture| fixture.folder.display().to_string();
        // Everything is worked out before anything is written: a fixture that fails leaves all of them
        // as they were.
        let (mut changes, mut bad) = (Vec::new(), Vec::new());
        for fixture in &fixtures {
            interrupt::check()?;
            match self.change(fixture).with_context(|| name(fixture)) {
                Ok(change) => changes.push((fixture, change)),
                Err(error) => bad.push(error),
            }
        }
        if let Some(last) = bad.pop() {
            bad.iter().for_each(output::error);
            return Err(last.context("nothing was approved"));
        }
        let mut report = Report { approved: Vec::new(), unchanged: Vec::new() };
        for (fixture, change) in changes {
            if let Some((today, golden)) = change {
                fixture.write(&today, &golden).with_context(|| name(fixture))?;
                report.approved.push(name(fixture));
            } else {
                report.unchanged.push(name(fixture));
            }
        }
        output::print(common, &report, |report| {
            let lines = report.approved.iter().map(|name| format!("approved   {name}\n"));
            let unchanged = report.unchanged.iter().map(|name| format!("unchanged  {name}\n"));
            lines.chain(unchanged).collect()
        })?;
        Ok(Status::Done)
    }

    /// What is to be written; `None` where nothing has changed.
    fn change(&self, fixture: &Fixture) -> Result<Option<(Today, Golden)>> {
        let today = fixture.replay()?;
        let path = fixture.golden_toml();
        let older = match fs::read_to_string(&path) {
            Ok(text) => Some(Golden::from_toml(&text)?),
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(error) => return Err(error).with_context(|| path.display().to_string()),
        };
        let unchanged = older.as_ref().is_some_and(|older| today.golden.same_result(older));
        // A golden run that cannot be read is written anew.
        if unchanged && fixture.diff(&today).is_ok_and(|diff| diff.same) {
            return Ok(None);
        }
        let golden = today.golden.clone().approved(older.as_ref(), &self.reason)?;
        Ok(Some((today, golden)))
    }
}
