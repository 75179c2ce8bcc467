//! Random rooms in one process: in how many the footprint leaves the static admissible set, how near it
//! comes, and what that costs the person. Much faster than recording logs, for trying things out:
//!
//!     cargo run --release --example rooms -- 1..300 tandem-kinematic sonar actuator_delay_s=0.1
//!
//! Arguments: rooms, controller (`NAME` or `NAME:key=value,…`), sensor suite, and keys of the plant.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use controller::{Runner, Session, Setup, Spec};
use schemas::{Event, SIMULATION_EPOCH, SensorSuite, Span};
use simulator::{Simulation, SimulationSetup};

const KINDS: [&str; 3] = ["rect", "slant", "disc"];
const DRIVERS: [&str; 2] = ["joystick", "goal"];

struct Run {
    room: String,
    /// Least static clearance, metres, and when it first fell below 0, seconds.
    least_m: f64,
    left_s: Option<f64>,
    human_share: f64,
    /// Share of steps in which the person asks to move and the robot stands.
    stuck: f64,
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [rooms, controller, suite, plant @ ..] = arguments.as_slice() else {
        eprintln!("usage: rooms FROM..TO CONTROLLER exact|sonar [PLANT]");
        return;
    };
    let (from, to) = rooms.split_once("..").expect("rooms are FROM..TO");
    let numbers = from.parse::<u64>().expect("a number")..=to.parse().expect("a number");
    let sensors = if suite == "exact" { SensorSuite::Exact } else { SensorSuite::Sonar };
    let plant = plant.first().map_or_else(String::new, |plant| format!(":{plant}"));
    let mut names = Vec::new();
    for kind in KINDS {
        for driver in DRIVERS {
            names.extend(numbers.clone().map(|n| format!("random:{kind}:{driver}:{n}{plant}")));
        }
    }
    let (next, runs) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some(name) = names.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let run = run(name, controller, sensors);
                    runs.lock().expect("no room panics").push(run);
                }
            });
        }
    });
    let mut runs = runs.into_inner().expect("no room panics");
    runs.sort_by(|a, b| a.room.cmp(&b.room));
    println!("| {controller}, {suite}{plant} | {} |", row(&runs));
    for run in &runs {
        if let Some(left_s) = run.left_s {
            println!("left {} at {left_s:.2} s, by {:.4} m", run.room, -run.least_m);
        }
    }
}

/// Rooms left of each cell; then per driver human share, share of time stuck, and least clearance.
fn row(runs: &[Run]) -> String {
    let of = |kind: &str, driver: &str| {
        let start = format!("random:{kind}:{driver}:");
        runs.iter().filter(move |run| run.room.starts_with(&start))
    };
    let mut cells = Vec::new();
    for kind in KINDS {
        let left = DRIVERS
            .map(|driver| of(kind, driver).filter(|run| run.left_s.is_some()).count().to_string());
        cells.push(left.join(" / "));
    }
    let over_kinds = |value: fn(&Run) -> f64| {
        DRIVERS.map(|driver| {
            let values: Vec<f64> =
                KINDS.iter().flat_map(|kind| of(kind, driver)).map(value).collect();
            format!("{:.3}", values.iter().sum::<f64>() / values.len() as f64)
        })
    };
    cells.push(over_kinds(|run| run.human_share).join(" / "));
    cells.push(over_kinds(|run| run.stuck).join(" / "));
    cells.push(format!("{:.3}", runs.iter().map(|run| run.least_m).fold(f64::INFINITY, f64::min)));
    cells.join(" | ")
}

fn overrides(settings: &str) -> toml::Table {
    let pairs = settings.split(',').filter_map(|setting| setting.split_once('='));
    let value = |text: &str| {
        text.parse::<f64>().map_or_else(|_| toml::Value::from(text), toml::Value::from)
    };
    pairs.map(|(key, text)| (key.to_owned(), value(text))).collect()
}

fn run(room: &str, controller: &str, sensors: SensorSuite) -> Run {
    let scenario = simulator::scenario(room).expect("a random room");
    let (name, settings) = controller.split_once(':').unwrap_or((controller, ""));
    let of_scenario = if name.ends_with("dynamic") {
        &scenario.controller.dynamic
    } else {
        &scenario.controller.kinematic
    };
    let spec = Spec::resolve(name, &[of_scenario, &overrides(settings)]).expect("a controller");
    let setup = Setup { spec, scenario: scenario.clone(), sensors, start: SIMULATION_EPOCH };
    let runner = Runner::new(&setup).expect("parameters and plant go together");
    let human = simulator::driver(&scenario, scenario.driver, 0).expect("rooms have a driver");
    let setup = SimulationSetup {
        sensors,
        seed: 0,
        start: SIMULATION_EPOCH,
        control_period: runner.control_period(),
        duration: Span::from_seconds(scenario.duration_s),
        scenario,
    };
    let simulation = Simulation::new(setup, human).expect("random rooms make sense");
    let mut session = Session::new(simulation, runner);
    let mut run = Run {
        room: room.to_owned(),
        least_m: f64::INFINITY,
        left_s: None,
        human_share: 0.0,
        stuck: 0.0,
    };
    let mut steps = 0.0;
    loop {
        let Ok(event) = session.next_event();
        let Some(event) = event else { break };
        match event.value {
            Event::Truth(truth) => {
                run.least_m = run.least_m.min(truth.clearance_static_m);
                if truth.clearance_static_m < 0.0 && run.left_s.is_none() {
                    run.left_s = Some(truth.stamp.seconds_since(SIMULATION_EPOCH));
                }
            }
            Event::Step(step) => {
                let scaled = |v_mps: f64, omega_radps: f64| (v_mps / 0.7).hypot(omega_radps / 2.0);
                let asked = scaled(step.v_h_mps, step.omega_h_radps) > 0.05;
                let stands = scaled(step.v_mps, step.omega_radps) <= 0.02;
                steps += 1.0;
                run.human_share += step.k;
                run.stuck += f64::from(u8::from(asked && stands));
            }
            _ => {}
        }
    }
    run.human_share /= steps;
    run.stuck /= steps;
    run
}
