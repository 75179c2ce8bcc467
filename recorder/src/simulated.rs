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
