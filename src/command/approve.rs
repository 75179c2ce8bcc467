//! `tandem approve`: today's results become the golden ones.

use std::fs;
use std::io;
use std::path::PathBuf;

use anyhow::{Context as _, Result};
use clap::Args;
use compare::golden::Golden;
use serde::Serialize;

use crate::cli::Common;
use crate::fixture::{self, Fixture};
use crate::output;
use crate::status::Status;

/// Accept what the fixtures give today as their golden results, and keep the reason beside them.
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
        let mut report = Report { approved: Vec::new(), unchanged: Vec::new() };
        for fixture in fixture::find(&self.folder)? {
            let name = fixture.folder.display().to_string();
            if self.approve(&fixture).with_context(|| name.clone())? {
                report.approved.push(name);
            } else {
                report.unchanged.push(name);
            }
        }
        output::print(common, &report, |report| {
            let lines = report.approved.iter().map(|name| format!("approved   {name}\n"));
            let unchanged = report.unchanged.iter().map(|name| format!("unchanged  {name}\n"));
            lines.chain(unchanged).collect()
        })?;
        Ok(Status::Done)
    }

    /// Whether anything was to be approved.
    fn approve(&self, fixture: &Fixture) -> Result<bool> {
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
            return Ok(false);
        }
        let golden = today.golden.clone().approved(older.as_ref(), &self.reason)?;
        fixture.write(&today, &golden)?;
        Ok(true)
    }
}
