//! What a step of the controller costs, as multiples of the bare law in the same run.
//!
//!     cargo bench --bench step_cost
//!
//! Records sessions in random rooms in memory, then shows their samples to a controller and steps
//! it at the recorded instants, nothing else. "Bare law" is the feedback law alone with its
//! reference, on the distances that the steps of those sessions had. Every row is measured in every
//! round, in turn; printed is the median over the rounds, of CPU time.

use std::hint::black_box;

use controller::plan::{Past, Scene, plan};
use controller::{Law, Runner, Setup, Spec};
use rustix::time::{ClockId, clock_gettime};
use schemas::{Pulled, SIMULATION_EPOCH, Sample, SensorSuite, Source, Span, Step, Time};
use simulator::{Simulation, SimulationSetup};

const ROUNDS: usize = 25;
const ROOMS: u64 = 12;
const LAWS: [&str; 2] = ["tandem-kinematic", "tandem-dynamic"];

/// What a controller was shown, in order.
enum Shown {
    Sample(Box<Sample>),
    StepAt(Time),
}

struct Recording {
    setup: Setup,
    shown: Vec<Shown>,
    steps: Vec<Step>,
}

fn record(version: &str, sensors: SensorSuite, number: u64) -> Recording {
    let kind = ["rect", "slant", "disc"][number as usize % 3];
    let driver = ["goal", "joystick"][number as usize % 2];
    let scenario = simulator::scenario(&format!("random:{kind}:{driver}:{number}")).unwrap();
    let overrides = "control_period_s = 0.1".parse().expect("TOML");
    let spec = Spec::resolve(version, &[&overrides]).unwrap();
    let setup = Setup { spec, scenario: scenario.clone(), sensors, start: SIMULATION_EPOCH };
    let mut runner = Runner::new(&setup).unwrap();
    let human = simulator::driver(&scenario, scenario.driver, 0).unwrap();
    let simulation = SimulationSetup {
        sensors,
        seed: 0,
        start: SIMULATION_EPOCH,
        control_period: runner.control_period(),
        duration: Span::from_seconds(scenario.duration_s),
        scenario,
    };
    let mut simulation = Simulation::new(simulation, human).unwrap();
    let (mut shown, mut steps) = (Vec::new(), Vec::new());
    while let Ok(Some(pulled)) = simulation.pull() {
        match pulled {
            Pulled::Event(event) => {
                if let schemas::Event::Sample(mut sample) = event.value {
                    sample.make_canonical();
                    runner.observe(&sample);
                    shown.push(Shown::Sample(Box::new(sample)));
                }
            }
            Pulled::StepDue { now, .. } => {
                let outcome = runner.step(now);
                simulation.actuate(&outcome.command);
                steps.push(outcome.step);
                shown.push(Shown::StepAt(now));
            }
        }
    }
    Recording { setup, shown, steps }
}

fn cpu_ns() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 * 1e9 + time.tv_nsec as f64
}

/// CPU time of `work`, in nanoseconds for each of `steps`.
fn per_step_ns(steps: usize, work: impl FnOnce()) -> f64 {
    let from_ns = cpu_ns();
    work();
    (cpu_ns() - from_ns) / steps as f64
}

fn bare_law_ns(recordings: &[Recording]) -> f64 {
    // A step's law is repeated: a single one is too short beside reading the clock.
    const REPEATED: usize = 20;
    let steps: usize = recordings.iter().map(|recording| recording.steps.len()).sum();
    per_step_ns(steps * REPEATED, || {
        for Recording { setup, steps, .. } in recordings {
            for _ in 0..REPEATED {
                let mut past = Past::default();
                for step in steps {
                    let scene = Scene {
                        d1_m: step.d1_m,
                        d2l_m: step.d2l_m,
                        d2r_m: step.d2r_m,
                        delta_m: [step.delta1_m, step.delta2_m],
                        q_mps: [step.q1_mps, step.q2_mps],
                        theta_e_rad: step.theta_e_rad,
                        omega_r_radps: step.omega_r_radps,
                        jumped: false,
                        v_mps: step.v_mps,
                        omega_radps: step.omega_radps,
                    };
                    let plan = plan(setup.spec.law, &setup.spec.params, &scene, &past);
                    past = black_box(&plan).past();
                }
            }
        }
    })
}

fn whole_step_ns(recordings: &[Recording]) -> f64 {
    let mut runners: Vec<Runner> =
        recordings.iter().map(|recording| Runner::new(&recording.setup).unwrap()).collect();
    let steps: usize = recordings.iter().map(|recording| recording.steps.len()).sum();
    per_step_ns(steps, || {
        for (runner, recording) in runners.iter_mut().zip(recordings) {
            for shown in &recording.shown {
                match shown {
                    Shown::Sample(sample) => runner.observe(sample),
                    Shown::StepAt(now) => {
                        black_box(runner.step(*now));
                    }
                }
            }
        }
    })
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    println!("| law | step | × bare law | µs here |\n|---|---|---|---|");
    for version in LAWS {
        let [exact, sonar] = [SensorSuite::Exact, SensorSuite::Sonar]
            .map(|suite| (1..=ROOMS).map(|n| record(version, suite, n)).collect::<Vec<_>>());
        assert!(exact.iter().all(|recording| recording.setup.spec.law != Law::Human));
        let mut rows = [Vec::new(), Vec::new(), Vec::new()];
        for _ in 0..ROUNDS {
            rows[0].push(bare_law_ns(&exact));
            rows[1].push(whole_step_ns(&exact));
            rows[2].push(whole_step_ns(&sonar));
        }
        let medians = rows.map(median);
        let names = ["bare law", "with exact rays", "with full perception, estimation included"];
        for (name, ns) in names.into_iter().zip(medians) {
            println!("| `{version}` | {name} | {:.0} | {:.2} |", ns / medians[0], ns / 1e3);
        }
    }
}
