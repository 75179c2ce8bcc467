//! Closed loop: the recorded person drives a simulated robot in the log's own world.

use std::io::Read;
use std::sync::Arc;

use controller::{Mutation, Runner, Session, Setup, Spec, SpecError};
use schemas::log::{LogError, LogReader};
use schemas::{Event, Scenario, Span, Stamped, Time};
use simulator::{Simulation, SimulationSetup};

use crate::fault::{Faults, Faulty};
use crate::horizon::{Horizon, Watch};
use crate::human::Person;
use crate::led::Led;
use crate::outcome::{Outcome, Tally};
use crate::recorded::{Recorded, setup};
use crate::window::Between;
use crate::{Covered, OutputHash, Recording, ReplayError, WarmUp, Window};

/// Longer than any log: a replay ends where the recording ends.
const UNTIL_THE_RECORDING_ENDS: Span = Span(u64::MAX / 4);

pub(crate) struct ClosedLoop<R> {
    session: Session<Faulty<Led<R>>>,
    beside: Beside<R>,
    tally: Tally,
    watch: Watch,
    between: Between,
    warm_up: Option<[OutputHash; 2]>,
    start: Time,
    ended: bool,
}

/// What a closed-loop replay is held against, and ended by.
enum Beside<R> {
    /// The recording itself, message by message.
    Log(Box<Recorded<R>>),
    /// Nothing but its end: one arm of several over one reading of the log.
    Until(Time, Option<Arc<LogError>>),
}

impl<R> Beside<R> {
    /// Nothing but the end of the recording.
    fn end_of(recording: &Recording) -> Beside<R> {
        Beside::Until(recording.end(), recording.damage())
    }
}

impl<R: Read> ClosedLoop<R> {
    /// A replay that is compared with `log` message by message.
    pub(crate) fn beside(
        log: LogReader<R>,
        recording: &Arc<Recording>,
        spec: &Spec,
        person: Person,
    ) -> Result<ClosedLoop<R>, ReplayError> {
        let beside = Beside::Log(Box::new(Recorded::new(log)));
        ClosedLoop::new(beside, recording, spec, person, Runner::new)
    }

    /// A replay that needs the log no more.
    pub(crate) fn alone(
        recording: &Arc<Recording>,
        spec: &Spec,
        person: Person,
    ) -> Result<ClosedLoop<R>, ReplayError> {
        ClosedLoop::new(Beside::end_of(recording), recording, spec, person, Runner::new)
    }

    /// The same with a controller that is wrong on purpose.
    pub(crate) fn of_mutant(
        recording: &Arc<Recording>,
        spec: &Spec,
        person: Person,
        mutation: Mutation,
    ) -> Result<ClosedLoop<R>, ReplayError> {
        let runner = |setup: &Setup| Runner::mutant(setup, mutation);
        ClosedLoop::new(Beside::end_of(recording), recording, spec, person, runner)
    }

    fn new(
        beside: Beside<R>,
        recording: &Arc<Recording>,
        spec: &Spec,
        person: Person,
        runner: impl FnOnce(&Setup) -> Result<Runner, SpecError>,
    ) -> Result<ClosedLoop<R>, ReplayError> {
        let header = recording.header();
        let setup = setup(header, spec)?;
        let (sensors, start) = (setup.sensors, setup.start);
        let runner = runner(&setup)?;
        let simulation = Simulation::new(
            SimulationSetup {
                // The controller goes by what the log claims; the robot does what it does.
                scenario: Scenario { plant: recording.plant(), ..setup.scenario },
                sensors,
                seed: header.run.seed,
                start,
                control_period: runner.control_period(),
                duration: UNTIL_THE_RECORDING_ENDS,
            },
            person.of_recording(recording),
        )?;
        let mut source = Faulty::new(Led::new(simulation), start);
        source.silence(recording.gaps());
        Ok(ClosedLoop {
            session: Session::new(source, runner),
            beside,
            tally: Tally::new(Covered::Everything, start),
            watch: Watch::new(Arc::clone(recording), person.gains()),
            between: Between::new(Window::default(), start),
            warm_up: None,
            start,
            ended: false,
        })
    }

    pub(crate) fn under(&mut self, faults: Faults) {
        self.session.source_mut().put(faults);
    }

    /// Replays a part only; `log` leads up to it.
    pub(crate) fn within(&mut self, window: Window, log: LogReader<R>) {
        self.between = Between::new(window, self.start);
        if self.between.from > self.start {
            self.session.source_mut().source_mut().follow(log, self.between.from);
            self.warm_up = Some([0, 1].map(|_| OutputHash::new(Covered::Everything, self.start)));
        }
    }

    pub(crate) fn next_event(&mut self) -> Option<Stamped<Event>> {
        loop {
            let event = self.advance()?;
            if event.at >= self.between.from {
                return Some(event);
            }
        }
    }

    /// The next event, be it on the way to the beginning or after it.
    fn advance(&mut self) -> Option<Stamped<Event>> {
        if self.ended {
            return None;
        }
        let Ok(next) = self.session.next_event();
        let (from, to) = (self.between.from, self.between.to);
        let ClosedLoop { beside, tally, warm_up, .. } = self;
        let event = next.filter(|event| event.at <= to).filter(|event| match beside {
            Beside::Log(log) => log.advance(event.at, |recorded| {
                if recorded.at >= from {
                    tally.recorded(recorded);
                } else if let Some([_, hash]) = warm_up {
                    hear(hash, recorded);
                }
            }),
            Beside::Until(end, _) => event.at <= *end,
        });
        let Some(event) = event else {
            self.ended = true;
            self.tally.damage = match &mut self.beside {
                Beside::Log(log) => log.damage().map(Arc::new),
                Beside::Until(_, damage) => damage.take(),
            };
            return None;
        };
        if event.at < from {
            if let Some([hash, _]) = &mut self.warm_up {
                hear(hash, &event);
            }
            return Some(event);
        }
        let recorded = match &self.beside {
            Beside::Log(log) => log.step.as_deref(),
            Beside::Until(..) => None,
        };
        self.tally.replayed(&event, recorded);
        self.watch.observe(&event);
        Some(event)
    }

    pub(crate) fn is_cut_short(&self) -> bool {
        self.tally.damage.is_some() || self.watch.recording().unreadable().is_some()
    }

    pub(crate) fn runner(&self) -> &Runner {
        self.session.runner()
    }

    /// When the run parted from the recording, so far.
    pub(crate) fn horizon(&self) -> Horizon {
        self.watch.horizon()
    }

    pub(crate) fn finish(mut self) -> Result<Outcome, ReplayError> {
        // A person of whom something is missing is not the recorded one.
        self.tally.damage = self.tally.damage.or_else(|| self.watch.recording().unreadable());
        let alone = matches!(self.beside, Beside::Until(..));
        let unmet_faults = self.session.source_mut().unmet();
        let mut outcome = self.tally.finish()?;
        outcome.unmet_faults = unmet_faults;
        // Without the log beside there is nothing to judge the way by.
        outcome.warm_up = self.warm_up.filter(|_| !alone).map(|[heard, recorded]| {
            if heard.hex() == recorded.hex() { WarmUp::Exact } else { WarmUp::Differs }
        });
        outcome.horizon = Some(self.watch.horizon());
        outcome.furthest = Some(self.watch.furthest());
        outcome.identical_to_recorded &= !alone;
        Ok(outcome)
    }
}

/// Adds what a controller hears, and where the robot was; not what a controller said.
fn hear(hash: &mut OutputHash, event: &Stamped<Event>) {
    if matches!(event.value, Event::Sample(_) | Event::Truth(_)) {
        hash.update(event);
    }
}
