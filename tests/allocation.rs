//! Contract: once it stands, a controller takes no memory: neither `Runner::observe` nor
//! `Runner::step` allocates, with exact rays or with sonars, whichever version drives.

use controller::{Runner, Setup, Spec, versions};
use schemas::{Event, Pulled, SIMULATION_EPOCH, SensorSuite, Source, Span};
use simulator::{Simulation, SimulationSetup};

/// How often `work` asked for memory.
fn allocations(work: impl FnOnce()) -> u64 {
    allocation_counter::measure(work).count_total
}

#[test]
fn the_counter_counts() {
    let mut kept = Vec::new();
    assert_eq!(allocations(|| kept.push(1_u64)), 1);
}

#[test]
fn a_standing_controller_takes_no_memory() {
    for version in versions() {
        for sensors in [SensorSuite::Exact, SensorSuite::Sonar] {
            let scenario = simulator::scenario("random:disc:goal:5").unwrap();
            let spec = Spec::resolve(version.name, &[]).unwrap();
            let setup =
                Setup { spec, scenario: scenario.clone(), sensors, start: SIMULATION_EPOCH };
            let mut runner = Runner::new(&setup).unwrap();
            let human = simulator::driver(&scenario, scenario.driver, 0).unwrap();
            let simulation = SimulationSetup {
                sensors,
                duration: Span::from_seconds(15.0),
                ..SimulationSetup::of(scenario, runner.control_period())
            };
            let mut simulation = Simulation::new(simulation, human).unwrap();
            let (mut samples, mut steps) = (0, 0);
            while let Ok(Some(pulled)) = simulation.pull() {
                match pulled {
                    Pulled::Event(event) => {
                        let Event::Sample(sample) = &event.value else { continue };
                        let taken = allocations(|| runner.observe(sample));
                        assert_eq!(taken, 0, "{} observes {sample:?}", version.name);
                        samples += 1;
                    }
                    Pulled::StepDue { now, .. } => {
                        let mut outcome = None;
                        let taken = allocations(|| outcome = Some(runner.step(now)));
                        assert_eq!(taken, 0, "{}, {sensors:?}, step {steps}", version.name);
                        simulation.actuate(&outcome.expect("just set").command);
                        steps += 1;
                    }
                }
            }
            assert!(steps > 100 && samples > 100, "{steps} steps, {samples} samples");
        }
    }
}
