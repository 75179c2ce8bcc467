//! What viewers see of a session: Foxglove messages made from its events.
//!
//! A [`Picture`] follows the events of a session and gives, ten times a second of log time, frames,
//! poses and a scene, and a line of text whenever somebody else drives. [`LAYOUT`] arranges them.

mod frames;
mod grid;
mod journal;
mod primitives;
mod room;
mod scene;

#[cfg(test)]
mod layout_tests;
#[cfg(test)]
mod tests;

use prost::Message;

use crate::log::{Arm, Topic};
use crate::{
    Event, Explored, Header, NS_PER_S, Pose, SONARS, Sample, SonarEcho, Span, Stamped, Step, Time,
    Truth,
};
use frames::Frames;
use journal::Journal;
use scene::Stage;

/// The layout for Foxglove-compatible viewers that is attached to every log.
pub const LAYOUT: &str = include_str!("layout.json");
/// The same for logs in which two runs stand side by side.
pub const LAYOUT_AB: &str = include_str!("layout_ab.json");

/// From one drawing to the next, log time.
const PERIOD: Span = Span(NS_PER_S / 10);

/// One message for viewers.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// Where it goes.
    pub topic: Topic,
    /// Its log time.
    pub at: Time,
    /// The encoded message.
    pub bytes: Vec<u8>,
}

impl Shown {
    fn new(topic: Topic, at: Time, message: &impl Message) -> Shown {
        Shown { topic, at, bytes: message.encode_to_vec() }
    }
}

/// The newest of everything that is drawn.
#[derive(Debug, Default)]
struct Seen {
    sonar: [Option<SonarEcho>; SONARS.len()],
    truth: Option<Truth>,
    step: Option<Box<Step>>,
}

impl Seen {
    /// Where the robot really is.
    fn truth(&self) -> Option<Pose> {
        self.truth.as_ref().map(|truth| truth.pose).filter(Pose::is_finite)
    }

    /// Where it believes to be.
    fn estimate(&self) -> Option<Pose> {
        self.step.as_ref().map(|step| step.pose).filter(Pose::is_finite)
    }

    /// Where it is drawn.
    fn robot(&self) -> Option<Pose> {
        self.truth().or_else(|| self.estimate())
    }
}

/// Follows a session and draws it.
#[derive(Debug)]
pub struct Picture {
    frames: Frames,
    stage: Stage,
    seen: Seen,
    journal: Journal,
    /// The map, as long as it has not been shown.
    map: Option<Explored>,
    due: Option<Time>,
}

impl Picture {
    /// The stage is set; nothing has been seen yet.
    pub fn new(header: &Header) -> Picture {
        Picture::of(header, None)
    }

    /// The same for one of two runs that are drawn into one world.
    pub fn of(header: &Header, arm: Option<Arm>) -> Picture {
        Picture {
            frames: Frames::of(arm),
            stage: Stage::new(&header.scenario, arm),
            seen: Seen::default(),
            journal: Journal::default(),
            map: header.scenario.explored.clone(),
            due: None,
        }
    }

    /// Takes in an event; gives the messages that are due after it, at its log time.
    pub fn observe(&mut self, event: &Stamped<Event>) -> Vec<Shown> {
        let at = event.at;
        let mut shown = Vec::new();
        match &event.value {
            Event::Sample(Sample::Sonar(scan)) => {
                for echo in &scan.echoes {
                    if let Some(slot) = self.seen.sonar.get_mut(usize::from(echo.id)) {
                        *slot = Some(*echo);
                    }
                }
            }
            Event::Truth(truth) => self.seen.truth = Some(truth.clone()),
            Event::Step(step) => {
                let line = self.journal.step(at, step);
                shown.extend(line.map(|line| Shown::new(Topic::Log, at, &line)));
                self.seen.step = Some(step.clone());
            }
            Event::Gap(gap) => {
                shown.push(Shown::new(Topic::Log, at, &journal::gap(at, gap)));
            }
            Event::Sample(_) | Event::Command(_) | Event::Timing(_) => {}
        }
        let mut due = *self.due.get_or_insert(at);
        // A command is the last event of its instant: then everything belongs together. Where none
        // comes in time, half a period late is as late as it gets.
        let settled = matches!(event.value, Event::Command(_));
        if at >= due && (settled || at >= due + Span(PERIOD.0 / 2)) {
            self.draw(at, &mut shown);
            due = at + Span(PERIOD.0 - at.0.saturating_sub(due.0) % PERIOD.0);
        }
        self.due = Some(due);
        shown
    }

    fn draw(&mut self, at: Time, shown: &mut Vec<Shown>) {
        let (robot, estimate) = (self.seen.robot(), self.seen.estimate());
        shown.push(Shown::new(Topic::Tf, at, &self.frames.transforms(at, robot, estimate)));
        if let Some(pose) = estimate {
            let pose = frames::pose_in(self.frames.odom, at, &pose);
            shown.push(Shown::new(Topic::Pose, at, &pose));
        }
        if let Some(pose) = self.seen.truth() {
            let pose = frames::pose_in(frames::WORLD, at, &pose);
            shown.push(Shown::new(Topic::PoseTruth, at, &pose));
        }
        if let Some(explored) = self.map.take() {
            shown.push(Shown::new(Topic::Map, at, &grid::grid(at, &explored)));
        }
        shown.push(Shown::new(Topic::Scene, at, &self.stage.scene(at, &self.seen)));
    }
}
