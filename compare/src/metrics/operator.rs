//! What it costs the person: `operator_effort`, `operator_reversals_per_min`.
//!
//! From the joystick at its own rate, not from the steps: controllers of different periods see the
//! same hand.

use super::accumulate::Accumulate;
use super::authority::{ASKS_ABOVE, Rate};
use super::sample::{Limits, Request};

/// A joystick that says nothing for longer than this was let go or lost, seconds (specification §10:
/// the age at which a sample no longer counts).
const SILENT_ABOVE_S: f64 = 0.2;

/// `operator_effort` = ∫ ‖S d`u_h`/dt‖ dt = Σ ‖S Δ`u_h`‖ over joystick samples: the way of the hand, 1
/// for the way from rest to full speed.
#[derive(Clone, Debug)]
pub(super) struct Effort {
    limits: Limits,
    last: Option<Request>,
    way: f64,
    known: bool,
}

impl Effort {
    pub(super) fn new(limits: Limits) -> Self {
        Effort { limits, last: None, way: 0.0, known: false }
    }
}

impl Accumulate for Effort {
    fn request(&mut self, request: &Request) {
        let [v, omega] = self.limits.shares(request.twist);
        if v.is_nan() || omega.is_nan() {
            self.last = None;
            return;
        }
        self.known = true;
        if let Some(last) = self.last
            && request.t_s - last.t_s <= SILENT_ABOVE_S
        {
            let [v_before, omega_before] = self.limits.shares(last.twist);
            self.way += libm::hypot(v - v_before, omega - omega_before);
        }
        self.last = Some(*request);
    }

    fn value(&self) -> Option<f64> {
        self.known.then_some(self.way)
    }

    fn total(&self) -> Option<f64> {
        self.value()
    }
}

/// `operator_reversals_per_min` = changes of sign of `v_h` or of `ω_h` between values beyond 5 % of
/// full speed, per minute of joystick (after the steering reversal rate of `McLean` and Hoffmann,
/// "Steering reversals as a measure of driver performance", Human Factors 17, 1975).
#[derive(Clone, Debug)]
pub(super) struct Reversals {
    limits: Limits,
    rate: Rate,
    last_s: Option<f64>,
    signs: [f64; 2],
}

impl Reversals {
    pub(super) fn new(limits: Limits) -> Self {
        Reversals { limits, rate: Rate::default(), last_s: None, signs: [0.0; 2] }
    }
}

impl Accumulate for Reversals {
    fn request(&mut self, request: &Request) {
        let shares = self.limits.shares(request.twist);
        if shares.iter().any(|share| share.is_nan()) {
            self.last_s = None;
            return;
        }
        if let Some(last_s) = self.last_s {
            self.rate.watched_s += (request.t_s - last_s).clamp(0.0, SILENT_ABOVE_S);
        }
        self.last_s = Some(request.t_s);
        for (sign, share) in self.signs.iter_mut().zip(shares) {
            if libm::fabs(share) > ASKS_ABOVE {
                let now = libm::copysign(1.0, share);
                if *sign == -now {
                    self.rate.count += 1;
                }
                *sign = now;
            }
        }
    }

    fn value(&self) -> Option<f64> {
        self.rate.per_min()
    }

    fn total(&self) -> Option<f64> {
        self.rate.count()
    }
}
