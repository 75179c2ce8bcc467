//! What a log tells about its person: joystick and robot state side by side, fifty times a second.
//!
//! In: one pass over a log. Out: a [`Recording`] that every model of the person is made from, and
//! that several replays of the log can share. Its memory is the same for a minute and for hours.

mod builder;
mod coverage;
mod moments;

use std::io::Read;
use std::sync::Arc;

use schemas::log::{LogError, LogReader, Topic};
use schemas::{Explored, Gap, Header, Plant, Pose, Time, World};
use simulator::{JOYSTICK_PERIOD, Request};

use crate::ReplayError;
use crate::human::Explanations;
use builder::Builder;
pub(crate) use coverage::Coverage;
pub(crate) use moments::Look;
use moments::{KEPT, Moments};

/// Where the robot was and how fast it went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct State {
    pub(crate) pose: Pose,
    pub(crate) v_mps: f64,
    pub(crate) omega_radps: f64,
}

impl State {
    fn is_finite(&self) -> bool {
        self.pose.is_finite() && self.v_mps.is_finite() && self.omega_radps.is_finite()
    }
}

/// One tick of the joystick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Moment {
    /// What the person asked for; `None` where the joystick sent nothing.
    pub(crate) request: Option<Request>,
    /// The robot's state then; `None` where it is not known.
    pub(crate) state: Option<State>,
}

/// The person of a log and what they were looking at.
#[derive(Clone, Debug)]
pub struct Recording {
    header: Header,
    moments: Arc<Moments>,
    coverage: Option<Coverage>,
    gaps: Vec<Gap>,
    end: Time,
    plant: Option<Plant>,
    damage: Option<Arc<LogError>>,
    explanations: Explanations,
}

impl Recording {
    /// Reads a log to its end, or as far as it goes: damage is for whoever replays to report.
    ///
    /// # Errors
    /// The log holds no joystick sample, or none before it is damaged: there is nobody to bring back.
    pub fn read<R: Read>(log: LogReader<R>) -> Result<Recording, ReplayError> {
        Recording::read_keeping(log, KEPT)
    }

    /// The same with so many moments in memory, all others in a file.
    pub(crate) fn read_keeping<R: Read>(
        log: LogReader<R>,
        kept: usize,
    ) -> Result<Recording, ReplayError> {
        let header = log.header().clone();
        let mut log = log.only(&[
            Topic::Joystick,
            Topic::Truth,
            Topic::Step,
            Topic::Sonar,
            Topic::Command,
            Topic::Gap,
        ]);
        let mut builder = Builder::new(header.run.start, kept);
        let mut end = header.run.start;
        let damage = loop {
            match log.next_event() {
                Ok(Some(event)) => {
                    end = event.at;
                    builder.observe(&event.value);
                }
                Ok(None) => break None,
                Err(error) => break Some(error),
            }
        };
        if !builder.asked {
            return Err(damage.map_or(ReplayError::NoJoystick, ReplayError::from));
        }
        Ok(Recording {
            header,
            moments: Arc::new(builder.moments),
            coverage: builder.coverage,
            gaps: builder.gaps,
            end,
            plant: None,
            damage: damage.map(Arc::new),
            explanations: Explanations::default(),
        })
    }

    /// The same person on another plant than the log claims: that which was identified from it, say.
    #[must_use]
    pub fn on_plant(self, plant: Plant) -> Recording {
        Recording { plant: Some(plant), ..self }
    }

    /// The same person with other noise in sensors and actuators.
    #[must_use]
    pub fn with_seed(mut self, seed: u64) -> Recording {
        self.header.run.seed = seed;
        self
    }

    /// The same person in another world than the log's: one that was mapped from it, say. What
    /// [`Recording::header`] gives is then of that world.
    #[must_use]
    pub fn in_world(mut self, world: World, explored: Option<Explored>) -> Recording {
        self.header.scenario.world = world;
        self.header.scenario.explored = explored;
        // What the person may have been after depends on where one can stand.
        self.explanations = Explanations::default();
        self
    }

    /// What ended the log before its end, where something did.
    pub(crate) fn damage(&self) -> Option<Arc<LogError>> {
        self.damage.clone()
    }

    /// The plant that a replay drives.
    pub(crate) fn plant(&self) -> Plant {
        self.plant.unwrap_or(self.header.scenario.plant)
    }

    /// What stands at the head of the log.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// What is known of its person already.
    pub(crate) fn explanations(&self) -> &Explanations {
        &self.explanations
    }

    /// Log time of the last event that was read.
    pub(crate) fn end(&self) -> Time {
        self.end
    }

    /// A look at its moments.
    pub(crate) fn look(&self) -> Look {
        Look::new(&self.moments)
    }

    /// Why moments of it are missing, where some are.
    pub(crate) fn unreadable(&self) -> Option<Arc<LogError>> {
        self.moments.unreadable()
    }

    /// When which streams were silent.
    pub(crate) fn gaps(&self) -> &[Gap] {
        &self.gaps
    }

    /// Where the recorded sonars have seen; `None` for a log without sonars.
    pub(crate) fn coverage(&self) -> Option<&Coverage> {
        self.coverage.as_ref()
    }

    /// A recording made by hand.
    #[cfg(test)]
    pub(crate) fn for_test(scenario: schemas::Scenario, moments: Vec<Moment>) -> Recording {
        let start = schemas::SIMULATION_EPOCH;
        let run = schemas::RunInfo { start, ..schemas::RunInfo::default() };
        let header = Header { run, params_toml: String::new(), scenario };
        let end = start.after_ns(moments.len() as u64 * JOYSTICK_PERIOD.0);
        let moments = Arc::new(Moments::from(moments));
        let gaps = Vec::new();
        Recording {
            header,
            moments,
            coverage: None,
            gaps,
            end,
            plant: None,
            damage: None,
            explanations: Explanations::default(),
        }
    }

    #[cfg(test)]
    pub(crate) fn header_mut(&mut self) -> &mut Header {
        self.explanations = Explanations::default();
        &mut self.header
    }

    /// Seconds from the start to the tick of that number.
    pub(crate) fn tick_s(index: usize) -> f64 {
        index as f64 * JOYSTICK_PERIOD.seconds()
    }
}
