//! Contract: every scenario runs with every version of the controller and both suites of sensors:
//! the session comes to its end, each step follows the one before by the control period, what is
//! commanded is finite and within the plant's limits, k is 0 or 1, and where it is 1 the person's
//! request is applied bit for bit (P3).

use controller::{Law, Session, Spec, Version, versions};
use recorder::Simulated;
use schemas::{Event, SIMULATION_EPOCH, Scenario, SensorSuite, Span, Step};

const DURATION_S: f64 = 3.0;

/// Every built-in scenario by name, and one of each kind of random ones.
fn scenarios() -> Vec<Scenario> {
    let named = simulator::scenarios().into_iter().map(|(name, _)| name);
    let random = ["random:rect:goal:1", "random:slant:joystick:2", "random:disc:flowing:3"];
    let names = named.filter(|name| !name.starts_with("random:"));
    let names: Vec<String> = names.chain(random.map(str::to_owned)).collect();
    assert!(names.len() >= 8 + random.len(), "{names:?}");
    names.iter().map(|name| simulator::scenario(name).expect("listed")).collect()
}

/// The steps of a session's first seconds, and its control period.
fn steps(scenario: &Scenario, version: &Version, sensors: SensorSuite) -> (Vec<Step>, Span) {
    let spec = Spec::for_scenario(version.name, scenario, &[]).expect("a scenario's own overrides");
    let scenario = Scenario { duration_s: DURATION_S, ..scenario.clone() };
    let simulated = Simulated { sensors, ..Simulated::of(spec, scenario) };
    let (simulation, runner) = simulated.begin().expect("a scenario and a version");
    let period = runner.control_period();
    let mut session = Session::new(simulation, runner);
    let mut steps = Vec::new();
    loop {
        let Ok(event) = session.next_event();
        match event.map(|event| event.value) {
            Some(Event::Step(step)) => steps.push(*step),
            Some(_) => {}
            None => return (steps, period),
        }
    }
}

/// What the plant takes of each input.
fn limits(scenario: &Scenario, law: Law) -> [f64; 2] {
    let plant = &scenario.plant;
    match law {
        Law::Kinematic | Law::Human => [plant.v_max_mps, plant.omega_max_radps],
        Law::Dynamic => [plant.accel_max_mps2, plant.alpha_max_radps2],
    }
}

#[test]
fn every_version_drives_in_every_scenario() {
    for scenario in scenarios() {
        for version in versions() {
            for sensors in [SensorSuite::Exact, SensorSuite::Sonar] {
                let name = format!("{} in {} with {sensors:?}", version.name, scenario.name);
                let (steps, period) = steps(&scenario, version, sensors);
                let expected = (DURATION_S * 1e9 / period.0 as f64).round() as usize;
                assert!(steps.len().abs_diff(expected) <= 1, "{name}: {} steps", steps.len());
                for pair in steps.windows(2) {
                    assert_eq!(pair[1].stamp.0 - pair[0].stamp.0, period.0, "{name}");
                }
                for step in &steps {
                    let at_s = step.stamp.seconds_since(SIMULATION_EPOCH);
                    assert!(step.k == 0.0 || step.k == 1.0, "{name}: k = {} at {at_s} s", step.k);
                    for (u, limit) in step.u_s.into_iter().zip(limits(&scenario, version.law)) {
                        assert!(u.abs() <= limit, "{name}: {u} is beyond {limit} at {at_s} s");
                    }
                    if step.k == 1.0 {
                        let bits = |u: [f64; 2]| u.map(f64::to_bits);
                        assert_eq!(bits(step.u_s), bits(step.u_h), "{name}: P3 at {at_s} s");
                    }
                }
            }
        }
    }
}
