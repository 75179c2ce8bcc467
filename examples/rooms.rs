//! Random rooms in one process: in how many the footprint leaves the static admissible set, how near it
//! comes, and what that costs the person.
//!
//!     cargo run --release --example rooms
//!
//! prints the tables of `docs/controller.md`, section 9: every version, with exact rays and with sonars,
//! 300 rooms of each kind for either driver. One row of it:
//!
//!     cargo run --release --example rooms -- 1..300 tandem-kinematic sonar actuator_delay_s=0.1
//!
//! Arguments: rooms (of the whole table, if nothing else is given), controller (`NAME` or
//! `NAME:key=value,…`), sensor suite, and keys of the plant. Runs that left the set are listed on standard
//! error.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use compare::Meter;
use controller::{Session, Spec};
use recorder::Simulated;
use schemas::{Event, SIMULATION_EPOCH, SensorSuite};

const KINDS: [&str; 3] = ["rect", "slant", "disc"];
const DRIVERS: [&str; 2] = ["joystick", "goal"];

/// Actuators that take their time, and besides as weak ones as the robot is sold with.
const DELAY: &str = "actuator_delay_s=0.1";
const SLOW: &str = "actuator_delay_s=0.1,limits_acceleration=true,accel_max_mps2=0.3";

/// The rows of the table: controller, sensors, plant.
const ROWS: [[&str; 3]; 15] = [
    ["human", "exact", ""],
    ["paper-kinematic", "exact", ""],
    ["tandem-kinematic", "exact", ""],
    ["tandem-kinematic", "exact", SLOW],
    ["paper-dynamic", "exact", ""],
    ["tandem-dynamic", "exact", ""],
    ["tandem-dynamic:control_period_s=0.1", "exact", ""],
    ["tandem-dynamic:control_period_s=0.1", "exact", SLOW],
    ["paper-kinematic", "sonar", DELAY],
    ["tandem-kinematic", "sonar", DELAY],
    ["tandem-kinematic", "sonar", SLOW],
    ["paper-dynamic", "sonar", DELAY],
    ["tandem-dynamic", "sonar", DELAY],
    ["tandem-dynamic:control_period_s=0.1", "sonar", DELAY],
    ["tandem-dynamic:control_period_s=0.1", "sonar", SLOW],
];

/// Columns of means over the three kinds of rooms: the metric (`tandem metrics` explains them), its
/// factor, its digits; per cent of the time for what is in seconds.
const MEANS: [(&str, f64, usize); 7] = [
    ("human_share", 1.0, 3),
    ("disagreement", 1.0, 2),
    ("deadlock_s", 100.0, 1),
    ("unwarranted", 100.0, 1),
    ("missed", 100.0, 1),
    ("switches_per_min", 1.0, 0),
    ("chatter_per_min", 1.0, 0),
];

struct Run {
    room: String,
    /// Least static clearance, metres, and when it first fell below 0, seconds.
    least_m: f64,
    left_s: Option<f64>,
    /// As in [`MEANS`]; `None` where it has no meaning for the run.
    means: [Option<f64>; MEANS.len()],
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let rooms = arguments.first().map_or("1..300", String::as_str);
    let (from, to) = rooms.split_once("..").expect("rooms are FROM..TO");
    let numbers = from.parse().expect("a number")..=to.parse().expect("a number");
    println!(
        "| version, sensors, plant | `rect` | `slant` | `disc` | human share | override | \
         stuck % | unwarranted % | missed % | switches 1/min | opposite within 0.5 s | least, m |"
    );
    println!("|{}", "---|".repeat(12));
    match &arguments.get(1..).unwrap_or_default() {
        [] => {
            for [controller, suite, plant] in ROWS {
                print_row(numbers.clone(), controller, suite, plant);
            }
        }
        [controller, suite] => print_row(numbers, controller, suite, ""),
        [controller, suite, plant] => print_row(numbers, controller, suite, plant),
        _ => eprintln!("usage: rooms [FROM..TO [CONTROLLER exact|sonar [PLANT]]]"),
    }
}

fn print_row(numbers: std::ops::RangeInclusive<u64>, controller: &str, suite: &str, plant: &str) {
    let sensors = if suite == "exact" { SensorSuite::Exact } else { SensorSuite::Sonar };
    let keys = if plant.is_empty() { String::new() } else { format!(":{plant}") };
    let mut names = Vec::new();
    for kind in KINDS {
        for driver in DRIVERS {
            names.extend(numbers.clone().map(|n| format!("random:{kind}:{driver}:{n}{keys}")));
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
    let suite = if suite == "exact" { "exact rays" } else { "sonars" };
    let plant = match plant {
        "" => String::new(),
        DELAY => ", delay".to_owned(),
        SLOW => ", slow".to_owned(),
        other => format!(", {other}"),
    };
    println!("| `{controller}`, {suite}{plant} | {} |", cells(&runs));
    for run in &runs {
        if let Some(left_s) = run.left_s {
            eprintln!("left {} at {left_s:.2} s, by {:.4} m", run.room, -run.least_m);
        }
    }
}

/// Rooms left of each cell, for either driver; then what it costs, and the least clearance.
fn cells(runs: &[Run]) -> String {
    let of = |kind: &str, driver: &str| {
        let start = format!("random:{kind}:{driver}:");
        runs.iter().filter(move |run| run.room.starts_with(&start))
    };
    let mut cells: Vec<String> = KINDS
        .iter()
        .map(|kind| {
            let left = |driver| of(kind, driver).filter(|run| run.left_s.is_some()).count();
            DRIVERS.map(|driver| left(driver).to_string()).join(" / ")
        })
        .collect();
    for (column, (_, factor, digits)) in MEANS.iter().enumerate() {
        // Runs without a value are left out.
        let mean = |driver| {
            let values: Vec<f64> = KINDS
                .iter()
                .flat_map(|kind| of(kind, driver))
                .filter_map(|run| run.means[column])
                .collect();
            if values.is_empty() {
                return "–".to_owned();
            }
            format!("{:.digits$}", factor * values.iter().sum::<f64>() / values.len() as f64)
        };
        cells.push(DRIVERS.map(mean).join(" / "));
    }
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
    let duration_s = scenario.duration_s;
    let spec = Spec::for_scenario(name, &scenario, &[&overrides(settings)]).expect("a controller");
    let simulated = Simulated { sensors, ..Simulated::of(spec, scenario) };
    let (simulation, runner) = simulated.begin().expect("parameters and room go together");
    let mut meter = Meter::new(&simulated.header());
    let mut session = Session::new(simulation, runner);
    let (mut least_m, mut left_s) = (f64::INFINITY, None);
    loop {
        let Ok(event) = session.next_event();
        let Some(event) = event else { break };
        meter.observe(&event);
        if let Event::Truth(truth) = event.value {
            least_m = least_m.min(truth.clearance_static_m);
            if truth.clearance_static_m < 0.0 && left_s.is_none() {
                left_s = Some(truth.stamp.seconds_since(SIMULATION_EPOCH));
            }
        }
    }
    let metrics = meter.finish().expect("a room has steps").metrics;
    let means = MEANS.map(|(name, _, _)| {
        let whole_s = if name.ends_with("_s") { duration_s } else { 1.0 };
        metrics.get(name).map(|value| value / whole_s)
    });
    Run { room: room.to_owned(), least_m, left_s, means }
}
