//! Dead reckoning: heading from the gyro, travel from the wheels.
//!
//! On a skid-steered robot the wheels tell the travel well and the turn badly, the gyro the turn
//! well; so each does what it is good at. Between two encoder samples the gyro bends the path: the
//! direction of motion is integrated exactly for a turn rate that is constant from one gyro sample
//! to the next, and the travel of the wheels is spread evenly over it.
//!
//! | what arrives | what happens |
//! |---|---|
//! | a sample with NaN or ±∞ in what is needed | ignored; the estimate ages |
//! | a sample as old as the newest of its kind, or older | ignored: late, or twice |
//! | a sample more than a second older | the clock was set: the estimate goes on from the present pose at the new time, the past is forgotten |
//! | a gap in the gyro | the wheels give the heading |
//! | a gap in the encoders | their counters give the travel, the gyro the path |
//! | counters that jump | as far as the last speed reached in that time, at most 0.2 s |
//! | both wheels at rest | the gyro shows its bias; the heading holds |

use schemas::{EncoderSample, ImuSample, Pose, Time};

use super::gyro_bias::GyroBias;
use super::trail::Trail;
use crate::digest::Digest;

/// A gyro silent for longer than this, seconds, leaves the heading to the wheels. Five samples of the
/// 100 Hz gyro.
const GYRO_HOLD_S: f64 = 0.05;

/// For how long speeds hold without a sample that confirms them, seconds: the age at which odometry
/// counts as stale (specification, section 10).
const HOLD_S: f64 = 0.2;

/// A stamp this much older than its predecessor, seconds, is a new clock, not a late sample.
const CLOCK_SET_S: f64 = 1.0;

/// Wheels that say they went faster than this, m/s, have lost count. The Pioneer 3-AT reaches 1.2.
const FASTEST_WHEEL_MPS: f64 = 2.5;

/// Turn rates beyond this, rad/s, are nonsense: 2000°/s, the full scale of common gyros.
const FASTEST_TURN_RADPS: f64 = 35.0;

/// Wheels slower than this, m/s, and without travel, stand still.
const STANDING_MPS: f64 = 1e-3;

/// For how long the wheels must stand before the gyro's rate is taken for its bias, seconds. Longer
/// than a body takes to stop shaking, short within the 0.4 s of standing at the start.
const STANDING_S: f64 = 0.1;

/// Metres of uncertainty that a radian of turning counts for in [`Odometry::odometer_m`]: the arm of
/// the outermost sonar (0.24 m) rounded down, as the echo map's prototype had it.
const TURNING_ARM_M: f64 = 0.2;

/// What the robot believes about its own motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Pose at the newest accepted sample, in the odometry frame, which is the world frame at the
    /// start and drifts from it.
    pub pose: Pose,
    /// Forward speed, m/s, from the wheels; NaN never.
    pub v_mps: f64,
    /// Turn rate, rad/s: the gyro's less its bias, or the wheels' while no gyro is heard.
    pub omega_radps: f64,
    /// The newest accepted encoder sample; `None` before the first. Travel is known up to here, so
    /// the age of the odometry counts from here.
    pub stamp: Option<Time>,
}

/// Dead reckoning from encoders and gyro.
#[derive(Clone, Debug)]
pub struct Odometry {
    track_m: f64,
    /// Newest accepted encoder sample, and the pose of then: the anchor.
    wheels: Option<EncoderSample>,
    anchor: Pose,
    /// How far the heading has been integrated, and the heading there.
    integrated_to: Option<Time>,
    theta_rad: f64,
    /// The path from the anchor to there at unit speed, and how long it takes.
    path_s: [f64; 2],
    path_duration_s: f64,
    /// Whether the gyro fell silent on that path.
    gyro_gap: bool,
    /// Newest accepted gyro sample and its turn rate as measured, bias included.
    gyro: Option<(Time, f64)>,
    bias: GyroBias,
    /// Since when the wheels have stood still.
    standing_since: Option<Time>,
    v_mps: f64,
    omega_radps: f64,
    odometer_m: f64,
    trail: Trail,
}

impl Odometry {
    /// Starts at rest at `start` (world frame). `track_m` is the effective distance between left and
    /// right wheels, metres: ω = (`v_R` − `v_L`)/track (specification, section 1).
    pub fn new(start: Pose, track_m: f64) -> Odometry {
        Odometry {
            track_m,
            wheels: None,
            anchor: start,
            integrated_to: None,
            theta_rad: start.theta_rad,
            path_s: [0.0; 2],
            path_duration_s: 0.0,
            gyro_gap: false,
            gyro: None,
            bias: GyroBias::default(),
            standing_since: None,
            v_mps: 0.0,
            omega_radps: 0.0,
            odometer_m: 0.0,
            trail: Trail::new(),
        }
    }

    /// Takes a gyro sample: its rate is that of the stretch of time that ends with it.
    pub fn imu(&mut self, sample: &ImuSample) {
        let rate_radps = sample.gyro_radps[2];
        // Written so that NaN is refused too.
        let plausible = rate_radps.abs() <= FASTEST_TURN_RADPS;
        if !plausible || !self.is_news(self.gyro.map(|(stamp, _)| stamp), sample.stamp) {
            return;
        }
        self.bias.hear(rate_radps);
        self.omega_radps = rate_radps - self.bias.radps();
        self.gyro = Some((sample.stamp, rate_radps));
        let silent_s = self.integrated_to.map_or(0.0, |newest| sample.stamp.seconds_since(newest));
        self.gyro_gap |= silent_s > GYRO_HOLD_S;
        self.turn(self.omega_radps, silent_s.min(HOLD_S));
        self.reach(sample.stamp);
    }

    /// Takes an encoder sample.
    pub fn encoders(&mut self, sample: &EncoderSample) {
        let counted = sample.left_m.is_finite() && sample.right_m.is_finite();
        if !counted || !self.is_news(self.wheels.map(|wheels| wheels.stamp), sample.stamp) {
            return;
        }
        let Some(previous) = self.wheels.replace(*sample) else {
            // Travel counts from here; what the gyro has turned so far, it turned on the spot.
            self.drop_anchor(self.pose());
            self.v_mps = reported_speed_mps(sample).unwrap_or(0.0);
            self.reach(sample.stamp);
            return;
        };
        let elapsed_s = sample.stamp.seconds_since(previous.stamp);
        let (travel_m, turn_rad) = self.between(&previous, sample, elapsed_s);

        let gyro_is_heard = !self.gyro_gap
            && self.gyro.is_some_and(|(stamp, _)| sample.stamp.seconds_since(stamp) <= GYRO_HOLD_S);
        if gyro_is_heard {
            let ahead_s =
                self.integrated_to.map_or(0.0, |newest| sample.stamp.seconds_since(newest));
            self.turn(self.omega_radps, ahead_s);
        } else {
            self.omega_radps = turn_rad / elapsed_s;
            self.drop_anchor(self.anchor);
            self.trail.forget_after(previous.stamp);
            self.turn(self.omega_radps, elapsed_s);
        }
        self.note_standing(&previous, sample);
        if self.path_duration_s <= 0.0 {
            self.turn(0.0, elapsed_s);
        }
        let mean_mps = travel_m / self.path_duration_s;
        self.trail.settle(previous.stamp, self.anchor.position_m(), mean_mps);
        self.drop_anchor(self.along_path(mean_mps));

        self.v_mps = reported_speed_mps(sample).unwrap_or(travel_m / elapsed_s);
        self.odometer_m += travel_m.abs();
        self.reach(sample.stamp);
    }

    /// The estimate as of the newest sample.
    pub fn estimate(&self) -> Estimate {
        Estimate {
            pose: self.pose(),
            v_mps: self.v_mps,
            omega_radps: self.omega_radps,
            stamp: self.wheels.map(|wheels| wheels.stamp),
        }
    }

    /// The pose at `at`: within the last second or so between the poses of the samples, up to 0.2 s
    /// after the newest sample along the arc of the present speeds; `None` outside of that and
    /// before anything was heard.
    pub fn pose_at(&self, at: Time) -> Option<Pose> {
        let newest = self.integrated_to?;
        let ahead_s = at.seconds_since(newest);
        if ahead_s <= 0.0 {
            return self.trail.pose_at(at);
        }
        if ahead_s > HOLD_S {
            return None;
        }
        let pose = self.pose();
        let [along_x_s, along_y_s] = arc_s(pose.theta_rad, self.omega_radps, ahead_s);
        Some(Pose {
            x_m: pose.x_m + self.v_mps * along_x_s,
            y_m: pose.y_m + self.v_mps * along_y_s,
            theta_rad: pose.theta_rad + self.omega_radps * ahead_s,
        })
    }

    /// ∫(|v| + 0.2 m·|ω|)dt since the start, metres: what the uncertainty of a remembered echo grows
    /// with.
    pub fn odometer_m(&self) -> f64 {
        self.odometer_m
    }

    /// The gyro's constant error as learnt so far, rad/s.
    pub fn gyro_bias_radps(&self) -> f64 {
        self.bias.radps()
    }

    /// Takes the whole state into a hash; `start` is the start of the session.
    pub(crate) fn fold(&self, digest: &mut Digest, start: Time) {
        digest.pose(&self.anchor);
        digest.numbers(&self.path_s);
        digest.numbers(&[self.theta_rad, self.path_duration_s]);
        digest.numbers(&[self.v_mps, self.omega_radps, self.odometer_m]);
        digest.word(u64::from(self.gyro_gap));
        // A word for whether it is there, so that one does not pass for the other.
        for stamp in [self.integrated_to, self.standing_since] {
            digest.word(u64::from(stamp.is_some()));
            if let Some(stamp) = stamp {
                digest.time(stamp, start);
            }
        }
        if let Some((stamp, rate_radps)) = self.gyro {
            digest.time(stamp, start);
            digest.number(rate_radps);
        }
        if let Some(wheels) = &self.wheels {
            digest.time(wheels.stamp, start);
            digest.numbers(&[wheels.left_m, wheels.right_m]);
        }
        self.bias.fold(digest);
        self.trail.fold(digest, start);
    }

    /// Whether a sample at `stamp` is newer than the last of its kind. A clock that was set back
    /// starts the reckoning afresh, at the present pose.
    fn is_news(&mut self, last: Option<Time>, stamp: Time) -> bool {
        let Some(last) = last else { return true };
        if last.seconds_since(stamp) > CLOCK_SET_S {
            self.drop_anchor(self.pose());
            self.wheels = None;
            self.gyro = None;
            self.standing_since = None;
            self.integrated_to = None;
            self.trail.clear();
            return true;
        }
        stamp > last
    }

    /// Makes `pose` the pose that the path starts from.
    fn drop_anchor(&mut self, pose: Pose) {
        self.anchor = pose;
        self.theta_rad = pose.theta_rad;
        self.path_s = [0.0; 2];
        self.path_duration_s = 0.0;
        self.gyro_gap = false;
    }

    /// Extends the path by a turn at `omega_radps` for `duration_s`, if that is any time at all.
    fn turn(&mut self, omega_radps: f64, duration_s: f64) {
        if duration_s <= 0.0 {
            return;
        }
        let along_s = arc_s(self.theta_rad, omega_radps, duration_s);
        self.path_s[0] += along_s[0];
        self.path_s[1] += along_s[1];
        self.path_duration_s += duration_s;
        self.theta_rad += omega_radps * duration_s;
        self.odometer_m += TURNING_ARM_M * (omega_radps * duration_s).abs();
    }

    /// Notes that the present pose is that of `at`, or of later where a later sample came first.
    fn reach(&mut self, at: Time) {
        let newest = self.integrated_to.map_or(at, |newest| newest.max(at));
        self.integrated_to = Some(newest);
        self.trail.push(newest, self.pose(), self.path_s);
    }

    /// Travel (metres) and turn (radians) by the wheels' counters, or, where these jumped, by the
    /// speeds of before.
    fn between(&self, from: &EncoderSample, to: &EncoderSample, elapsed_s: f64) -> (f64, f64) {
        let (left_m, right_m) = (to.left_m - from.left_m, to.right_m - from.right_m);
        if left_m.abs().max(right_m.abs()) <= FASTEST_WHEEL_MPS * elapsed_s {
            (0.5 * (left_m + right_m), (right_m - left_m) / self.track_m)
        } else {
            let held_s = elapsed_s.min(HOLD_S);
            (self.v_mps * held_s, self.omega_radps * held_s)
        }
    }

    /// The pose at the end of the path, if driven at `v_mps`.
    fn along_path(&self, v_mps: f64) -> Pose {
        Pose {
            x_m: self.anchor.x_m + v_mps * self.path_s[0],
            y_m: self.anchor.y_m + v_mps * self.path_s[1],
            theta_rad: self.theta_rad,
        }
    }

    /// Notes whether the wheels have stood since the previous sample: no travel counted, no speed
    /// reported. If they have for long enough, what the gyro said meanwhile was its bias, and the
    /// heading is what it was.
    fn note_standing(&mut self, previous: &EncoderSample, sample: &EncoderSample) {
        let at_rest = sample.left_m == previous.left_m
            && sample.right_m == previous.right_m
            && reported_speed_mps(sample)
                .is_none_or(|_| sample.left_mps.abs().max(sample.right_mps.abs()) <= STANDING_MPS);
        if !at_rest {
            self.standing_since = None;
            self.bias.moved();
            return;
        }
        let since = *self.standing_since.get_or_insert(previous.stamp);
        if sample.stamp.seconds_since(since) < STANDING_S {
            self.bias.moved();
        } else if self.bias.stood() {
            self.drop_anchor(self.anchor);
            self.trail.forget_after(previous.stamp);
            self.omega_radps = 0.0;
        }
    }

    /// The pose at the newest sample: beyond the anchor with the speed of the anchor, which holds
    /// for 0.2 s.
    fn pose(&self) -> Pose {
        let held = if self.path_duration_s > HOLD_S { HOLD_S / self.path_duration_s } else { 1.0 };
        self.along_path(self.v_mps * held)
    }
}

/// Forward speed as the wheels report it, if both do and it can be true.
fn reported_speed_mps(sample: &EncoderSample) -> Option<f64> {
    let fastest_mps = sample.left_mps.abs().max(sample.right_mps.abs());
    let known = sample.left_mps.is_finite() && sample.right_mps.is_finite();
    (known && fastest_mps <= FASTEST_WHEEL_MPS)
        .then_some(0.5 * (sample.left_mps + sample.right_mps))
}

/// ∫₀ᵗ (cos(θ + ωτ), sin(θ + ωτ)) dτ, seconds: t·sinc(ωt/2) in the direction θ + ωt/2.
fn arc_s(theta_rad: f64, omega_radps: f64, elapsed_s: f64) -> [f64; 2] {
    let half_rad = 0.5 * omega_radps * elapsed_s;
    let chord_s = elapsed_s * sinc(half_rad);
    let (sin, cos) = libm::sincos(theta_rad + half_rad);
    [chord_s * cos, chord_s * sin]
}

/// sin x / x. Below 1e-4 the first two terms of the series, whose rest x⁴/120 is under 1e-18.
fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-4 { 1.0 - x * x / 6.0 } else { libm::sin(x) / x }
}

#[cfg(test)]
mod tests;
