//! What a log says about one instant, and about what led to it.

use std::path::Path;

use anyhow::{Context as _, Result, bail};
use schemas::{Command, Event, Header, Sample, SonarEcho, Span, Step, Time, Truth};

use super::instant::Instant;
use crate::{interrupt, logs};

/// Echoes are kept this long, seconds: longer than the echo map remembers any.
const ECHOES_S: f64 = 10.0;

/// One step of a log and its past.
pub struct Moment {
    pub header: Header,
    /// The step in force.
    pub step: Box<Step>,
    /// The command that followed it.
    pub command: Option<Command>,
    /// The step before.
    pub before: Option<Box<Step>>,
    /// The last step that had another k.
    pub before_change: Option<Box<Step>>,
    /// When k took the value it has; the first step if it never changed.
    pub since: Time,
    /// What the sonars said in the last seconds, in the order of the log.
    pub echoes: Vec<SonarEcho>,
    /// The last truth, where the log has any.
    pub truth: Option<Truth>,
}

/// Reads a log up to the step in force at `at`: a step is in force until the next one, the last
/// step for a control period.
pub fn find(log: &Path, at: Instant) -> Result<Moment> {
    let name = || log.display().to_string();
    let mut reader = logs::open(log)?;
    let header = reader.header().clone();
    let start = header.run.start;
    let wanted = at.in_log(start);
    let mut past = Past::default();
    let mut span: Option<(Time, Time)> = None;
    let mut followed = false;
    while let Some(event) = reader.next_event().with_context(name)? {
        interrupt::check()?;
        match event.value {
            Event::Step(step) => {
                span = Some((span.map_or(step.stamp, |(first, _)| first), step.stamp));
                if wanted.is_some_and(|wanted| step.stamp <= wanted) {
                    past.step(step);
                } else if past.step.is_some() {
                    followed = true;
                    break;
                }
            }
            Event::Command(command) => past.command(command),
            Event::Truth(truth) => past.truth_now = Some(truth),
            Event::Sample(Sample::Sonar(scan)) => past.echoes.extend(scan.echoes),
            Event::Sample(_) | Event::Gap(_) | Event::Timing(_) => {}
        }
    }
    let Some((first, last)) = span else {
        bail!(
            "{}: no controller step in the log: nothing to explain (record with a controller first)",
            name()
        );
    };
    let until = last + Span(header.run.control_period_ns);
    let within = followed || wanted.is_some_and(|wanted| wanted <= until);
    match past.moment(header) {
        Some(moment) if within => Ok(moment),
        _ => bail!(
            "{}: nothing at {:.3} s: the log's steps go from {:.3} s to {:.3} s ({} to {})",
            name(),
            at.seconds(start),
            first.seconds_since(start),
            last.seconds_since(start),
            super::instant::iso(first),
            super::instant::iso(last)
        ),
    }
}

/// What has been read so far.
#[derive(Default)]
struct Past {
    step: Option<Box<Step>>,
    command: Option<Command>,
    before: Option<Box<Step>>,
    before_change: Option<Box<Step>>,
    since: Time,
    echoes: Vec<SonarEcho>,
    /// How many of them the step had heard.
    heard: usize,
    truth_now: Option<Truth>,
    /// The truth when the step was made.
    truth: Option<Truth>,
}

impl Past {
    fn step(&mut self, step: Box<Step>) {
        self.before = self.step.take();
        match &self.before {
            Some(before) if before.k != step.k => {
                self.before_change.clone_from(&self.before);
                self.since = step.stamp;
            }
            Some(_) => {}
            None => self.since = step.stamp,
        }
        self.echoes.retain(|echo| step.stamp.seconds_since(echo.fired) <= ECHOES_S);
        self.heard = self.echoes.len();
        self.truth.clone_from(&self.truth_now);
        self.command = None;
        self.step = Some(step);
    }

    fn command(&mut self, command: Command) {
        if self.step.as_ref().is_some_and(|step| step.stamp == command.stamp) {
            self.command = Some(command);
        }
    }

    fn moment(mut self, header: Header) -> Option<Moment> {
        self.echoes.truncate(self.heard);
        Some(Moment {
            header,
            step: self.step?,
            command: self.command,
            before: self.before,
            before_change: self.before_change,
            since: self.since,
            echoes: self.echoes,
            truth: self.truth,
        })
    }
}
