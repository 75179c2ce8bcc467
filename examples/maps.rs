//! How good are maps made from noisy logs? Sessions are recorded in random rooms, mapped from what their
//! sonars heard and where they believed to be, and held against the rooms:
//!
//!     cargo run --release --example maps -- 1001..1010
//!
//! Prints the table of `docs/mapping.md`.

use std::io::Cursor;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use controller::{Session, Spec};
use recorder::Simulated;
use replay::{Map, PlantEstimate};
use schemas::log::{LogReader, LogWriter, WriterOptions};
use schemas::{Cell, Event, Footprint, Pose, Scenario, SensorSuite, World};

const KINDS: [&str; 3] = ["rect", "slant", "disc"];
const DRIVERS: [&str; 4] = ["joystick", "explorer", "flowing", "tracker"];
const DURATION_S: f64 = 30.0;

/// What is counted over sessions.
#[derive(Clone, Default)]
struct Score {
    sessions: u32,
    wall_points: u32,
    near: u32,
    free: u32,
    wrong: u32,
    /// Greatest share of wrong free cells, and least of near wall points, in one session.
    most_wrong: f64,
    least_near: Option<f64>,
    /// Cells of the room's floor, and those of them that are known to be free.
    floor: u32,
    known: u32,
    discs: usize,
    walkers: usize,
    /// How far walkers are from the nearest disc, metres.
    off_m: Vec<f64>,
}

fn main() {
    let argument = std::env::args().nth(1).unwrap_or_else(|| "1001..1010".to_owned());
    let Some((from, to)) = argument.split_once("..") else {
        eprintln!("usage: maps FROM..TO");
        return;
    };
    let numbers = from.parse::<u64>().expect("a number")..=to.parse().expect("a number");
    let mut names = Vec::new();
    for kind in KINDS {
        for driver in DRIVERS {
            names.extend(numbers.clone().map(|n| format!("random:{kind}:{driver}:{n}")));
        }
    }
    let (next, scores) = (AtomicUsize::new(0), Mutex::new(vec![Score::default(); KINDS.len()]));
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some(name) = names.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let score = score(name);
                    let kind = KINDS.iter().position(|kind| name.contains(kind)).unwrap_or(0);
                    scores.lock().expect("no session panics")[kind].add(score);
                }
            });
        }
    });
    println!(
        "| rooms | sessions | wall within 0.1 m (least) | free, but taken (most) | floor known | walkers \
         followed / there | off, median (90 %) |"
    );
    println!("|---|---|---|---|---|---|---|");
    for (kind, mut score) in KINDS.iter().zip(scores.into_inner().expect("no session panics")) {
        println!("| {kind} | {} |", score.row());
    }
}

impl Score {
    fn add(&mut self, other: Score) {
        self.sessions += other.sessions;
        self.wall_points += other.wall_points;
        self.near += other.near;
        self.free += other.free;
        self.wrong += other.wrong;
        self.most_wrong = self.most_wrong.max(other.most_wrong);
        self.least_near = match (self.least_near, other.least_near) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
        self.floor += other.floor;
        self.known += other.known;
        self.discs += other.discs;
        self.walkers += other.walkers;
        self.off_m.extend(other.off_m);
    }

    fn row(&mut self) -> String {
        let percent = |part: u32, whole: u32| 100.0 * f64::from(part) / f64::from(whole.max(1));
        self.off_m.sort_by(f64::total_cmp);
        let off = |share: f64| {
            let index = (share * self.off_m.len() as f64) as usize;
            let off_m = self.off_m.get(index).filter(|off_m| off_m.is_finite());
            off_m.map_or_else(|| "–".to_owned(), |off_m| format!("{off_m:.2} m"))
        };
        format!(
            "{} | {:.1} % ({:.0} %) | {:.2} % ({:.1} %) | {:.0} % | {} / {} | {} ({})",
            self.sessions,
            percent(self.near, self.wall_points),
            100.0 * self.least_near.unwrap_or(0.0),
            percent(self.wrong, self.free),
            100.0 * self.most_wrong,
            percent(self.known, self.floor),
            self.walkers,
            self.discs,
            off(0.5),
            off(0.9),
        )
    }
}

/// One session, recorded, mapped, and held against its room.
fn score(name: &str) -> Score {
    let scenario = simulator::scenario(name).expect("a random scenario");
    let scenario = Scenario { duration_s: DURATION_S, ..scenario };
    let bytes = record(&scenario);
    let open = || LogReader::new(Cursor::new(bytes.as_slice())).expect("just written");
    let map = Map::of_log(open(), &PlantEstimate::of_log(open())).expect("has echoes");
    let still = World { discs: Vec::new(), ..scenario.world.clone() };
    let clearance_m = |[x_m, y_m]: [f64; 2]| {
        still.clearance_m(&Footprint::POINT, &Pose { x_m, y_m, theta_rad: 0.0 }, 0.0)
    };
    let mut score = Score { sessions: 1, ..Score::default() };
    for [from, to] in map.faces_m() {
        let steps = ((to[0] - from[0]).hypot(to[1] - from[1]) / 0.05).ceil().max(1.0) as u32;
        for step in 0..=steps {
            let share = f64::from(step) / f64::from(steps);
            let at_m = [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis]));
            score.wall_points += 1;
            score.near += u32::from(clearance_m(at_m).abs() <= 0.1);
        }
    }
    for (at_m, cell) in map.explored().cells() {
        score.free += u32::from(cell == Cell::Free);
        score.wrong += u32::from(cell == Cell::Free && clearance_m(at_m) <= 0.0);
    }
    // The whole room's floor, not only what lies within the map.
    for i in -70..70 {
        for j in -70..70 {
            let at_m = [f64::from(i) * 0.05 + 0.025, f64::from(j) * 0.05 + 0.025];
            if clearance_m(at_m) > 0.0 {
                score.floor += 1;
                score.known += u32::from(map.explored().at(at_m) == Cell::Free);
            }
        }
    }
    score.most_wrong = f64::from(score.wrong) / f64::from(score.free.max(1));
    score.least_near = Some(f64::from(score.near) / f64::from(score.wall_points.max(1)));
    score.discs = scenario.world.discs.len();
    score.walkers = map.world().paths.len();
    for [t_s, x, y] in map.world().paths.iter().flat_map(|path| &path.points) {
        let away = scenario
            .world
            .discs_at(*t_s)
            .map(|disc| (disc.centre_m[0] - x).hypot(disc.centre_m[1] - y));
        score.off_m.push(away.fold(f64::INFINITY, f64::min));
    }
    score
}

fn record(scenario: &Scenario) -> Vec<u8> {
    let spec = Spec::for_scenario("tandem-kinematic", scenario, &[]).expect("a known version");
    let of = Simulated::of(spec, scenario.clone());
    let simulated = Simulated { sensors: SensorSuite::Sonar, seed: 5, ..of };
    let (simulation, runner) = simulated.begin().expect("a sound session");
    let header = simulated.header();
    let mut session = Session::new(simulation, runner);
    let options = WriterOptions { view: false, ..WriterOptions::offline() };
    let mut log = LogWriter::new(Vec::new(), &header, &options).expect("memory takes it");
    loop {
        let Ok(event) = session.next_event();
        let Some(event) = event else { break };
        // A map must not know the truth.
        if !matches!(event.value, Event::Truth(_)) {
            log.write(&event).expect("memory takes it");
        }
    }
    log.finish().expect("memory takes it").0
}
