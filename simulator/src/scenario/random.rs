//! Rooms, starts, tasks and drivers made from a number: specification §6, "Random rooms".
//!
//! `random:N` chooses kind and driver too; `random:KIND:DRIVER:N` has them chosen. The same name
//! always makes the same scenario. Coordinates are whole millimetres.

use core::f64::consts::PI;

use schemas::{
    Driver, EncoderNoise, Footprint, GoalDriver, HalfPlane, ImuNoise, JoystickNoise, MovingDisc,
    Noise, Obstacle, Overrides, Person, Plant, Pose, Robot, Scenario, SensorSuite, SonarNoise,
    Start, Task, World,
};

use crate::SimulatorError;
use crate::noise::{Purpose, Reading, Stream};

/// How long a random session lasts, seconds.
const DURATION_S: f64 = 15.0;

/// Clearance of the footprint at the start, at every heading, metres.
const START_CLEARANCE_M: f64 = 0.25;

/// How often a whole room is drawn anew because it has no place to start or to walk.
const ROOMS: u64 = 1000;

/// How often a place is drawn anew within one room.
const PLACES: u64 = 100;

/// The kind of a room.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Everything parallel to the axes.
    Rect,
    /// A convex polygon with rotated boxes and triangles.
    Slant,
    /// A rectangle with people walking to and fro.
    Disc,
}

const KINDS: [(&str, Kind); 3] =
    [("rect", Kind::Rect), ("slant", Kind::Slant), ("disc", Kind::Disc)];
const DRIVERS: [(&str, Driver); 6] = [
    ("goal", Driver::Goal),
    ("joystick", Driver::Joystick),
    ("hesitant", Driver::Hesitant),
    ("flowing", Driver::Flowing),
    ("explorer", Driver::Explorer),
    ("tracker", Driver::Tracker),
];

/// How many of them `random:N` chooses from: the first ones.
const CHOSEN_DRIVERS: u64 = 2;

/// The scenario of a name whose part after `random:` is `rest`.
pub(super) fn scenario(name: &str, rest: &str) -> Result<Scenario, SimulatorError> {
    let parts: Vec<&str> = rest.split(':').collect();
    let misfit =
        |part: &str| SimulatorError::RandomName { name: name.to_owned(), part: part.to_owned() };
    let number = |part: &str| part.parse::<u64>().map_err(|_| misfit(part));
    match parts.as_slice() {
        [n] => {
            let n = number(n)?;
            let choice = Stream::new(n, Purpose::Scenario).reading(0);
            let (_, kind) = KINDS[choice.pick(0, KINDS.len() as u64) as usize];
            let (_, driver) = DRIVERS[choice.pick(1, CHOSEN_DRIVERS) as usize];
            Ok(make(name, kind, driver, n))
        }
        [kind, driver, n] => {
            let (_, kind) =
                KINDS.into_iter().find(|(known, _)| known == kind).ok_or_else(|| misfit(kind))?;
            let (_, driver) = DRIVERS
                .into_iter()
                .find(|(known, _)| known == driver)
                .ok_or_else(|| misfit(driver))?;
            Ok(make(name, kind, driver, number(n)?))
        }
        _ => Err(misfit(rest)),
    }
}

fn make(name: &str, kind: Kind, driver: Driver, n: u64) -> Scenario {
    let stream = Stream::new(n, Purpose::Scenario);
    let (world, pose) = (1..=ROOMS)
        .find_map(|attempt| room(kind, &mut Dice::new(stream.reading(attempt))))
        .unwrap_or_else(|| {
            (World { room: rectangle(4.0, 4.0), ..World::default() }, Pose::default())
        });
    let mut dice = Dice::new(stream.reading(ROOMS + 1));
    let speed_mps = dice.between(0.1, 0.5);
    let (sin, cos) = libm::sincos(pose.theta_rad);
    let task = Task {
        from_m: pose.position_m(),
        velocity_mps: [speed_mps * cos, speed_mps * sin],
        until_s: DURATION_S,
    };
    let shape = match kind {
        Kind::Rect => "rectangular room",
        Kind::Slant => "slanted room",
        Kind::Disc => "rectangular room with people walking",
    };
    let errand = match driver {
        Driver::Goal => "following a target",
        Driver::Script | Driver::Joystick => "driving about freely",
        Driver::Hesitant => "a hesitant person with places to be",
        Driver::Flowing => "a person who flows around what is in the way",
        Driver::Explorer => "a person who wants to be nowhere in particular",
        Driver::Tracker => "following a target with a sluggish hand",
    };
    Scenario {
        name: name.to_owned(),
        summary: format!("Random {shape}, {errand}"),
        duration_s: DURATION_S,
        sensors: SensorSuite::Sonar,
        driver,
        start: Start { pose, v_mps: 0.0, omega_radps: 0.0 },
        task: matches!(driver, Driver::Goal | Driver::Tracker).then_some(task),
        robot: Robot::default(),
        plant: Plant { slip: 0.03, ..Plant::default() },
        noise: Noise {
            sonar: Some(SonarNoise::default()),
            imu: Some(ImuNoise::default()),
            encoders: Some(EncoderNoise::default()),
            joystick: Some(JoystickNoise { v_sigma_mps: 0.01, omega_sigma_radps: 0.02 }),
        },
        person: Person {
            goal: GoalDriver::default(),
            script: Vec::new(),
            // TOML's integers are signed.
            joystick_seed: stream.reading(ROOMS + 2).bits(0) >> 1,
        },
        controller: overrides(),
        world,
        explored: None,
    }
}

/// The switching distances that the specification's table of violations was made with (§9): those
/// of free driving, for tasks too.
fn overrides() -> Overrides {
    let table: toml::Table = [("b1_task_m", 1.0), ("b2_task_m", 1.3)]
        .map(|(key, value)| (key.to_owned(), value.into()))
        .into_iter()
        .collect();
    Overrides { kinematic: table.clone(), dynamic: table }
}

/// Successive draws of one reading.
struct Dice {
    reading: Reading,
    thrown: u64,
}

impl Dice {
    fn new(reading: Reading) -> Dice {
        Dice { reading, thrown: 0 }
    }

    fn next(&mut self) -> u64 {
        self.thrown += 1;
        self.thrown
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        let draw = self.next();
        self.reading.between(draw, low, high)
    }

    /// A length between two others, in whole millimetres.
    fn length_m(&mut self, low_m: f64, high_m: f64) -> f64 {
        millimetres(self.between(low_m, high_m))
    }

    fn pick(&mut self, count: u64) -> u64 {
        let draw = self.next();
        self.reading.pick(draw, count)
    }

    fn angle_rad(&mut self) -> f64 {
        self.between(-PI, PI)
    }
}

fn millimetres(metres: f64) -> f64 {
    libm::round(metres * 1000.0) / 1000.0
}

/// A room with its obstacles, people and start; `None` if there is no place for them.
fn room(kind: Kind, dice: &mut Dice) -> Option<(World, Pose)> {
    let (width_m, depth_m) = (dice.length_m(3.0, 6.0), dice.length_m(3.0, 6.0));
    let mut world = World {
        room: match kind {
            Kind::Rect | Kind::Disc => rectangle(width_m, depth_m),
            Kind::Slant => polygon(width_m, depth_m, dice),
        },
        ..World::default()
    };
    for _ in 0..dice.pick(4) {
        let centre_m = [
            dice.length_m(-0.5 * width_m, 0.5 * width_m),
            dice.length_m(-0.5 * depth_m, 0.5 * depth_m),
        ];
        world.obstacles.push(match kind {
            Kind::Rect | Kind::Disc => cuboid(centre_m, 0.0, dice),
            Kind::Slant => {
                let angle_rad = dice.angle_rad();
                if dice.pick(2) == 0 {
                    cuboid(centre_m, angle_rad, dice)
                } else {
                    triangle(centre_m, angle_rad, dice)
                }
            }
        });
    }
    if kind == Kind::Disc {
        for _ in 0..=dice.pick(2) {
            let walker = walker(&world, [width_m, depth_m], dice)?;
            world.discs.push(walker);
        }
    }
    let needs_m = Robot::default().footprint.circumscribed_radius_m() + START_CLEARANCE_M;
    let [x_m, y_m] = place(&world, [width_m, depth_m], needs_m, dice)?;
    Some((world, Pose { x_m, y_m, theta_rad: dice.angle_rad() }))
}

/// Four walls about the origin.
fn rectangle(width_m: f64, depth_m: f64) -> Vec<HalfPlane> {
    [([1.0, 0.0], width_m), ([-1.0, 0.0], width_m), ([0.0, 1.0], depth_m), ([0.0, -1.0], depth_m)]
        .map(|(normal, extent_m)| HalfPlane { normal, offset_m: 0.5 * extent_m })
        .to_vec()
}

/// Four to seven walls: corners on a circle, about evenly, stretched to the width and depth.
fn polygon(width_m: f64, depth_m: f64, dice: &mut Dice) -> Vec<HalfPlane> {
    let faces = 4 + dice.pick(4);
    let turned_rad = dice.angle_rad();
    let mut corners: Vec<[f64; 2]> = (0..faces)
        .map(|i| {
            let place = (i as f64 + dice.between(-0.25, 0.25)) / faces as f64;
            let (sin, cos) = libm::sincos(turned_rad + 2.0 * PI * place);
            [cos, sin]
        })
        .collect();
    for (axis, extent_m) in [width_m, depth_m].into_iter().enumerate() {
        let (low, high) = corners.iter().fold((1.0, -1.0), |(low, high), corner| {
            let at = corner[axis];
            (if at < low { at } else { low }, if at > high { at } else { high })
        });
        for corner in &mut corners {
            corner[axis] = ((corner[axis] - low) / (high - low) - 0.5) * extent_m;
        }
    }
    (0..corners.len())
        .map(|i| {
            let (from, to) = (corners[i], corners[(i + 1) % corners.len()]);
            let side = [to[0] - from[0], to[1] - from[1]];
            let length = libm::hypot(side[0], side[1]);
            let normal = [side[1] / length, -side[0] / length];
            HalfPlane { normal, offset_m: normal[0] * from[0] + normal[1] * from[1] }
        })
        .collect()
}

/// Corners about a centre, turned, in whole millimetres.
fn put(corners_m: &[[f64; 2]], centre_m: [f64; 2], angle_rad: f64) -> Obstacle {
    let (sin, cos) = libm::sincos(angle_rad);
    Obstacle {
        corners_m: corners_m
            .iter()
            .map(|[x, y]| {
                [
                    millimetres(centre_m[0] + x * cos - y * sin),
                    millimetres(centre_m[1] + x * sin + y * cos),
                ]
            })
            .collect(),
    }
}

fn cuboid(centre_m: [f64; 2], angle_rad: f64, dice: &mut Dice) -> Obstacle {
    let (a, b) = (0.5 * dice.between(0.3, 1.2), 0.5 * dice.between(0.3, 1.2));
    put(&[[-a, -b], [a, -b], [a, b], [-a, b]], centre_m, angle_rad)
}

/// A triangle inscribed in a circle, its sides of about the boxes' size.
fn triangle(centre_m: [f64; 2], angle_rad: f64, dice: &mut Dice) -> Obstacle {
    let radius_m = dice.between(0.3, 1.2) / libm::sqrt(3.0);
    let corners_m = [0.0, 1.0, 2.0].map(|third| {
        let place = (third + dice.between(-0.2, 0.2)) / 3.0;
        let (sin, cos) = libm::sincos(2.0 * PI * place);
        [radius_m * cos, radius_m * sin]
    });
    put(&corners_m, centre_m, angle_rad)
}

/// A point with some clearance all round.
fn place(world: &World, extent_m: [f64; 2], clearance_m: f64, dice: &mut Dice) -> Option<[f64; 2]> {
    (0..PLACES).find_map(|_| {
        let at_m = extent_m.map(|extent_m| dice.length_m(-0.5 * extent_m, 0.5 * extent_m));
        let pose = Pose { x_m: at_m[0], y_m: at_m[1], theta_rad: 0.0 };
        (world.clearance_m(&Footprint::POINT, &pose, 0.0) >= clearance_m).then_some(at_m)
    })
}

/// Someone who walks to and fro between two places, not through anything.
fn walker(world: &World, extent_m: [f64; 2], dice: &mut Dice) -> Option<MovingDisc> {
    let radius_m = dice.length_m(0.05, 0.3);
    let speed_mps = millimetres(dice.between(0.1, 0.3));
    (0..PLACES).find_map(|_| {
        let from_m = place(world, extent_m, radius_m, dice)?;
        let to_m = place(world, extent_m, radius_m, dice)?;
        let way_m = [to_m[0] - from_m[0], to_m[1] - from_m[1]];
        let angle_rad = libm::atan2(way_m[1], way_m[0]);
        let static_world = World {
            discs: Vec::new(),
            room: world.room.clone(),
            obstacles: world.obstacles.clone(),
            paths: Vec::new(),
        };
        let free_m = static_world.ray_m(from_m, angle_rad, radius_m, 0.0);
        let length_m = libm::hypot(way_m[0], way_m[1]);
        (length_m > 0.0 && free_m >= length_m).then_some(MovingDisc {
            radius_m,
            from_m,
            to_m,
            speed_mps,
            start_s: 0.0,
            to_and_fro: true,
        })
    })
}
