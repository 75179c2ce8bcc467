//! Pose, speeds and attitude from encoders and IMU: which samples count, and what they tell.
//!
//! On a skid-steered robot the wheels tell the travel well and the turn badly, the gyro the turn
//! well but for its bias. The filter ([`super::ekf`]) weighs them; this file decides what it is shown.
//!
//! | what arrives | what happens |
//! |---|---|
//! | a sample with NaN or ±∞ in what is needed | ignored; the estimate ages |
//! | a sample as old as the newest of its kind, or older | ignored: late, or twice |
//! | a sample more than a second older, or a minute newer | the clock was set: the estimate goes on from the present pose at the new time, the past is forgotten |
//! | a turn rate that the filter did not expect | ignored; the third in a row is believed |
//! | counters that the filter did not expect (slip) | their increment does not count; speed by the accelerometer, or held. After a second of it they are believed again, with all that may have changed open |
//! | counters that jump | the same, whatever the filter expected |
//! | one counter stands while the other one and the gyro say that it should not | dead: travel from the other one and the gyro |
//! | counters that lean to one side of what the gyro says, for long | the bias has changed: it is open again |
//! | a gap in the gyro | the wheels give the heading |
//! | a gap in the encoders | speed holds for 0.2 s; afterwards their counters give the travel, the gyro the path |
//! | both wheels at rest | speeds are zero, the gyro shows its bias; the heading holds |

mod encoders;
mod imu;

use schemas::{EncoderSample, EstimatorStatus, ImuSample, Pose, Time};

use super::ekf::{BIAS, Ekf, OMEGA, THETA, TRAVEL, V, X, Y, arc_s};
use super::gate::{Gate, ONE_NUMBER, TWO_NUMBERS};
use super::health::{GYRO_HOLD_S, Health};
use super::madgwick::Madgwick;
use super::trail::Trail;
use super::wheels::{Wheels, reported_speed_mps};
use crate::digest::Digest;
use encoders::{SPEED_SIGMA_MPS, Settled};

/// For how long speeds hold without a sample that confirms them, seconds: the age at which odometry
/// counts as stale (specification, section 10).
const HOLD_S: f64 = 0.2;

/// A stamp this much older than its predecessor, seconds, is a new clock, not a late sample.
const CLOCK_SET_BACK_S: f64 = 1.0;

/// A stamp this much newer, seconds, is a new clock or a new day: nothing is known of the time
/// between.
const CLOCK_SET_FORWARD_S: f64 = 60.0;

/// Turn rates beyond this, rad/s, are nonsense: 2000°/s, the full scale of common gyros.
const FASTEST_TURN_RADPS: f64 = 35.0;

/// Noise of the gyro, rad/s: that of the simulated one, and of common ones at 100 Hz.
const GYRO_SIGMA_RADPS: f64 = 0.005;

/// Rates above this, rad/s, are motion, not bias: five times the bias that the simulated gyro has
/// by default, and the order of the worst zero-rate offset in the data sheets of such gyros.
const LARGEST_BIAS_RADPS: f64 = 0.05;

/// Share of travel that is lost to slip, one standard deviation: no sensor shows it.
const TRAVEL_GAIN_SIGMA: f64 = 0.03;

/// Metres of uncertainty that a radian of turning counts for in [`Odometry::odometer_m`]: the arm of
/// the outermost sonar (0.24 m) rounded down, as the echo map's prototype had it.
const TURNING_ARM_M: f64 = 0.2;

/// What the robot believes about its own motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Pose at the newest accepted sample, in the odometry frame, which is the world frame at the
    /// start and drifts from it.
    pub pose: Pose,
    /// Forward speed, m/s, by the wheels; NaN never.
    pub v_mps: f64,
    /// Turn rate, rad/s.
    pub omega_radps: f64,
    /// The instant that pose and speeds are of: the newest accepted sample; `None` before the first.
    pub reached: Option<Time>,
    /// The newest accepted encoder sample; `None` before the first. Travel is known up to here, so
    /// the age of the odometry counts from here.
    pub stamp: Option<Time>,
}

/// How far an estimate is to be trusted, and what the filters hold besides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// Roll, pitch (positive nose down) and yaw by the Madgwick filter, radians; NaN before the first
    /// IMU sample.
    pub attitude_rad: [f64; 3],
    /// Standard deviations of x, y (metres) and heading (radians). Those of x and y count a lasting
    /// slip of 3 % along the way from the start to here.
    pub sigma: [f64; 3],
    /// The gyro's constant error as learnt so far, rad/s.
    pub gyro_bias_radps: f64,
    /// Normalised innovation squared of the newest encoder sample, two degrees of freedom (one while
    /// one counter is dead); NaN before any.
    pub encoder_innovation: f64,
    /// The same of the newest turn rate, one degree of freedom.
    pub gyro_innovation: f64,
    /// Encoder samples turned away since the start.
    pub encoders_rejected: i32,
    /// Turn rates turned away since the start.
    pub gyro_rejected: i32,
    /// In one word.
    pub status: EstimatorStatus,
}

/// Pose, speeds and attitude from encoders and IMU.
#[derive(Clone, Debug)]
pub struct Odometry {
    track_m: f64,
    start_m: [f64; 2],
    ekf: Ekf,
    attitude: Madgwick,
    /// The instant that the filter's state is of.
    reached: Option<Time>,
    wheels: Wheels,
    /// Newest accepted gyro sample.
    gyro: Option<Time>,
    /// Since when a gyro that had been silent is heard again, while nothing has told yet what
    /// happened meanwhile.
    gap_until: Option<Time>,
    /// Whether the gyro, since the newest encoder sample, was too fast for a bias.
    fast: bool,
    /// Since when the speed has been given up for want of encoders.
    released: Option<Time>,
    gyro_gate: Gate,
    encoder_gate: Gate,
    /// Since when counters have been turned away without a break, and the turn by them less that by
    /// the gyro since then.
    at_odds: Option<(Time, f64)>,
    /// Until when the accelerometer is left aside.
    distrust_until: Option<Time>,
    /// Running mean of the turn's normalised innovation.
    lean: f64,
    /// Forward acceleration, m/s², between the newest two encoder samples.
    felt_mps2: f64,
    /// The filter as of the newest encoder sample.
    settled: Settled,
    /// For how long since then the accelerometer has told nothing, seconds.
    unfelt_s: f64,
    /// What the accelerometer shows ahead beyond that, m/s², on average: its bias, and gravity where
    /// the floor or the sensor is tilted.
    tilt_mps2: f64,
    health: Health,
    odometer_m: f64,
    trail: Trail,
}

impl Odometry {
    /// Starts at rest at `start` (world frame). `track_m` is the effective distance between left and
    /// right wheels, metres: ω = (`v_R` − `v_L`)/track (specification, section 1).
    pub fn new(start: Pose, track_m: f64) -> Odometry {
        Odometry {
            track_m,
            start_m: start.position_m(),
            ekf: Ekf::new(start, track_m),
            attitude: Madgwick::new(start.theta_rad),
            reached: None,
            wheels: Wheels::default(),
            gyro: None,
            gap_until: None,
            fast: false,
            released: None,
            gyro_gate: Gate::new(ONE_NUMBER),
            encoder_gate: Gate::new(TWO_NUMBERS),
            at_odds: None,
            distrust_until: None,
            lean: 0.0,
            felt_mps2: 0.0,
            settled: Settled::default(),
            unfelt_s: 0.0,
            tilt_mps2: 0.0,
            health: Health::default(),
            odometer_m: 0.0,
            trail: Trail::new(),
        }
    }

    /// Takes an IMU sample: its turn rate and acceleration are those of the stretch of time that ends
    /// with it.
    pub fn imu(&mut self, sample: &ImuSample) {
        let rate_radps = sample.gyro_radps[2];
        // Written so that NaN is refused too.
        let plausible = rate_radps.abs() <= FASTEST_TURN_RADPS;
        if !plausible || !self.is_news(self.gyro, sample.stamp) {
            return;
        }
        let first = self.gyro.is_none();
        self.orient(sample);
        self.gyro = Some(sample.stamp);
        self.fast |= rate_radps.abs() > LARGEST_BIAS_RADPS
            || (rate_radps - self.ekf.get(BIAS)).abs() > LARGEST_BIAS_RADPS;
        if self.waits_for_the_wheels(sample.stamp) {
            return;
        }
        self.release(sample.stamp);
        let accel = self.forward_mps2(sample);
        let stretch_s = self.reached.map_or(0.0, |reached| sample.stamp.seconds_since(reached));
        let before_radps = self.ekf.get(OMEGA);
        self.advance(sample.stamp, accel, false);
        if first {
            // Nothing was expected yet.
            let variance = GYRO_SIGMA_RADPS * GYRO_SIGMA_RADPS + self.ekf.variance(BIAS);
            self.ekf.replace(OMEGA, rate_radps - self.ekf.get(BIAS), variance);
        }
        self.hear_rate(rate_radps, sample.stamp);
        self.ekf.blur_turn(self.ekf.get(OMEGA) - before_radps, stretch_s.clamp(0.0, HOLD_S));
        self.trail_on();
    }

    /// Takes an encoder sample.
    pub fn encoders(&mut self, sample: &EncoderSample) {
        let counted = sample.left_m.is_finite() && sample.right_m.is_finite();
        if !counted || !self.is_news(self.wheels.stamp(), sample.stamp) {
            return;
        }
        let since = self.wheels.stamp();
        let rolled = self.wheels.take(sample);
        let (Some(since), Some(rolled)) = (since, rolled) else {
            self.advance(sample.stamp, None, false);
            self.ekf.anchor();
            if let Some(v_mps) = reported_speed_mps(sample) {
                self.ekf.replace(V, v_mps, SPEED_SIGMA_MPS * SPEED_SIGMA_MPS);
            }
            self.settle();
            self.trail_on();
            return;
        };
        let gyro_is_heard = self.gap_until.is_none()
            && self.gyro.is_some_and(|at| sample.stamp.seconds_since(at) <= GYRO_HOLD_S);
        let counted = rolled.travel_and_turn(self.track_m);
        let driven = !gyro_is_heard && !rolled.jumped;
        if driven {
            self.drive(counted, since, sample.stamp);
        }
        self.gap_until = None;
        self.advance(sample.stamp, None, driven);

        let before = self.ekf.pose();
        let predicted_m = self.ekf.get(TRAVEL);
        let believed = self.hear_wheels(sample, &rolled, gyro_is_heard);
        self.felt_mps2 = (self.ekf.get(V) - self.settled.v_mps()) / rolled.elapsed_s;
        self.settle();
        self.odometer_m += if believed { counted[0] } else { predicted_m }.abs();
        self.fast = false;
        self.trail_on();
        let after = self.ekf.pose();
        let moved = Pose {
            x_m: after.x_m - before.x_m,
            y_m: after.y_m - before.y_m,
            theta_rad: after.theta_rad - before.theta_rad,
        };
        // What was reckoned with speeds that held was right; what came after goes by its share.
        self.trail.settle(self.released.take().map_or(since, |from| from.max(since)), moved);
    }

    /// The estimate as of the newest sample.
    pub fn estimate(&self) -> Estimate {
        Estimate {
            pose: self.ekf.pose(),
            v_mps: self.ekf.get(V),
            omega_radps: self.ekf.get(OMEGA),
            reached: self.reached,
            stamp: self.wheels.stamp(),
        }
    }

    /// How far that is to be trusted at `now`.
    pub fn report(&self, now: Time) -> Report {
        let pose = self.ekf.pose();
        // Travel that is too long by a share s puts the robot off by s times the way from the start.
        let lasting = [pose.x_m - self.start_m[0], pose.y_m - self.start_m[1], 0.0];
        let sigma = [X, Y, THETA].map(|of| {
            let slip_m = TRAVEL_GAIN_SIGMA * lasting[of];
            libm::sqrt(self.ekf.variance(of) + slip_m * slip_m)
        });
        Report {
            attitude_rad: self.attitude.angles_rad(),
            sigma,
            gyro_bias_radps: self.ekf.get(BIAS),
            encoder_innovation: self.encoder_gate.innovation,
            gyro_innovation: self.gyro_gate.innovation,
            encoders_rejected: self.encoder_gate.rejected,
            gyro_rejected: self.gyro_gate.rejected,
            status: self.health.status(now, self.gyro, self.wheels.stamp()),
        }
    }

    /// The pose at `at`: within the last second or so between the poses of the samples, up to 0.2 s
    /// after the newest sample along the arc of the present speeds; `None` outside of that and
    /// before anything was heard.
    pub fn pose_at(&self, at: Time) -> Option<Pose> {
        let newest = self.reached?;
        let ahead_s = at.seconds_since(newest);
        if ahead_s <= 0.0 {
            return self.trail.pose_at(at);
        }
        if ahead_s > HOLD_S {
            return None;
        }
        let pose = self.ekf.pose();
        let (v_mps, omega_radps) = (self.ekf.get(V), self.ekf.get(OMEGA));
        let [along_x_s, along_y_s] = arc_s(pose.theta_rad, omega_radps, ahead_s);
        Some(Pose {
            x_m: pose.x_m + v_mps * along_x_s,
            y_m: pose.y_m + v_mps * along_y_s,
            theta_rad: pose.theta_rad + omega_radps * ahead_s,
        })
    }

    /// ∫(|v| + 0.2 m·|ω|)dt since the start, metres: what the uncertainty of a remembered echo grows
    /// with.
    pub fn odometer_m(&self) -> f64 {
        self.odometer_m
    }

    /// The gyro's constant error as learnt so far, rad/s.
    pub fn gyro_bias_radps(&self) -> f64 {
        self.ekf.get(BIAS)
    }

    /// Takes the whole state into a hash; `start` is the start of the session.
    pub(crate) fn fold(&self, digest: &mut Digest, start: Time) {
        self.ekf.fold(digest);
        self.attitude.fold(digest);
        self.wheels.fold(digest, start);
        let odds = self.at_odds.map(|(since, _)| since);
        // A word for whether it is there, so that one does not pass for the other.
        for stamp in
            [self.reached, self.gyro, self.gap_until, odds, self.distrust_until, self.released]
        {
            digest.word(u64::from(stamp.is_some()));
            if let Some(stamp) = stamp {
                digest.time(stamp, start);
            }
        }
        digest.numbers(&[
            self.at_odds.map_or(0.0, |(_, odds)| odds),
            self.lean,
            self.felt_mps2,
            self.unfelt_s,
            self.tilt_mps2,
            self.odometer_m,
        ]);
        digest.word(u64::from(self.fast));
        self.settled.fold(digest);
        self.gyro_gate.fold(digest);
        self.encoder_gate.fold(digest);
        self.health.fold(digest, start);
        self.trail.fold(digest, start);
    }
}

/// Time.
impl Odometry {
    /// Whether a sample at `stamp` is newer than the last of its kind. A clock that was set starts
    /// the reckoning afresh, at the present pose.
    fn is_news(&mut self, last: Option<Time>, stamp: Time) -> bool {
        let newest = self.reached.max(self.gyro).max(self.wheels.stamp());
        let set_forward = newest.is_some_and(|at| stamp.seconds_since(at) > CLOCK_SET_FORWARD_S);
        let set_back = last.is_some_and(|at| at.seconds_since(stamp) > CLOCK_SET_BACK_S);
        if set_forward || set_back {
            self.wheels = Wheels::default();
            self.gyro = None;
            self.reached = None;
            self.gap_until = None;
            self.at_odds = None;
            self.distrust_until = None;
            self.released = None;
            self.health = Health::default();
            self.trail.clear();
            self.ekf.anchor();
            return true;
        }
        last.is_none_or(|last| stamp > last)
    }

    /// Takes the filter to `stamp`, if that is ahead. Speeds hold for 0.2 s unless they are `known` to
    /// be those of the whole time.
    fn advance(&mut self, stamp: Time, accel_mps2: Option<f64>, known: bool) {
        let Some(reached) = self.reached.replace(self.reached.map_or(stamp, |it| it.max(stamp)))
        else {
            return;
        };
        let elapsed_s = stamp.seconds_since(reached);
        if elapsed_s <= 0.0 {
            return;
        }
        if accel_mps2.is_none() {
            self.unfelt_s += elapsed_s;
        }
        let held_s = if known { elapsed_s } else { elapsed_s.min(HOLD_S) };
        let (_, turn_rad) = self.ekf.predict(held_s, accel_mps2);
        self.odometer_m += TURNING_ARM_M * turn_rad.abs();
        if held_s < elapsed_s {
            self.ekf.replace(V, 0.0, 1.0);
            self.ekf.replace(OMEGA, 0.0, 1.0);
            self.ekf.predict(elapsed_s - held_s, None);
        }
    }

    /// Notes what the filter holds once it has heard an encoder sample.
    fn settle(&mut self) {
        self.ekf.tidy();
        self.settled = Settled::of(&self.ekf);
        self.unfelt_s = 0.0;
    }

    /// Notes where the sample has led.
    fn trail_on(&mut self) {
        self.ekf.tidy();
        if let Some(reached) = self.reached {
            self.trail.push(reached, self.ekf.pose());
        }
    }
}

#[cfg(test)]
mod tests;
