//! What a log tells about its person: joystick and robot state side by side, fifty times a second.
//!
//! In: one pass over a log. Out: a [`Recording`] that every model of the person is made from, and
//! that several replays of the log can share. Memory grows with the log, by about 15 MB an hour.

mod coverage;

use std::io::Read;
use std::sync::Arc;

use schemas::log::{LogError, LogReader, Topic};
use schemas::{
    Event, Explored, Gap, Header, JoystickSample, Plant, Pose, Sample, Span, Time, Truth, World,
    wrap,
};
use simulator::{JOYSTICK_PERIOD, Request};

use crate::ReplayError;
use crate::human::Explanations;
pub(crate) use coverage::Coverage;

/// The longest recording whose person can be brought back, ticks (six hours): a damaged time stamp
/// must not ask for the memory of a century.
const MOST_TICKS: u64 = 6 * 3600 * 50;

/// Longest gap between two states across which one in between is taken from a straight line.
const LONGEST_GAP: Span = Span(500_000_000);

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
    moments: Vec<Moment>,
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
        let header = log.header().clone();
        let mut log = log.only(&[
            Topic::Joystick,
            Topic::Truth,
            Topic::Step,
            Topic::Sonar,
            Topic::Command,
            Topic::Gap,
        ]);
        let mut builder = Builder::new(&header);
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
        if !builder.moments.iter().any(|moment| moment.request.is_some()) {
            return Err(damage.map_or(ReplayError::NoJoystick, ReplayError::from));
        }
        Ok(Recording {
            header,
            moments: builder.moments,
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

    pub(crate) fn moments(&self) -> &[Moment] {
        &self.moments
    }

    /// The tick of that number.
    pub(crate) fn moment(&self, index: u64) -> Option<&Moment> {
        self.moments.get(usize::try_from(index).ok()?)
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

/// What a recording is made of while its log is read.
struct Builder {
    start: Time,
    moments: Vec<Moment>,
    coverage: Option<Coverage>,
    gaps: Vec<Gap>,
    /// The newest state, with its instant.
    last: Option<(Time, State)>,
    /// Whether states come from `/truth`; from the controller's estimate otherwise.
    truth: bool,
}

impl Builder {
    fn new(header: &Header) -> Builder {
        let start = header.run.start;
        let (moments, gaps) = (Vec::new(), Vec::new());
        Builder { start, moments, coverage: None, gaps, last: None, truth: false }
    }

    fn observe(&mut self, event: &Event) {
        match event {
            Event::Sample(Sample::Joystick(sample)) => self.joystick(sample),
            Event::Sample(Sample::Sonar(scan)) => {
                let coverage = self.coverage.get_or_insert_default();
                if let Some((_, state)) = &self.last {
                    coverage.see(&state.pose, scan);
                }
            }
            Event::Truth(truth) => self.truth(truth),
            Event::Gap(gap) => self.gaps.push(gap.clone()),
            // The person looks at the robot themselves; the estimate is the next best.
            Event::Step(step) if !self.truth => {
                let (v_mps, omega_radps) = (step.v_mps, step.omega_radps);
                self.state(step.stamp, State { pose: step.pose, v_mps, omega_radps });
            }
            _ => {}
        }
    }

    fn truth(&mut self, truth: &Truth) {
        if !self.truth {
            self.truth = true;
            self.last = None;
            self.moments.iter_mut().for_each(|moment| moment.state = None);
        }
        let (v_mps, omega_radps) = (truth.v_mps, truth.omega_radps);
        self.state(truth.stamp, State { pose: truth.pose, v_mps, omega_radps });
    }

    /// The first tick at or after an instant; `None` beyond what can be kept.
    fn tick(&self, stamp: Time) -> Option<usize> {
        let after_ns = stamp.0.saturating_sub(self.start.0);
        let tick = after_ns.div_ceil(JOYSTICK_PERIOD.0);
        (tick < MOST_TICKS).then_some(tick as usize)
    }

    fn moment(&mut self, tick: usize) -> &mut Moment {
        if self.moments.len() <= tick {
            self.moments.resize(tick + 1, Moment::default());
        }
        &mut self.moments[tick]
    }

    fn joystick(&mut self, sample: &JoystickSample) {
        if let Some(tick) = self.tick(sample.stamp) {
            self.moment(tick).request = Some(Request {
                v_mps: sample.v_mps,
                omega_radps: sample.omega_radps,
                dead_man: sample.dead_man,
            });
        }
    }

    /// Takes in a state: every tick since the one before gets its share of the way between.
    fn state(&mut self, stamp: Time, state: State) {
        if !state.is_finite() || stamp < self.start {
            return;
        }
        let Some(tick) = self.tick(stamp) else { return };
        let before = self.last.replace((stamp, state));
        if let Some((earlier, from)) = before
            && earlier < stamp
            && stamp.0 - earlier.0 <= LONGEST_GAP.0
        {
            let first = self.tick(earlier).unwrap_or(tick);
            for between in first..tick {
                let at = self.start.after_ns(between as u64 * JOYSTICK_PERIOD.0);
                if at > earlier {
                    let share = at.seconds_since(earlier) / stamp.seconds_since(earlier);
                    self.moment(between).state = Some(part_way(&from, &state, share));
                }
            }
        }
        if self.start.after_ns(tick as u64 * JOYSTICK_PERIOD.0) == stamp {
            self.moment(tick).state = Some(state);
        }
    }
}

/// The state that share of the way from one to the other, the short way round.
fn part_way(from: &State, to: &State, share: f64) -> State {
    let mix = |a: f64, b: f64| a + share * (b - a);
    let turned_rad = wrap(to.pose.theta_rad - from.pose.theta_rad);
    State {
        pose: Pose {
            x_m: mix(from.pose.x_m, to.pose.x_m),
            y_m: mix(from.pose.y_m, to.pose.y_m),
            theta_rad: from.pose.theta_rad + share * turned_rad,
        },
        v_mps: mix(from.v_mps, to.v_mps),
        omega_radps: mix(from.omega_radps, to.omega_radps),
    }
}
