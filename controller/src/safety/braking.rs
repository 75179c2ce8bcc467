//! S3: the projection of the dynamic model.
//!
//! The robot may be as fast at the end of a period as lets it brake to rest before the nearest thing
//! in the cone of headings it can have until then; faster, and it brakes as hard as it can. A change
//! of direction passes through rest, and both ways must be free for it. That the next period always
//! has a way out again is tested, not proved (specification §9).

use crate::travel::{direction_of_travel_rad, lesser};

/// Rays across the cone (specification §9).
const RAYS: u32 = 11;

/// How a robot with accelerations for inputs can come to rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Braking {
    /// Control period Ts, seconds.
    pub period_s: f64,
    /// Distance to be kept free, metres.
    pub guard_m: f64,
    /// Bound on the speed of things that move, m/s.
    pub v_disc_mps: f64,
    /// Half-angle of the cone beyond the robot's own turning, radians.
    pub spread_rad: f64,
    /// Largest acceleration, m/s².
    pub accel_mps2: f64,
    /// Largest angular acceleration, rad/s².
    pub alpha_radps2: f64,
    /// Present forward speed, m/s.
    pub v_mps: f64,
    /// Present turn rate, rad/s.
    pub omega_radps: f64,
}

impl Braking {
    /// T: the period, and what it takes to stop after it, seconds.
    fn horizon_s(&self) -> f64 {
        let speed_mps = libm::fabs(self.v_mps).max(self.accel_mps2 * self.period_s);
        self.period_s + speed_mps / self.accel_mps2
    }

    /// What of the free distance may be used up, metres, going the way of `sign`.
    fn usable_m(&self, sign: f64, heading_rad: f64, ray_m: impl Fn(f64) -> f64) -> f64 {
        let horizon_s = self.horizon_s();
        let turn_rad = (libm::fabs(self.omega_radps) + self.alpha_radps2 * self.period_s)
            * horizon_s
            + self.spread_rad;
        let half_rad = turn_rad.min(std::f64::consts::FRAC_PI_2);
        let along_rad = direction_of_travel_rad(heading_rad, sign);
        let free_m = (0..RAYS)
            .map(|i| 2.0 * f64::from(i) / f64::from(RAYS - 1) - 1.0)
            .map(|share| ray_m(along_rad + share * half_rad))
            .fold(f64::INFINITY, lesser);
        free_m - self.guard_m - self.v_disc_mps * horizon_s
    }

    /// Fastest speed at the end of the period, m/s, from which the robot can stop within
    /// `usable_m` when it has `speed_mps` at its beginning; 0 where there is none.
    fn next_speed_mps(&self, usable_m: f64, speed_mps: f64) -> f64 {
        let (a, ts) = (self.accel_mps2, self.period_s);
        let rest_m = usable_m - 0.5 * speed_mps * ts;
        if rest_m.is_nan() || rest_m <= 0.0 {
            return 0.0;
        }
        // The larger root of n Ts/2 + n²/(2a) = rest.
        a * (libm::sqrt(0.25 * ts * ts + 2.0 * rest_m / a) - 0.5 * ts)
    }

    /// S3: `u` with its acceleration brought down to what leaves room to stop; `u` itself, bit for
    /// bit, where it does. Its angular acceleration stays.
    pub fn project(&self, u: [f64; 2], heading_rad: f64, ray_m: impl Fn(f64) -> f64) -> [f64; 2] {
        let [u1, u2] = u;
        let (v, ts) = (self.v_mps, self.period_s);
        let next = v + u1 * ts;
        let braking = |to_mps: f64| {
            let wanted = (to_mps - v) / ts;
            [wanted.clamp(-self.accel_mps2, self.accel_mps2), u2]
        };
        if next == 0.0 && libm::fabs(v) <= 0.0 {
            return u;
        }
        let reverses = v * next < 0.0;
        if reverses {
            // To rest at u1, then the other way.
            let to_rest_m = v * v / (2.0 * libm::fabs(u1));
            let there = self.usable_m(v, heading_rad, &ray_m) >= to_rest_m;
            let limit = self.next_speed_mps(self.usable_m(next, heading_rad, &ray_m), 0.0);
            return if there && libm::fabs(next) <= limit { u } else { braking(0.0) };
        }
        let sign = if v == 0.0 { next } else { v };
        let usable_m = self.usable_m(sign, heading_rad, &ray_m);
        let limit = self.next_speed_mps(usable_m, libm::fabs(v));
        if libm::fabs(next) <= limit { u } else { braking(libm::copysign(limit, sign)) }
    }
}
