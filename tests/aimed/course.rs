//! Courses that drive the body at what perception and safety layer find hardest, because random rooms
//! hardly test them: convex corners, grazing, spinning and weaving beside walls, tight starts, doorways,
//! people who cross. Each ride is a whole session in one process: simulated person, sensors with their
//! faults, controller, plant.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use controller::{Session, Spec};
use recorder::Simulated;
use schemas::{
    Driver, EncoderNoise, Event, Footprint, HalfPlane, ImuNoise, MovingDisc, Noise, Obstacle,
    Plant, Pose, Robot, Scenario, SensorSuite, SonarNoise, Start, Stroke, World,
};

/// A ride: where, and with which noise.
pub(crate) struct Ride {
    pub(crate) scenario: Scenario,
    pub(crate) seed: u64,
}

/// What came of the rides of a course.
#[derive(Default)]
pub(crate) struct Tally {
    pub(crate) runs: usize,
    /// Rides that touched something, people apart.
    pub(crate) touched: usize,
    /// The deepest of them, metres.
    pub(crate) deepest_m: f64,
    /// Rides that came into contact with a person while moving towards them.
    pub(crate) ran_into: usize,
    /// The fastest that one of them moved towards the person as contact began, m/s.
    pub(crate) towards_mps: f64,
    /// Rides that ended more than 2.2 m ahead of their start.
    pub(crate) passed: usize,
}

/// What is put where.
struct Site {
    obstacles: Vec<Obstacle>,
    discs: Vec<MovingDisc>,
    start: Pose,
    strokes: Vec<Stroke>,
}

const BODY: Footprint = Footprint { length_m: 0.5, width_m: 0.5 };
const HALF_M: f64 = 0.25;

/// Standing still while the sonars go round, then a stroke.
fn then(v_mps: f64, omega_radps: f64, duration_s: f64) -> Vec<Stroke> {
    let still = Stroke { v_mps: 0.0, omega_radps: 0.0, duration_s: 0.5 };
    vec![still, Stroke { v_mps, omega_radps, duration_s }]
}

/// A room of 8 m × 8 m about the origin with the full sensor suite, slip and 0.1 s of actuator delay.
fn ride(site: Site, corner_echo: f64, seed: u64) -> Ride {
    let walls = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
    let scenario = Scenario {
        name: "aimed".to_owned(),
        summary: String::new(),
        duration_s: site.strokes.iter().map(|stroke| stroke.duration_s).sum(),
        sensors: SensorSuite::Sonar,
        driver: Driver::Script,
        start: Start { pose: site.start, v_mps: 0.0, omega_radps: 0.0 },
        task: None,
        robot: Robot { footprint: BODY, ..Robot::default() },
        plant: Plant { slip: 0.03, actuator_delay_s: 0.1, ..Plant::default() },
        noise: Noise {
            sonar: Some(SonarNoise { corner_echo, ..SonarNoise::default() }),
            imu: Some(ImuNoise::default()),
            encoders: Some(EncoderNoise::default()),
            joystick: None,
        },
        person: schemas::Person { script: site.strokes, ..schemas::Person::default() },
        controller: schemas::Overrides::default(),
        world: World {
            room: walls.map(|normal| HalfPlane { normal, offset_m: 4.0 }).to_vec(),
            obstacles: site.obstacles,
            discs: site.discs,
            paths: Vec::new(),
        },
        explored: None,
    };
    Ride { scenario, seed }
}

/// A box with its sides `turned_rad` from the axes.
fn cuboid(centre_m: [f64; 2], half_m: [f64; 2], turned_rad: f64) -> Obstacle {
    let (sin, cos) = turned_rad.sin_cos();
    let corner =
        |x: f64, y: f64| [centre_m[0] + x * cos - y * sin, centre_m[1] + x * sin + y * cos];
    let [a, b] = half_m;
    Obstacle { corners_m: vec![corner(-a, -b), corner(a, -b), corner(a, b), corner(-a, b)] }
}

/// A point of the body's front, `aside_m` from its middle, driven straight at a corner of a box, the
/// box turned by every angle at which that corner is met first.
pub(crate) fn corner(aside_m: &[f64], corner_echo: f64, seeds: u64) -> Vec<Ride> {
    let mut rides = Vec::new();
    for aside in aside_m {
        for turned_deg in (-40..=40).step_by(5) {
            for seed in 0..seeds {
                let v_mps = [0.3, 0.5, 0.7][(seed % 3) as usize];
                // The corner of the box that points at −x when the box is turned by 45°.
                let turned_rad = f64::from(45 + turned_deg).to_radians();
                let off_m = 0.5_f64.hypot(0.5);
                let tip_rad = turned_rad + 0.75 * std::f64::consts::PI;
                let centre_m = [1.0 - off_m * tip_rad.cos(), *aside - off_m * tip_rad.sin()];
                let obstacle = cuboid(centre_m, [0.5, 0.5], turned_rad);
                let site = Site {
                    obstacles: vec![obstacle],
                    discs: Vec::new(),
                    start: Pose { x_m: -0.6, y_m: 0.0, theta_rad: 0.0 },
                    strokes: then(v_mps, 0.0, 5.0),
                };
                rides.push(ride(site, corner_echo, seed));
            }
        }
    }
    rides
}

/// Along a wall, at it by up to 20°.
pub(crate) fn grazing(seeds: u64) -> Vec<Ride> {
    beside(seeds, |n| {
        let angle_rad = f64::from(n % 5).to_radians() * 5.0;
        (angle_rad, then([0.3, 0.5, 0.7][n as usize % 3], 0.0, 5.0))
    })
}

/// On the spot beside a wall, after a second of standing: what one sweep may miss is for the tight starts.
pub(crate) fn spinning(seeds: u64) -> Vec<Ride> {
    beside(seeds, |n| {
        let turn = if n % 2 == 0 { 1.5 } else { -1.5 };
        let still = Stroke { v_mps: 0.0, omega_radps: 0.0, duration_s: 0.5 };
        (0.0, [vec![still], then(0.0, turn, 5.0)].concat())
    })
}

/// To and fro beside a wall, turning.
pub(crate) fn weaving(seeds: u64) -> Vec<Ride> {
    beside(seeds, |n| {
        let mut strokes = then(0.4, 0.8, 0.7);
        for swing in 0..6 {
            let turn = if swing % 2 == 0 { -0.8 } else { 0.8 };
            let v_mps = if n % 2 == 0 || swing % 3 < 2 { 0.4 } else { -0.3 };
            strokes.push(Stroke { v_mps, omega_radps: turn, duration_s: 1.4 });
        }
        (0.0, strokes)
    })
}

/// The body's side at 3 to 30 cm from the wall at y = 4.
fn beside(seeds: u64, stroke: impl Fn(u32) -> (f64, Vec<Stroke>)) -> Vec<Ride> {
    let mut rides = Vec::new();
    for gap_cm in (3..=30).step_by(3) {
        for seed in 0..seeds {
            let gap_m = f64::from(gap_cm) / 100.0;
            let (angle_rad, strokes) = stroke(seed as u32);
            let reach_m = HALF_M * (angle_rad.sin().abs() + angle_rad.cos().abs());
            let start = Pose { x_m: -2.0, y_m: 4.0 - gap_m - reach_m, theta_rad: angle_rad };
            let site = Site { obstacles: Vec::new(), discs: Vec::new(), start, strokes };
            rides.push(ride(site, SonarNoise::default().corner_echo, seed));
        }
    }
    rides
}

/// Random rooms, started where the body has 1 to 8 cm, less than it can turn in.
pub(crate) fn tight(count: u64) -> Vec<Ride> {
    let mut rides = Vec::new();
    for n in 1..=count {
        for kind in ["rect", "slant"] {
            let name = format!("random:{kind}:joystick:{n}:actuator_delay_s=0.1");
            let mut scenario = simulator::scenario(&name).expect("a random room");
            let start = scenario.start.pose;
            // Straight on from the room's own start, in one of many directions, until it is tight.
            for turn in 0..32_u32 {
                let way_rad = f64::from(turn) * 0.7 + n as f64;
                let found = (1..600).find_map(|step| {
                    let far_m = f64::from(step) * 0.01;
                    let pose = Pose {
                        x_m: start.x_m + far_m * way_rad.cos(),
                        y_m: start.y_m + far_m * way_rad.sin(),
                        theta_rad: way_rad * 3.0,
                    };
                    let clearance_m = scenario.world.clearance_static_m(&BODY, &pose);
                    (clearance_m < 0.08).then_some((pose, clearance_m))
                });
                if let Some((pose, clearance_m)) = found
                    && clearance_m > 0.01
                {
                    scenario.start.pose = pose;
                    rides.push(Ride { scenario, seed: n });
                    break;
                }
            }
        }
    }
    rides
}

/// A doorway of 0.6 m, straight and askew, on and off the middle.
pub(crate) fn doorway(seeds: u64) -> Vec<Ride> {
    let mut rides = Vec::new();
    for off_cm in [-10, -5, 0, 5, 10] {
        for angle_deg in [-10, 0, 10] {
            for seed in 0..seeds {
                let gap_m = 0.3;
                let jamb = |side: f64| cuboid([1.0, side * (gap_m + 1.0)], [0.1, 1.0], 0.0);
                let angle_rad = f64::from(angle_deg).to_radians();
                let start = Pose {
                    x_m: -0.2,
                    y_m: f64::from(off_cm) / 100.0 - 1.2 * angle_rad.tan(),
                    theta_rad: angle_rad,
                };
                let site = Site {
                    obstacles: vec![jamb(1.0), jamb(-1.0)],
                    discs: Vec::new(),
                    start,
                    strokes: then(0.4, 0.0, 12.0),
                };
                rides.push(ride(site, SonarNoise::default().corner_echo, seed));
            }
        }
    }
    rides
}

/// Someone who walks across the way, so that both are there at about the same time.
pub(crate) fn crossing(seeds: u64) -> Vec<Ride> {
    let mut rides = Vec::new();
    for early_cm in (-60..=60).step_by(20) {
        for from in [-1.0, 1.0] {
            for seed in 0..seeds {
                let v_mps = [0.3, 0.5, 0.7][(seed % 3) as usize];
                let (speed_mps, ahead_m) = (0.3, 1.6);
                // They would meet at x = ahead_m, give or take.
                let meet_s = 0.5 + ahead_m / v_mps;
                let walked_m = speed_mps * meet_s + f64::from(early_cm) / 100.0;
                let walker = MovingDisc {
                    radius_m: 0.25,
                    from_m: [ahead_m, from * walked_m],
                    to_m: [ahead_m, -from * 3.0],
                    speed_mps,
                    start_s: 0.0,
                    to_and_fro: false,
                };
                let site = Site {
                    obstacles: Vec::new(),
                    discs: vec![walker],
                    start: Pose::default(),
                    strokes: then(v_mps, 0.0, 8.0),
                };
                rides.push(ride(site, SonarNoise::default().corner_echo, seed));
            }
        }
    }
    rides
}

/// The same rides with exact rays from the true pose.
pub(crate) fn with_exact_rays(mut rides: Vec<Ride>) -> Vec<Ride> {
    for ride in &mut rides {
        ride.scenario.sensors = SensorSuite::Exact;
    }
    rides
}

/// All rides of a course under a version of the controller, on two threads.
pub(crate) fn tally(rides: &[Ride], version: &str) -> Tally {
    let (next, all) = (AtomicUsize::new(0), Mutex::new(Tally::default()));
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some(ride) = rides.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let one = run(ride, version);
                    let mut all = all.lock().expect("no ride panics");
                    all.runs += 1;
                    all.touched += one.touched;
                    all.ran_into += one.ran_into;
                    all.towards_mps = all.towards_mps.max(one.towards_mps);
                    all.passed += one.passed;
                    all.deepest_m = all.deepest_m.max(one.deepest_m);
                }
            });
        }
    });
    all.into_inner().expect("no ride panics")
}

fn run(ride: &Ride, version: &str) -> Tally {
    let scenario = ride.scenario.clone();
    let start = scenario.start.pose;
    let spec = Spec::for_scenario(version, &scenario, &[]).expect("a version of the list");
    let simulated = Simulated { seed: ride.seed, ..Simulated::of(spec, scenario) };
    let (simulation, runner) = simulated.begin().expect("it makes sense");
    let mut session = Session::new(simulation, runner);
    let mut tally = Tally::default();
    let mut end = start;
    let mut apart = true;
    loop {
        let Ok(event) = session.next_event();
        let Some(event) = event else { break };
        let Event::Truth(truth) = event.value else { continue };
        if truth.clearance_static_m < 0.0 {
            tally.touched = 1;
            tally.deepest_m = tally.deepest_m.max(-truth.clearance_static_m);
        }
        end = truth.pose;
        let (sin, cos) = end.theta_rad.sin_cos();
        for disc in &truth.discs {
            let [dx, dy] = [disc.centre_m[0] - end.x_m, disc.centre_m[1] - end.y_m];
            let towards_mps = truth.v_mps * (dx * cos + dy * sin) / dx.hypot(dy);
            // Once they are in contact the person walks on, through the robot.
            if apart && truth.clearance_m < 0.0 && towards_mps > 1e-3 {
                tally.ran_into = 1;
                tally.towards_mps = tally.towards_mps.max(towards_mps);
            }
        }
        apart = truth.clearance_m >= 0.0;
    }
    let (sin, cos) = start.theta_rad.sin_cos();
    tally.passed = usize::from((end.x_m - start.x_m) * cos + (end.y_m - start.y_m) * sin > 2.2);
    tally
}
