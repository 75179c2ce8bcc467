//! Simulated sessions, put together in one place: whose controller, which person, where, with which noise.

use controller::{Runner, Setup, Spec, SpecError};
use schemas::{
    Driver, FORMAT_VERSION, Header, Plant, RunInfo, SIMULATION_EPOCH, Scenario, SensorSuite, Span,
};
use simulator::{Simulation, SimulationSetup, SimulatorError};

/// Everything that a simulated session is determined by.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulated {
    /// The controller that shares the robot.
    pub spec: Spec,
    /// Where, with which task, robot and person, and for how long; what the controller goes by.
    pub scenario: Scenario,
    /// The plant that moves. Another one than the scenario's is one that nobody knows of.
    pub plant: Plant,
    /// Which sensors there are.
    pub sensors: SensorSuite,
    /// Who steers.
    pub driver: Driver,
    /// Seed of all noise.
    pub seed: u64,
}

/// Why a session cannot begin.
#[derive(Debug, thiserror::Error)]
pub enum BeginError {
    /// The controller's parameters do not fit.
    #[error(transparent)]
    Spec(#[from] SpecError),
    /// The scenario cannot be simulated, or not driven by that person.
    #[error(transparent)]
    Simulation(#[from] SimulatorError),
}

impl Simulated {
    /// As the scenario describes it, with seed 0.
    pub fn of(spec: Spec, scenario: Scenario) -> Simulated {
        let Scenario { plant, sensors, driver, .. } = scenario;
        Simulated { spec, scenario, plant, sensors, driver, seed: 0 }
    }

    /// The simulation, before its first event, and the controller that is to drive it. It starts at
    /// [`SIMULATION_EPOCH`].
    ///
    /// # Errors
    /// The controller's parameters do not fit, the scenario makes no sense, or that person cannot drive in it.
    pub fn begin(&self) -> Result<(Simulation, Runner), BeginError> {
        let Simulated { spec, scenario, plant, sensors, driver, seed } = self;
        let (sensors, start) = (*sensors, SIMULATION_EPOCH);
        let setup = Setup { spec: spec.clone(), scenario: scenario.clone(), sensors, start };
        let runner = Runner::new(&setup)?;
        let real = Scenario { plant: *plant, ..scenario.clone() };
        let person = simulator::driver(&real, *driver, *seed)?;
        let setup = SimulationSetup {
            sensors,
            seed: *seed,
            ..SimulationSetup::of(real, runner.control_period())
        };
        Ok((Simulation::new(setup, person)?, runner))
    }

    /// The head of its log, but for who records it with which program.
    pub fn header(&self) -> Header {
        Header {
            run: RunInfo {
                format_version: FORMAT_VERSION,
                controller: self.spec.name.clone(),
                seed: self.seed,
                scenario: self.scenario.name.clone(),
                sensors: self.sensors.name().to_owned(),
                driver: self.driver.name().to_owned(),
                mode: "record".to_owned(),
                start: SIMULATION_EPOCH,
                control_period_ns: Span::from_seconds(self.spec.params.control_period_s).0,
                ..RunInfo::default()
            },
            params_toml: self.spec.params_toml(),
            scenario: self.scenario.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use controller::Session;
    use schemas::{Event, Sample, Step, Time, Truth};

    /// What there is to see of three seconds.
    #[derive(Default)]
    struct Seen {
        samples: Vec<Sample>,
        steps: Vec<Step>,
        truths: Vec<Truth>,
    }

    impl Seen {
        fn of(simulated: &Simulated) -> Seen {
            let (simulation, runner) = simulated.begin().expect("a sound session");
            let mut session = Session::new(simulation, runner);
            let mut seen = Seen::default();
            while let Ok(Some(event)) = session.next_event() {
                match event.value {
                    Event::Sample(sample) => seen.samples.push(sample),
                    Event::Step(step) => seen.steps.push(*step),
                    Event::Truth(truth) => seen.truths.push(truth),
                    _ => {}
                }
            }
            seen
        }

        fn any(&self, is: impl Fn(&Sample) -> bool) -> bool {
            self.samples.iter().any(is)
        }

        fn joystick(&self) -> Vec<[f64; 2]> {
            let asked = |sample: &Sample| match sample {
                Sample::Joystick(joystick) => Some([joystick.v_mps, joystick.omega_radps]),
                _ => None,
            };
            self.samples.iter().filter_map(asked).collect()
        }

        /// When the robot first moves.
        fn moves_at(&self) -> Time {
            let moves = |truth: &&Truth| truth.v_mps != 0.0 || truth.omega_radps != 0.0;
            self.truths.iter().find(moves).expect("it moves").stamp
        }
    }

    /// A session in a room with a task, three seconds long.
    fn session() -> Simulated {
        let room = simulator::scenario("random:rect:goal:3").expect("a random room");
        let scenario = Scenario { duration_s: 3.0, ..room };
        let spec = Spec::for_scenario("tandem-dynamic", &scenario, &[]).expect("a version");
        Simulated { sensors: SensorSuite::Exact, seed: 7, ..Simulated::of(spec, scenario) }
    }

    /// Its sensors, and no others, are heard; its controller steps as often as its head says, from the start on.
    #[test]
    fn its_sensors_and_its_period_are_those_that_act() {
        for sensors in [SensorSuite::Exact, SensorSuite::Sonar] {
            let simulated = Simulated { sensors, ..session() };
            let seen = Seen::of(&simulated);
            let exact = sensors == SensorSuite::Exact;
            assert_eq!(seen.any(|sample| matches!(sample, Sample::Exact(_))), exact);
            assert_eq!(seen.any(|sample| matches!(sample, Sample::Sonar(_))), !exact);
            assert_eq!(seen.any(|sample| matches!(sample, Sample::Imu(_))), !exact);
            let run = simulated.header().run;
            let due = |n: usize| run.start.after_ns(n as u64 * run.control_period_ns);
            assert!(seen.steps.len() > 10);
            assert!(seen.steps.iter().enumerate().all(|(n, step)| step.stamp == due(n)));
        }
    }

    /// Who steers, and with which noise, shows in the joystick.
    #[test]
    fn its_driver_and_its_seed_steer() {
        let goal = session();
        assert_eq!(goal.driver, Driver::Goal);
        let joystick = |simulated: &Simulated| Seen::of(simulated).joystick();
        let asked = joystick(&goal);
        assert!(asked.iter().any(|asked| *asked != [0.0; 2]));
        assert!(asked == joystick(&goal), "the same session again");
        let flowing = Simulated { driver: Driver::Flowing, ..goal.clone() };
        let reseeded = Simulated { seed: 8, ..flowing.clone() };
        assert!(asked != joystick(&flowing), "another driver");
        assert!(joystick(&flowing) != joystick(&reseeded), "another seed");
        // At rest at the start an IMU differs by its noise alone.
        let first_imu = |simulated: Simulated| {
            let seen = Seen::of(&Simulated { sensors: SensorSuite::Sonar, ..simulated });
            seen.samples.into_iter().find(|sample| matches!(sample, Sample::Imu(_)))
        };
        assert!(first_imu(flowing) != first_imu(reseeded), "another seed");
    }

    /// The plant that moves is its own; the controller goes by the scenario's.
    #[test]
    fn its_plant_moves_and_the_scenario_s_is_believed() {
        let claimed = session();
        assert_eq!(claimed.plant.actuator_delay_s, 0.0);
        let plant = Plant { actuator_delay_s: 0.3, ..claimed.plant };
        let unknown = Simulated { plant, ..claimed.clone() };
        let scenario = Scenario { plant, ..claimed.scenario.clone() };
        let told = Simulated { scenario, plant, ..claimed.clone() };
        let [claimed, unknown, told] = [&claimed, &unknown, &told].map(Seen::of);
        // Until it moves nothing differs: it moves that much later, on the grid of the truth, 0.02 s.
        let later_s = unknown.moves_at().seconds_since(claimed.moves_at());
        assert!((later_s - 0.3).abs() < 0.021, "{later_s}");
        // As text: what is not a number in one step is none in the other.
        let [unknown, told] = [unknown, told].map(|seen| format!("{:?}", seen.steps));
        assert!(unknown != told, "a controller that knows the delay reckons with it");
    }

    /// What its head claims is what it is: sensors, period, seed, and the scenario's plant whatever moves.
    #[test]
    fn a_session_is_what_its_head_says() {
        let scenario = simulator::scenario("random:rect:goal:3").expect("a random room");
        let spec = Spec::for_scenario("tandem-dynamic", &scenario, &[]).expect("a version");
        let slow = Plant { actuator_delay_s: 0.3, ..scenario.plant };
        let simulated = Simulated {
            plant: slow,
            sensors: SensorSuite::Exact,
            driver: Driver::Flowing,
            seed: 7,
            ..Simulated::of(spec, scenario.clone())
        };
        let (_, runner) = simulated.begin().expect("a sound session");
        let Header { run, params_toml, scenario: told } = simulated.header();
        assert_eq!((run.sensors.as_str(), run.driver.as_str(), run.seed), ("exact", "flowing", 7));
        assert_eq!(run.control_period_ns, runner.control_period().0);
        assert_eq!(
            (run.controller.as_str(), run.scenario),
            ("tandem-dynamic", scenario.name.clone())
        );
        assert_eq!((told, params_toml), (scenario, simulated.spec.params_toml()));
    }

    #[test]
    fn who_cannot_drive_is_refused() {
        let scenario = simulator::scenario("case3").expect("a case study");
        let spec = Spec::for_scenario("tandem-kinematic", &scenario, &[]).expect("a version");
        let of = Simulated::of(spec, scenario);
        assert!(of.begin().is_ok());
        let nobody = Simulated { driver: Driver::Goal, ..of };
        assert!(matches!(nobody.begin(), Err(BeginError::Simulation(_))), "it has no task");
    }
}
