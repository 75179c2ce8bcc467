//! S2 and S3 with the body swept as a rectangle.
//!
//! An input is harmless if the motion that the plant makes of it for a period, and of braking to rest
//! after that, keeps the footprint clear of everything near, or brings it no nearer to what it is too
//! near to already. What is not harmless becomes the nearest harmless one of some lesser inputs, and
//! the stop where none is. The stop is what every harmless input was tried with: so, in a world that
//! stands still and with a plant that does as foreseen, there always is a way out (specification §9).

use schemas::Plant;

use super::motion::{Drive, Moving};
use super::near::{Keep, Near};

/// Distances are compared with this slack, metres, so that rounding forbids no way along a wall.
const HAIR_M: f64 = 1e-7;

/// Places along a motion are no nearer to each other than this, metres of the farthest body point;
/// between two of them nothing comes nearer by more than half of it.
const LEAST_STEP_M: f64 = 0.004;

/// Share of the doubt about where a thing is that is given up in a second, 1/s, by a body that is too near
/// to it only because of that doubt. Chosen: 0 costs 3 % of the human share with sonars (specification
/// §9); each period looks again, and what it hears is in less doubt.
const DOUBT_GIVEN_UP_PER_S: f64 = 2.0;

/// A motion that takes more places to look at than this, or longer than so many seconds, is none that
/// a robot within its limits makes: it counts as harmful. With 4 mm between places and the default
/// plant the longest there is has under 200.
const MOST_PLACES: u32 = 500;
const LONGEST_S: f64 = 20.0;

/// Shares of v and of ω that are tried, in this order, in place of an input: (0, 0) is the stop and
/// comes last. Turning is given up after driving: it is what leads away.
const SHARES: [[f64; 2]; 21] = [
    [0.9, 1.0],
    [0.75, 1.0],
    [0.5, 1.0],
    [0.25, 1.0],
    [0.1, 1.0],
    [0.0, 1.0],
    [0.9, 0.9],
    [0.75, 0.75],
    [1.0, 0.75],
    [0.75, 0.5],
    [0.5, 0.5],
    [1.0, 0.5],
    [0.0, 0.5],
    [0.25, 0.25],
    [1.0, 0.0],
    [0.75, 0.0],
    [0.5, 0.0],
    [0.25, 0.0],
    [0.1, 0.1],
    [0.1, 0.0],
    [0.0, 0.2],
];

/// The safety layer of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweep {
    /// The plant.
    pub plant: Plant,
    /// Whether inputs are accelerations.
    pub accelerations: bool,
    /// Control period Ts, seconds.
    pub period_s: f64,
    /// Distance to be kept free, metres.
    pub guard_m: f64,
    /// How long ago, seconds, the surroundings were as they are known when the input takes effect.
    pub later_s: f64,
    /// Speeds when the input takes effect, [m/s, rad/s].
    pub speeds: [f64; 2],
    /// Fastest turn rate that is allowed, rad/s, beside what the plant can do.
    pub turn_most_radps: f64,
}

/// How far a motion has been followed.
struct Trip {
    /// Seconds since the surroundings were as they are known.
    later_s: f64,
    /// How many places were looked at.
    places: u32,
}

impl Sweep {
    /// From how far away a thing can matter before the robot rests, metres beyond its turning circle,
    /// and how long after the surroundings were as they are known that can be, seconds, whatever the
    /// input.
    pub fn reach(&self) -> (f64, f64) {
        let v_mps = self.plant.v_max_mps.max(libm::fabs(self.speeds[0]));
        let kept_m = self.guard_m + LEAST_STEP_M;
        let (accel_mps2, alpha_radps2) = (self.plant.accel_max_mps2, self.plant.alpha_max_radps2);
        if !self.accelerations && !self.plant.limits_acceleration {
            return (v_mps * self.period_s + kept_m, self.later_s + self.period_s);
        }
        let omega_radps = self.plant.omega_max_radps.max(libm::fabs(self.speeds[1]));
        // The input's period, and less than one more in which a stop of accelerations ends.
        let periods_s = 2.0 * self.period_s;
        let braking_s = v_mps / accel_mps2;
        let rest_s = braking_s.max(omega_radps / alpha_radps2);
        let travel_m = v_mps * (periods_s + 0.5 * braking_s);
        (travel_m + kept_m, self.later_s + periods_s + rest_s)
    }

    /// The input that stops from `speeds`.
    pub fn stop(&self, speeds: [f64; 2]) -> [f64; 2] {
        if !self.accelerations {
            return [0.0; 2];
        }
        let braked = |speed: f64, most: f64| (-speed / self.period_s).clamp(-most, most);
        [
            braked(speeds[0], self.plant.accel_max_mps2),
            braked(speeds[1], self.plant.alpha_max_radps2),
        ]
    }

    fn drive(&self, u: [f64; 2]) -> Drive {
        if self.accelerations { Drive::Accelerations(u) } else { Drive::Velocities(u) }
    }

    /// Whether `u` for a period and braking after it is harmless.
    pub fn allows(&self, u: [f64; 2], near: &Near) -> bool {
        let mut robot = Moving { pose: *near.pose(), speeds: self.speeds };
        let mut trip = Trip { later_s: self.later_s, places: 0 };
        let drive = self.drive(u);
        robot.speeds = drive.taken_up(&self.plant, robot.speeds);
        let [v_end_mps, omega_end_radps] = robot.speeds_after(&self.plant, drive, self.period_s);
        if !near.knows_the_way(v_end_mps) || !self.turns_slowly(omega_end_radps) {
            return false;
        }
        if !self.clear_along(&mut robot, drive, self.period_s, &mut trip, near) {
            return false;
        }
        self.comes_to_rest(&mut robot, &mut trip, near)
    }

    /// Whether the robot turns no faster than it is to, or at least less fast than it does.
    fn turns_slowly(&self, end_radps: f64) -> bool {
        let gradual = self.accelerations || self.plant.limits_acceleration;
        let end_radps = libm::fabs(end_radps);
        end_radps <= self.turn_most_radps || (gradual && end_radps < libm::fabs(self.speeds[1]))
    }

    /// Whether braking from here is harmless.
    fn comes_to_rest(&self, robot: &mut Moving, trip: &mut Trip, near: &Near) -> bool {
        if !self.accelerations {
            let drive = Drive::Velocities([0.0; 2]);
            robot.speeds = drive.taken_up(&self.plant, robot.speeds);
            let lasts_s = (libm::fabs(robot.speeds[0]) / self.plant.accel_max_mps2)
                .max(libm::fabs(robot.speeds[1]) / self.plant.alpha_max_radps2);
            return self.clear_along(robot, drive, lasts_s, trip, near);
        }
        let most = [self.plant.accel_max_mps2, self.plant.alpha_max_radps2];
        // Each leg ends the full braking of one speed, or brings one to rest: four, and two for what rounding leaves.
        for _ in 0..6 {
            if robot.speeds == [0.0; 2] {
                break;
            }
            let u = self.stop(robot.speeds);
            // As many whole periods as the stop stays what it is.
            let mut periods = f64::INFINITY;
            for (speed, most) in robot.speeds.iter().zip(most) {
                if *speed != 0.0 {
                    let full = libm::fabs(*speed) / (most * self.period_s);
                    periods = periods.min(libm::floor(full).max(1.0));
                }
            }
            let drive = Drive::Accelerations(u);
            let speeds = robot.speeds;
            if !self.clear_along(robot, drive, periods * self.period_s, trip, near) {
                return false;
            }
            for axis in 0..2 {
                // What less than a period's braking was left of is gone, whatever rounding says.
                if libm::fabs(speeds[axis]) <= most[axis] * self.period_s {
                    robot.speeds[axis] = 0.0;
                }
            }
        }
        robot.speeds == [0.0; 2]
    }

    /// What is kept at the places that are looked at, so that the guard is kept between them too.
    fn keep(&self, later_s: f64, robot: &Moving) -> Keep {
        let guard_m = self.guard_m + 0.5 * LEAST_STEP_M;
        let doubt_share = (DOUBT_GIVEN_UP_PER_S * self.period_s).min(1.0);
        Keep { guard_m, later_s, doubt_share, v_mps: robot.speeds[0] }
    }

    /// Moves `robot` along, and says whether it stays clear.
    fn clear_along(
        &self,
        robot: &mut Moving,
        drive: Drive,
        lasts_s: f64,
        trip: &mut Trip,
        near: &Near,
    ) -> bool {
        // Written so that NaN fails.
        let short = lasts_s <= LONGEST_S;
        if !short {
            return false;
        }
        let mut left_s = lasts_s;
        let ends = robot.speeds_after(&self.plant, drive, lasts_s);
        let fastest = |axis: usize, robot: &Moving| {
            libm::fabs(ends[axis]).max(libm::fabs(robot.speeds[axis]))
        };
        while left_s > 0.0 {
            let keep = self.keep(trip.later_s, robot);
            let slack_m = near.slack_m(&robot.pose, &keep);
            if slack_m.is_nan() || slack_m < -HAIR_M || trip.places >= MOST_PLACES {
                return false;
            }
            let rate_mps = fastest(0, robot) + near.circle_m() * fastest(1, robot);
            let step_s = if rate_mps > 0.0 {
                (slack_m.max(LEAST_STEP_M) / rate_mps).min(left_s)
            } else {
                left_s
            };
            robot.advance(&self.plant, drive, step_s);
            trip.later_s += step_s;
            trip.places += 1;
            left_s -= step_s;
        }
        let keep = self.keep(trip.later_s, robot);
        near.slack_m(&robot.pose, &keep) >= -HAIR_M
    }

    /// `u`, bit for bit, where it is harmless; otherwise the first harmless one of some inputs between
    /// it and the stop, and the stop where none is.
    pub fn project(&self, u: [f64; 2], near: &Near) -> [f64; 2] {
        if self.allows(u, near) {
            return u;
        }
        let stop = self.stop(self.speeds);
        SHARES
            .iter()
            .map(|[of_v, of_omega]| {
                [stop[0] + of_v * (u[0] - stop[0]), stop[1] + of_omega * (u[1] - stop[1])]
            })
            .find(|lesser| *lesser != u && self.allows(*lesser, near))
            .unwrap_or(stop)
    }
}
