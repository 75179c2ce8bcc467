//! The pull source: one clock, one plant, all sensors and the person, in log order.
//!
//! At equal instants the order is sonar, IMU, encoders, exact pose, joystick, truth, step, command;
//! the log time of each is its instant plus its rank in nanoseconds, and the stamps inside carry the
//! instant itself. Instants run from 0 to the session's duration, both included.

use core::convert::Infallible;

use schemas::{
    Command, Event, JoystickSample, Pulled, SIMULATION_EPOCH, Sample, Scenario, ScenarioError,
    SensorSuite, Source, Span, Stamped, Time, Truth,
};

use crate::SimulatorError;
use crate::human::{Human, HumanView};
use crate::plant::Plant;
use crate::sensors::{Encoders, Imu, Sonars, exact_pose};

/// One firing slot of the sonars (specification §10: 25 Hz).
const SONAR_PERIOD_NS: u64 = 40_000_000;
const IMU_PERIOD_NS: u64 = 10_000_000;
const ENCODER_PERIOD_NS: u64 = 20_000_000;
/// How often a person is asked for their joystick, from the start of the session on.
pub const JOYSTICK_PERIOD: Span = Span(20_000_000);
const TRUTH_PERIOD_NS: u64 = 20_000_000;

/// The shortest control period: below it the ranks of one instant would reach into the next.
const LEAST_CONTROL_PERIOD_NS: u64 = 1_000;

/// Everything that a simulated session is determined by, besides the person and the commands.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulationSetup {
    /// World, task, robot, plant and faults.
    pub scenario: Scenario,
    /// Which sensors there are; the scenario's own choice may be overruled.
    pub sensors: SensorSuite,
    /// Noise seed.
    pub seed: u64,
    /// The instant t = 0 of task and world.
    pub start: Time,
    /// How often the controller steps.
    pub control_period: Span,
    /// How long the session lasts.
    pub duration: Span,
}

impl SimulationSetup {
    /// The session as its scenario describes it, with seed 0, at [`SIMULATION_EPOCH`].
    pub fn of(scenario: Scenario, control_period: Span) -> SimulationSetup {
        SimulationSetup {
            sensors: scenario.sensors,
            seed: 0,
            start: SIMULATION_EPOCH,
            control_period,
            duration: Span::from_seconds(scenario.duration_s),
            scenario,
        }
    }
}

/// Event streams by their rank at equal instants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stream {
    Sonar,
    Imu,
    Encoders,
    Exact,
    Joystick,
    Truth,
    Step,
}

const STREAMS: [Stream; 7] = [
    Stream::Sonar,
    Stream::Imu,
    Stream::Encoders,
    Stream::Exact,
    Stream::Joystick,
    Stream::Truth,
    Stream::Step,
];

/// One stream's timetable.
#[derive(Clone, Copy, Debug)]
struct Timetable {
    /// When its next event is due, nanoseconds after the start; `None` if it has none.
    due_ns: Option<u64>,
    period_ns: u64,
    /// Number of its next event.
    index: u64,
}

/// A simulated session in progress.
pub struct Simulation {
    scenario: Scenario,
    start: Time,
    duration_ns: u64,
    human: Box<dyn Human>,
    plant: Plant,
    sonars: Sonars,
    imu: Imu,
    encoders: Encoders,
    timetables: [Timetable; STREAMS.len()],
    /// The least log time that the next event may have.
    earliest: Time,
}

impl Simulation {
    /// Puts the robot at its start.
    ///
    /// # Errors
    /// The scenario's numbers make no sense, or the control period is zero.
    pub fn new(
        setup: SimulationSetup,
        human: Box<dyn Human>,
    ) -> Result<Simulation, SimulatorError> {
        let SimulationSetup { scenario, sensors, seed, start, control_period, duration } = setup;
        let invalid =
            |why: ScenarioError| SimulatorError::Scenario { name: scenario.name.clone(), why };
        scenario.check().map_err(invalid)?;
        if control_period.0 < LEAST_CONTROL_PERIOD_NS {
            return Err(SimulatorError::ControlPeriod {
                least_ns: LEAST_CONTROL_PERIOD_NS,
                got_ns: control_period.0,
            });
        }
        let timetables = STREAMS.map(|stream| {
            let sonar_suite = sensors == SensorSuite::Sonar;
            let (present, period_ns) = match stream {
                Stream::Sonar => (sonar_suite, SONAR_PERIOD_NS),
                Stream::Imu => (sonar_suite, IMU_PERIOD_NS),
                Stream::Encoders => (sonar_suite, ENCODER_PERIOD_NS),
                Stream::Exact => (!sonar_suite, control_period.0),
                Stream::Joystick => (true, JOYSTICK_PERIOD.0),
                Stream::Truth => (true, TRUTH_PERIOD_NS),
                Stream::Step => (true, control_period.0),
            };
            Timetable { due_ns: present.then_some(0), period_ns, index: 0 }
        });
        Ok(Simulation {
            plant: Plant::new(scenario.plant, &scenario.start),
            sonars: Sonars::new(&scenario.world, scenario.noise.sonar, seed),
            imu: Imu::new(scenario.noise.imu, seed),
            encoders: Encoders::new(scenario.noise.encoders, scenario.robot.track_m, seed),
            scenario,
            start,
            duration_ns: duration.0,
            human,
            timetables,
            earliest: start,
        })
    }

    /// The stream that is due next, with its instant and the number of its event; moves it on.
    fn next_due(&mut self) -> Option<(usize, u64, u64)> {
        let mut first: Option<(usize, u64)> = None;
        for (rank, timetable) in self.timetables.iter().enumerate() {
            if let Some(due_ns) = timetable.due_ns
                && first.is_none_or(|(_, least_ns)| due_ns < least_ns)
            {
                first = Some((rank, due_ns));
            }
        }
        let (rank, due_ns) = first.filter(|(_, due_ns)| *due_ns <= self.duration_ns)?;
        let timetable = &mut self.timetables[rank];
        let index = timetable.index;
        timetable.index += 1;
        timetable.due_ns = due_ns.checked_add(timetable.period_ns);
        Some((rank, due_ns, index))
    }

    /// The instant of the next event; `None` at the end.
    pub fn next_at(&self) -> Option<Time> {
        let due_ns = self.timetables.iter().filter_map(|timetable| timetable.due_ns).min()?;
        (due_ns <= self.duration_ns).then(|| self.start.after_ns(due_ns))
    }

    /// Gives a command that was given at an instant of its own, between this event and the next: for
    /// a recording's commands, whose times need not be those of the steps here.
    pub fn command_at(&mut self, at: Time, command: &Command) {
        self.plant.advance_to(at.0.saturating_sub(self.start.0));
        self.plant.command(command);
    }

    /// Instant plus rank; later where instants that are only nanoseconds apart would collide.
    fn log_time(&mut self, stamp: Time, rank: usize) -> Time {
        let nominal = stamp.after_ns(rank as u64);
        let at = if nominal < self.earliest { self.earliest } else { nominal };
        self.earliest = at.after_ns(1);
        at
    }

    fn joystick(&mut self, index: u64, stamp: Time, t_s: f64) -> Option<JoystickSample> {
        let twist = self.plant.twist();
        let request = self.human.joystick(&HumanView {
            t_s,
            stamp,
            index,
            pose: self.plant.pose(),
            v_mps: twist.v_mps,
            omega_radps: twist.omega_radps,
        })?;
        Some(JoystickSample {
            stamp,
            v_mps: request.v_mps,
            omega_radps: request.omega_radps,
            dead_man: request.dead_man,
        })
    }

    fn truth(&self, stamp: Time, t_s: f64) -> Truth {
        let world = &self.scenario.world;
        let pose = self.plant.pose();
        let twist = self.plant.twist();
        let (clearance_m, clearance_static_m) =
            world.clearances_m(&self.scenario.robot.footprint, &pose, t_s);
        Truth {
            stamp,
            pose,
            v_mps: twist.v_mps,
            omega_radps: twist.omega_radps,
            clearance_m,
            clearance_static_m,
            discs: world.discs_at(t_s).collect(),
        }
    }
}

impl Source for Simulation {
    type Error = Infallible;

    fn pull(&mut self) -> Result<Option<Pulled>, Infallible> {
        while let Some((rank, due_ns, index)) = self.next_due() {
            self.plant.advance_to(due_ns);
            let stamp = self.start.after_ns(due_ns);
            let t_s = Span(due_ns).seconds();
            let sample = match STREAMS[rank] {
                Stream::Sonar => Sample::Sonar(self.sonars.scan(
                    index,
                    stamp,
                    t_s,
                    &self.plant.pose(),
                    &self.scenario.world,
                )),
                Stream::Imu => Sample::Imu(self.imu.sample(index, stamp, t_s, &self.plant)),
                Stream::Encoders => {
                    Sample::Encoders(self.encoders.sample(index, stamp, t_s, &self.plant))
                }
                Stream::Exact => Sample::Exact(exact_pose(stamp, &self.plant)),
                Stream::Joystick => match self.joystick(index, stamp, t_s) {
                    Some(sample) => Sample::Joystick(sample),
                    None => continue,
                },
                Stream::Truth => {
                    let event = Event::Truth(self.truth(stamp, t_s));
                    return Ok(Some(Pulled::Event(Stamped {
                        at: self.log_time(stamp, rank),
                        value: event,
                    })));
                }
                Stream::Step => {
                    let at = self.log_time(stamp, rank);
                    // The command that answers is logged right after the step.
                    self.earliest = self.earliest.after_ns(1);
                    return Ok(Some(Pulled::StepDue { at, now: stamp }));
                }
            };
            let at = self.log_time(stamp, rank);
            return Ok(Some(Pulled::Event(Stamped { at, value: Event::Sample(sample) })));
        }
        Ok(None)
    }

    fn actuate(&mut self, command: &Command) {
        self.plant.command(command);
    }
}

#[cfg(test)]
mod tests;
