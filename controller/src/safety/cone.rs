//! S2: the projection of the kinematic model.
//!
//! A curve whose headings lie in a cone of half-angle below 90° stays in that cone and within its
//! own length of where it starts. So a robot that travels no farther in a period than the least
//! free distance in the cone of headings it can have in that period stays free; with exact rays the
//! static admissible set is never left. v = 0 is always allowed, and turning with it: the body is
//! the disc about its reference point.

use crate::travel::{direction_of_travel_rad, lesser};

/// Rays across the cone (specification §9).
const RAYS: u32 = 7;

/// How far a robot may go in a period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Control period Ts, seconds.
    pub period_s: f64,
    /// Distance to be kept free, metres.
    pub guard_m: f64,
    /// Bound on the speed of things that move, m/s.
    pub v_disc_mps: f64,
    /// Half-angle of the cone beyond the robot's own turning, radians.
    pub spread_rad: f64,
    /// For how long the robot may turn while it travels, seconds: the period, and what it takes to
    /// stop after that.
    pub turning_s: f64,
    /// Turn rate that the robot has already, rad/s; 0 where a command takes effect at once.
    pub omega_now_radps: f64,
    /// Deceleration, m/s², of a plant that reaches its velocities at no more than that: it needs
    /// v²/(2a) beyond the period to stop. `None` where a command takes effect at once.
    pub brake_mps2: Option<f64>,
}

impl Cone {
    /// Fastest speed, m/s, with `free_m` ahead; 0 where that is unknown.
    pub fn speed_limit_mps(&self, free_m: f64) -> f64 {
        let usable_m = free_m - self.guard_m - self.v_disc_mps * self.period_s;
        if usable_m.is_nan() || usable_m <= 0.0 {
            return 0.0;
        }
        match self.brake_mps2 {
            None => usable_m / self.period_s,
            // The larger root of v Ts + v²/(2a) = usable.
            Some(a) => {
                let coasting = a * self.period_s;
                libm::sqrt(coasting * coasting + 2.0 * a * usable_m) - coasting
            }
        }
    }

    /// Least free distance, metres, over the headings that the robot can have in the coming period
    /// when it travels at `u`; NaN if one of the rays is unknown.
    pub fn free_m(&self, u: [f64; 2], heading_rad: f64, ray_m: impl Fn(f64) -> f64) -> f64 {
        let [v, omega] = u;
        let along_rad = direction_of_travel_rad(heading_rad, v);
        let turn_radps = libm::fabs(omega).max(libm::fabs(self.omega_now_radps));
        let half_rad = turn_radps * self.turning_s + self.spread_rad;
        (0..RAYS)
            .map(|i| 2.0 * f64::from(i) / f64::from(RAYS - 1) - 1.0)
            .map(|share| ray_m(along_rad + share * half_rad))
            .fold(f64::INFINITY, lesser)
    }

    /// S2: `u` with its speed brought down to what is free ahead; `u` itself, bit for bit, where its
    /// speed is no more than that. Its turn rate stays.
    pub fn project(&self, u: [f64; 2], heading_rad: f64, ray_m: impl Fn(f64) -> f64) -> [f64; 2] {
        let [v, omega] = u;
        if v == 0.0 {
            return u;
        }
        let limit_mps = self.speed_limit_mps(self.free_m(u, heading_rad, ray_m));
        if libm::fabs(v) <= limit_mps {
            return u;
        }
        if limit_mps <= 0.0 {
            return [0.0, omega];
        }
        [libm::copysign(limit_mps, v), omega]
    }
}
