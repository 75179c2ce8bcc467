//! Contract: distances follow from where sonars sit, what they heard and where the robot was then;
//! the unknown is never free; nothing panics.
//!
//! The mounts are those of the robot's sonar table: ids 3 and 4 look ahead from (0.245, ±0.027) along
//! ±10°, so a wall square to the heading at distance w from the centre gives both of them the range
//! w − 0.245 (their cones reach the heading, along which the wall is nearest).

mod hearing;
mod memory;
mod properties;

use schemas::{EncoderSample, SIMULATION_EPOCH};

use super::*;

/// Half the diagonal of the paper's 0.5 m × 0.5 m footprint.
const RADIUS_M: f64 = 0.353_553_390_593_273_8;

fn at(t_ms: u64) -> Time {
    SIMULATION_EPOCH.after_ns(t_ms * 1_000_000)
}

/// A robot in a test: its odometry and its map.
struct Rig {
    odometry: Odometry,
    map: EchoMap,
    t_ms: u64,
    left_m: f64,
    right_m: f64,
}

impl Rig {
    /// At rest at the origin at t = 0. Nothing moves in its world, so that only its own uncertainty
    /// counts.
    fn new() -> Rig {
        Rig::with(EchoMapSettings { inflation_m: RADIUS_M, v_disc_mps: 0.0, lease_s: 0.5 })
    }

    fn with(settings: EchoMapSettings) -> Rig {
        let mut rig = Rig {
            odometry: Odometry::new(Pose::default(), 0.5),
            map: EchoMap::new(settings),
            t_ms: 0,
            left_m: 0.0,
            right_m: 0.0,
        };
        rig.encoders();
        rig
    }

    fn encoders(&mut self) {
        self.odometry.encoders(&EncoderSample {
            stamp: at(self.t_ms),
            left_m: self.left_m,
            right_m: self.right_m,
            left_mps: f64::NAN,
            right_mps: f64::NAN,
        });
    }

    /// Lets time go by while the wheels roll evenly: forwards by `along_m`, turning by `turn_rad`.
    fn go(&mut self, ms: u64, along_m: f64, turn_rad: f64) {
        let steps = ms / 20;
        for _ in 0..steps {
            self.t_ms += 20;
            self.left_m += (along_m - 0.25 * turn_rad) / steps as f64;
            self.right_m += (along_m + 0.25 * turn_rad) / steps as f64;
            self.encoders();
        }
    }

    fn wait(&mut self, ms: u64) {
        self.go(ms, 0.0, 0.0);
    }

    /// One sonar says something now.
    fn say(&mut self, id: u8, range_m: f64, echo: bool) {
        let echo = SonarEcho { id, range_m, echo, fired: at(self.t_ms) };
        let scan = SonarScan { stamp: at(self.t_ms), echoes: vec![echo] };
        self.map.observe(&scan, &self.odometry);
    }

    /// All sonars fire at once: those listed hear an echo, the others nothing.
    fn sweep(&mut self, echoes: &[(u8, f64)]) {
        for id in 0..16 {
            match echoes.iter().find(|(heard, _)| *heard == id) {
                Some((_, range_m)) => self.say(id, *range_m, true),
                None => self.say(id, 5.0, false),
            }
        }
        self.advance();
    }

    /// Twice, 0.32 s apart, so that what is heard is confirmed.
    fn sweep_twice(&mut self, echoes: &[(u8, f64)]) {
        self.sweep(echoes);
        self.wait(320);
        self.sweep(echoes);
    }

    fn pose(&self) -> Pose {
        self.odometry.estimate().pose
    }

    fn advance(&mut self) {
        let about = self.pose();
        self.map.advance(at(self.t_ms), &self.odometry, &about);
    }

    /// The law's ray, degrees in the world.
    fn law(&mut self, deg: f64) -> f64 {
        self.advance();
        self.map.law_ray_m(&self.pose(), deg.to_radians())
    }

    /// The safety layer's ray, degrees in the world.
    fn safety(&mut self, deg: f64) -> f64 {
        self.advance();
        self.map.safety_ray_m(&self.pose(), deg.to_radians())
    }
}

/// Free travel from the origin along +x of the disc, to a point drawn nearer to the origin by `by_m`.
fn to_point_m([x, y]: [f64; 2], by_m: f64) -> f64 {
    let share = 1.0 - by_m / libm::hypot(x, y);
    x * share - libm::sqrt(RADIUS_M * RADIUS_M - y * y * share * share)
}
