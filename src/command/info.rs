//! `tandem info`: what a log holds.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use clap::Args;
use schemas::log::LogInfo;
use schemas::{NS_PER_S, Span, Time};
use serde::Serialize;

use crate::cli::Common;
use crate::output;
use crate::status::Status;

/// What a log holds, and whether it is whole.
///
/// Who made it with what, its topics, and its gaps.
#[derive(Args)]
#[command(after_help = "Exit status: 1 when the log is damaged or cut off.")]
pub struct Info {
    /// The log
    #[arg(value_name = "LOG")]
    log: PathBuf,
}

#[derive(Serialize)]
struct Report<'a> {
    file: String,
    complete: bool,
    damage: Option<String>,
    duration_s: f64,
    /// The first message, where the log begins in the middle of its session; else the session's start.
    start: String,
    /// Where the log begins in the middle of its session, seconds from the session's start.
    begins_late_s: Option<f64>,
    bytes: u64,
    messages: u64,
    channels: Vec<Channel<'a>>,
    run: Run<'a>,
    gaps: Vec<Gap<'a>>,
}

#[derive(Serialize)]
struct Channel<'a> {
    topic: &'a str,
    schema: &'a str,
    encoding: &'a str,
    count: u64,
    rate_hz: f64,
    lost: u64,
}

#[derive(Serialize)]
struct Run<'a> {
    version: &'a str,
    commit: &'a str,
    dirty: bool,
    controller: &'a str,
    params_hash: &'a str,
    seed: u64,
    scenario: &'a str,
    sensors: &'a str,
    driver: &'a str,
    mode: &'a str,
    operator: &'a str,
    note: &'a str,
    format_version: u32,
    source_hash: &'a str,
}

#[derive(Serialize)]
struct Gap<'a> {
    stream: &'a str,
    start_s: f64,
    duration_s: f64,
    cause: &'a str,
}

impl Info {
    pub fn run(&self, common: &Common) -> Result<Status> {
        let log =
            schemas::log::inspect(&self.log).with_context(|| self.log.display().to_string())?;
        print(common, &self.log, &log)?;
        Ok(match &log.damage {
            None => Status::Done,
            Some(damage) => {
                output::note(&format!("error: {}: {damage}", self.log.display()));
                Status::Differs
            }
        })
    }
}

/// Prints what a log holds; `tandem record` does the same for the log it made.
pub fn print(common: &Common, file: &Path, log: &LogInfo) -> Result<()> {
    let run = &log.header.run;
    let report = Report {
        file: file.display().to_string(),
        complete: log.complete,
        damage: log.damage.as_ref().map(ToString::to_string),
        duration_s: log.duration_s,
        start: utc(run.start.after_ns(Span::from_seconds(log.begins_late_s.unwrap_or(0.0)).0)),
        begins_late_s: log.begins_late_s,
        bytes: log.bytes,
        messages: log.messages,
        channels: log
            .channels
            .iter()
            .map(|channel| Channel {
                topic: &channel.topic,
                schema: &channel.schema,
                encoding: &channel.encoding,
                count: channel.count,
                rate_hz: channel.rate_hz,
                lost: channel.lost,
            })
            .collect(),
        run: Run {
            version: &run.program_version,
            commit: &run.commit,
            dirty: run.dirty,
            controller: &run.controller,
            params_hash: &run.params_hash,
            seed: run.seed,
            scenario: &run.scenario,
            sensors: &run.sensors,
            driver: &run.driver,
            mode: &run.mode,
            operator: &run.operator,
            note: &run.note,
            format_version: run.format_version,
            source_hash: &run.source_hash,
        },
        gaps: log
            .gaps
            .iter()
            .map(|gap| Gap {
                stream: &gap.stream,
                start_s: gap.start_s,
                duration_s: gap.duration_s,
                cause: &gap.cause,
            })
            .collect(),
    };
    output::print(common, &report, text)
}

fn text(report: &Report<'_>) -> String {
    let mut text = String::new();
    let run = &report.run;
    let mut line = |label: &str, value: String| {
        let _ = writeln!(text, "{label:12}{value}");
    };
    line("file", report.file.clone());
    line(
        "log",
        format!(
            "{:.1} s from {}, {} messages, {}{}",
            report.duration_s,
            report.start,
            report.messages,
            size(report.bytes),
            if report.complete { "" } else { ", NOT COMPLETE" },
        ),
    );
    if let Some(t_s) = report.begins_late_s {
        line("part", format!("begins in the middle of its session, at {t_s:.2} s"));
    }
    line("controller", format!("{} (parameters {:.12})", run.controller, run.params_hash));
    line("scenario", format!("{}, seed {}, {} sensors", run.scenario, run.seed, run.sensors));
    line("person", format!("{} ({})", run.driver, run.mode));
    if !run.operator.is_empty() {
        line("operator", run.operator.to_owned());
    }
    if !run.note.is_empty() {
        line("note", run.note.to_owned());
    }
    let dirty = if run.dirty { ", with local changes" } else { "" };
    let commit = if run.commit.is_empty() { "unknown" } else { run.commit };
    line("made by", format!("tandem {}, commit {commit:.12}{dirty}", run.version));
    text.push('\n');
    for channel in &report.channels {
        let lost =
            if channel.lost > 0 { format!("  {} LOST", channel.lost) } else { String::new() };
        let _ = writeln!(
            text,
            "{:14}{:28}{:>9}  {:>6.1} Hz{lost}",
            channel.topic, channel.schema, channel.count, channel.rate_hz
        );
    }
    for gap in &report.gaps {
        let _ = writeln!(
            text,
            "gap: {} silent for {:.3} s from {:.3} s: {}",
            gap.stream, gap.duration_s, gap.start_s, gap.cause
        );
    }
    text
}

fn size(bytes: u64) -> String {
    match bytes {
        0..1_000 => format!("{bytes} bytes"),
        1_000..1_000_000 => format!("{:.1} kB", bytes as f64 / 1e3),
        _ => format!("{:.1} MB", bytes as f64 / 1e6),
    }
}

/// An instant as ISO 8601.
fn utc(time: Time) -> String {
    i64::try_from(time.0 / NS_PER_S)
        .ok()
        .and_then(|seconds| jiff::Timestamp::from_second(seconds).ok())
        .map_or_else(|| "unknown".to_owned(), |timestamp| timestamp.to_string())
}
