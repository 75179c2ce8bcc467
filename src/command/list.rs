//! `tandem scenarios`, `controllers`, `topics`: what there is to name.

use std::fmt::Write as _;

use anyhow::Result;
use clap::Args;
use schemas::log::TOPICS;
use serde::Serialize;

use crate::cli::Common;
use crate::output;
use crate::status::Status;

/// The scenarios there are to record.
#[derive(Args)]
pub struct Scenarios {
    /// Print this scenario as TOML, to start one of your own from
    #[arg(value_name = "NAME")]
    name: Option<String>,
}

/// The controllers there are, or one controller's parameters.
#[derive(Args)]
pub struct Controllers {
    /// List this controller's parameters with unit, range, default and source
    #[arg(value_name = "NAME")]
    name: Option<String>,
}

/// The topics of a log.
#[derive(Args)]
pub struct Topics {}

#[derive(Serialize)]
struct Entry {
    name: String,
    summary: String,
}

fn table(entries: &[Entry]) -> String {
    let width = entries.iter().map(|entry| entry.name.len()).max().unwrap_or(0);
    entries.iter().fold(String::new(), |mut text, entry| {
        let _ = writeln!(text, "{:width$}  {}", entry.name, entry.summary);
        text
    })
}

impl Scenarios {
    pub fn run(&self, common: &Common) -> Result<Status> {
        if let Some(name) = &self.name {
            let scenario = super::record::scenario(name)?;
            output::print(common, &scenario, schemas::Scenario::to_toml)?;
            return Ok(Status::Done);
        }
        let entries: Vec<Entry> = simulator::scenarios()
            .into_iter()
            .map(|(name, summary)| Entry { name, summary })
            .collect();
        output::print(common, &entries, |entries| table(entries))?;
        Ok(Status::Done)
    }
}

#[derive(Serialize)]
struct ParameterEntry {
    key: &'static str,
    value: String,
    unit: &'static str,
    range: String,
    meaning: &'static str,
    source: &'static str,
}

impl Controllers {
    pub fn run(&self, common: &Common) -> Result<Status> {
        let Some(name) = &self.name else {
            let entries: Vec<Entry> = controller::versions()
                .iter()
                .map(|version| Entry {
                    name: version.name.to_owned(),
                    summary: version.summary.to_owned(),
                })
                .collect();
            output::print(common, &entries, |entries| table(entries))?;
            return Ok(Status::Done);
        };
        let spec = controller::Spec::resolve(name, &[])?;
        let table = controller::Params::table();
        let entries: Vec<ParameterEntry> = table
            .iter()
            .zip(spec.params.settings())
            .map(|(row, value)| ParameterEntry {
                key: row.key,
                value: toml::Value::from(value).to_string(),
                unit: row.unit,
                range: row.allowed.to_string(),
                meaning: row.meaning,
                source: row.source,
            })
            .collect();
        output::print(common, &entries, |entries| {
            entries.iter().fold(String::new(), |mut text, entry| {
                let value = format!("{} {}", entry.value, entry.unit);
                let _ =
                    writeln!(text, "{:22} {:14} {}", entry.key, value.trim_end(), entry.meaning);
                let _ = writeln!(text, "{:22} {:14} {}; {}", "", "", entry.range, entry.source);
                text
            })
        })?;
        Ok(Status::Done)
    }
}

#[derive(Serialize)]
struct TopicEntry {
    topic: &'static str,
    schema: &'static str,
    rate: &'static str,
    compared: &'static str,
    summary: &'static str,
}

impl Topics {
    #[expect(clippy::unused_self, reason = "every command is run alike")]
    pub fn run(&self, common: &Common) -> Result<Status> {
        let entries: Vec<TopicEntry> = TOPICS
            .iter()
            .map(|row| TopicEntry {
                topic: row.name,
                schema: row.schema,
                rate: row.rate,
                compared: row.compared.name(),
                summary: row.summary,
            })
            .collect();
        output::print(common, &entries, |entries| {
            entries.iter().fold(String::new(), |mut text, row| {
                let _ = writeln!(
                    text,
                    "{:12} {:26} {:15} compared: {:7} {}",
                    row.topic, row.schema, row.rate, row.compared, row.summary
                );
                text
            })
        })?;
        Ok(Status::Done)
    }
}
