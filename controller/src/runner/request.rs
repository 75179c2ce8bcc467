//! What the person asks for, once it is known to be usable.

use schemas::{JoystickSample, Reason, Time};

/// The person's request.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Request {
    /// (v, ω) as asked for, m/s and rad/s; zero when `trouble` says why.
    pub(super) u: [f64; 2],
    /// Age of the sample, seconds; NaN before the first.
    pub(super) age_s: f64,
    /// Why nothing is asked for.
    pub(super) trouble: Option<Reason>,
    /// Whether the dead-man button was let go: then the robot stops.
    pub(super) released: bool,
}

/// Whether something of that age no longer counts. What claims to come from far in the future is
/// no more to be trusted than what is old; NaN is stale.
pub(super) fn stale(age_s: f64, lease_s: f64) -> bool {
    age_s.is_nan() || libm::fabs(age_s) > lease_s
}

impl Request {
    /// The request at `now`, from the newest joystick sample.
    pub(super) fn new(joystick: Option<&JoystickSample>, now: Time, lease_s: f64) -> Request {
        let Some(joystick) = joystick else {
            let trouble = Some(Reason::JoystickSilent);
            return Request { u: [0.0; 2], age_s: f64::NAN, trouble, released: false };
        };
        let age_s = now.seconds_since(joystick.stamp);
        let u = [joystick.v_mps, joystick.omega_radps];
        let trouble = if stale(age_s, lease_s) || !joystick.dead_man {
            Some(Reason::JoystickSilent)
        } else if !u.iter().all(|x| x.is_finite()) {
            Some(Reason::JoystickInvalid)
        } else {
            None
        };
        let released = !joystick.dead_man && !stale(age_s, lease_s);
        Request { u: if trouble.is_some() { [0.0; 2] } else { u }, age_s, trouble, released }
    }
}
