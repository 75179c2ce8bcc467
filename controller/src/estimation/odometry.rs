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

use schemas::{EncoderSample, EstimatorStatus, ImuSample, Pose, Time};

use super::ekf::{BIAS, BIAS_SIGMA_RADPS, Ekf, Measurement, OMEGA, THETA, TRAVEL, TURN, TURN_GAIN, V, X, Y, arc_s};
use super::gate::{Gate, ONE_NUMBER, TWO_NUMBERS};
use super::health::{GYRO_HOLD_S, Health};
use super::madgwick::Madgwick;
use super::trail::Trail;
use super::wheels::{Rolled, Side, Wheels, reported_mps, reported_speed_mps};
use crate::digest::Digest;

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

/// Accelerations beyond this, m/s², are nonsense: 16 g, the full scale of common accelerometers.
const STRONGEST_MPS2: f64 = 157.0;

/// Specific force weaker than this, m/s², is no accelerometer's on a floor: half of gravity.
const WEAKEST_MPS2: f64 = 4.9;

/// A stretch longer than this, seconds, is not what one accelerometer sample stands for: two IMU
/// periods.
const ACCEL_HOLD_S: f64 = 0.02;

/// Noise of the gyro, rad/s: that of the simulated one, and of common ones at 100 Hz.
const GYRO_SIGMA_RADPS: f64 = 0.005;

/// Rates above this, rad/s, are motion, not bias: five times the bias that the simulated gyro has
/// by default, and the order of the worst zero-rate offset in the data sheets of such gyros.
const LARGEST_BIAS_RADPS: f64 = 0.05;

/// How well standing wheels say that the robot stands: m/s, rad/s, and metres or radians.
const STANDING_SIGMAS: [f64; 3] = [1e-3, 1e-3, 1e-5];

/// How well a wheel's reported speed is the present one: m/s, and a share of it. A mean over 20 ms is
/// 10 ms old, in which a plant of 2 m/s² changes by 0.02.
const SPEED_SIGMA_MPS: f64 = 0.01;
const SPEED_SHARE: f64 = 0.02;

/// After this many turn rates turned away in a row, 30 ms, the gyro is right and the filter wrong.
const GYRO_IN_A_ROW: u32 = 3;

/// After this long, seconds, counters that are turned away are right and the filter wrong. Longer than
/// a wheel spins on a threshold, short enough that an accelerometer's speed is good to 0.3 m/s.
const PATIENCE_S: f64 = 1.0;

/// For how long, seconds, an accelerometer that was contradicted for [`PATIENCE_S`] is left aside.
const DISTRUST_S: f64 = 10.0;

/// Time constant, seconds, over which the turn's innovations are averaged to see whether they lean.
const LEAN_S: f64 = 1.0;

/// The mean of that many normalised innovations, 50 in [`LEAN_S`], has a standard deviation of 0.1.
const LEAN_LIMIT: f64 = 0.8;

/// Unexplained turn rates up to this, rad/s, may be a new bias of the gyro.
const LARGEST_BIAS_STEP_RADPS: f64 = 0.2;

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
    /// Whether the speed has been given up for want of encoders.
    released: bool,
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
    /// Speed, m/s, as of the newest encoder sample.
    settled_mps: f64,
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
            released: false,
            gyro_gate: Gate::new(ONE_NUMBER),
            encoder_gate: Gate::new(TWO_NUMBERS),
            at_odds: None,
            distrust_until: None,
            lean: 0.0,
            felt_mps2: 0.0,
            settled_mps: 0.0,
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
        self.released = false;

        let before = self.ekf.pose();
        let predicted_m = self.ekf.get(TRAVEL);
        let believed = self.hear_wheels(sample, &rolled, gyro_is_heard);
        self.felt_mps2 = (self.ekf.get(V) - self.settled_mps) / rolled.elapsed_s;
        self.settled_mps = self.ekf.get(V);
        self.odometer_m += if believed { counted[0] } else { predicted_m }.abs();
        self.fast = false;
        self.trail_on();
        let after = self.ekf.pose();
        let moved = Pose {
            x_m: after.x_m - before.x_m,
            y_m: after.y_m - before.y_m,
            theta_rad: after.theta_rad - before.theta_rad,
        };
        // The newest knot is where it should be; those before it go there by their share.
        self.trail.settle(since, moved);
    }

    /// The estimate as of the newest sample.
    pub fn estimate(&self) -> Estimate {
        Estimate {
            pose: self.ekf.pose(),
            v_mps: self.ekf.get(V),
            omega_radps: self.ekf.get(OMEGA),
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
        for stamp in [self.reached, self.gyro, self.gap_until, odds, self.distrust_until] {
            digest.word(u64::from(stamp.is_some()));
            if let Some(stamp) = stamp {
                digest.time(stamp, start);
            }
        }
        digest.numbers(&[self.at_odds.map_or(0.0, |(_, odds)| odds), self.lean, self.felt_mps2, self.settled_mps, self.odometer_m]);
        digest.word(u64::from(self.fast) << 1 | u64::from(self.released));
        self.gyro_gate.fold(digest);
        self.encoder_gate.fold(digest);
        self.health.fold(digest, start);
        self.trail.fold(digest, start);
    }
}

/// What the IMU tells.
impl Odometry {
    /// Turns the attitude on, by the gyro less its bias about z. The accelerometer is to show gravity
    /// alone: what the robot's own motion adds along an arc, v' ahead and v ω to the left, is taken off.
    fn orient(&mut self, sample: &ImuSample) {
        let elapsed_s = self.gyro.map_or(0.0, |before| sample.stamp.seconds_since(before));
        let [x, y, z] = sample.gyro_radps;
        let [ahead, left, up] = sample.accel_mps2;
        let outward_mps2 = self.ekf.get(V) * self.ekf.get(OMEGA);
        let at_rest = ImuSample {
            accel_mps2: [ahead - self.felt_mps2, left - outward_mps2, up],
            ..*sample
        };
        self.attitude.update(&at_rest, [x, y, z - self.ekf.get(BIAS)], elapsed_s);
    }

    /// Whether the gyro comes back after a gap that the encoders may still tell about.
    fn waits_for_the_wheels(&mut self, stamp: Time) -> bool {
        let Some(reached) = self.reached else { return false };
        if stamp.seconds_since(reached) <= GYRO_HOLD_S || self.wheels.newest().is_none() {
            self.gap_until = None;
            return false;
        }
        let back = *self.gap_until.get_or_insert(stamp);
        if stamp.seconds_since(back) <= GYRO_HOLD_S {
            return true;
        }
        self.gap_until = None;
        false
    }

    /// Gives up the speed where encoders have been silent for too long. It stays unknown, but the same
    /// from then on: when the counters are heard again, they tell how fast it was all along.
    fn release(&mut self, stamp: Time) {
        let silent = self.wheels.stamp().is_some_and(|at| stamp.seconds_since(at) > HOLD_S);
        if silent && !self.released {
            self.released = true;
            self.ekf.replace(V, 0.0, 1.0);
        }
    }

    /// The forward acceleration, m/s², where the accelerometer can be believed.
    fn forward_mps2(&mut self, sample: &ImuSample) -> Option<f64> {
        let elapsed_s = sample.stamp.seconds_since(self.reached?);
        if self.distrust_until.is_some_and(|until| sample.stamp < until)
            || elapsed_s > ACCEL_HOLD_S
            || self.released
        {
            return None;
        }
        let strongest = sample.accel_mps2.iter().fold(0.0, |most: f64, axis| most.max(axis.abs()));
        let known = sample.accel_mps2.iter().all(|axis| axis.is_finite());
        let plausible = known && (WEAKEST_MPS2..=STRONGEST_MPS2).contains(&strongest);
        plausible.then(|| sample.accel_mps2[0] - self.attitude.gravity_ahead_mps2())
    }

    /// Takes a turn rate in.
    fn hear_rate(&mut self, rate_radps: f64, stamp: Time) {
        let expected_radps = self.ekf.get(OMEGA) + self.ekf.get(BIAS);
        let z = Measurement {
            of: [(OMEGA, 1.0), (BIAS, 1.0)],
            innovation: rate_radps - expected_radps,
            variance: GYRO_SIGMA_RADPS * GYRO_SIGMA_RADPS,
        };
        let normalised = z.innovation * z.innovation / self.ekf.innovation_variance(&z);
        if self.gyro_gate.admits(normalised) {
            self.ekf.update(&z);
            return;
        }
        self.health.gyro_rejected = Some(stamp);
        if self.gyro_gate.in_a_row >= GYRO_IN_A_ROW {
            self.gyro_gate.in_a_row = 0;
            self.ekf.doubt(OMEGA, FASTEST_TURN_RADPS);
            self.ekf.update(&z);
            self.health.recovery = Some(stamp);
        }
    }
}

/// What the encoders tell.
impl Odometry {
    /// Without a gyro: what the counters say beyond what has been predicted already becomes the speeds
    /// of the time that is left up to `stamp`.
    fn drive(&mut self, counted: [f64; 2], since: Time, stamp: Time) {
        let left_s = self.reached.map_or(0.0, |reached| stamp.seconds_since(reached));
        if left_s <= 0.0 {
            return;
        }
        self.trail.forget_after(since);
        let gain = 1.0 + self.ekf.get(TURN_GAIN);
        let travel_m = counted[0] - self.ekf.get(TRAVEL);
        let turn_rad = (counted[1] - self.ekf.get(TURN)) / gain;
        self.ekf.replace(V, travel_m / left_s, 1.0);
        self.ekf.replace(OMEGA, turn_rad / left_s, 1.0);
    }

    /// Takes what the wheels did into the filter, which has reached their instant. False if it was not
    /// believed.
    fn hear_wheels(&mut self, sample: &EncoderSample, rolled: &Rolled, gyro_is_heard: bool) -> bool {
        let counted = rolled.travel_and_turn(self.track_m);
        let turned_rad = self.ekf.get(TURN) / (1.0 + self.ekf.get(TURN_GAIN));
        let dead = if gyro_is_heard {
            self.wheels.dead(rolled, turned_rad, self.track_m)
        } else {
            self.wheels.presume_alive();
            None
        };
        if rolled.jumped {
            self.encoder_gate.turn_away();
            self.health.slip = Some(sample.stamp);
            self.ekf.anchor();
            return false;
        }
        if let Some(side) = dead {
            self.health.dead = Some((sample.stamp, side));
            self.at_odds = None;
            return self.hear_one_wheel(sample, rolled, side);
        }
        if rolled.standing() && !self.fast {
            self.stand_still(counted);
            return true;
        }
        let [travel_variance, turn_variance] = self.ekf.counter_variances();
        let travel = Measurement::direct(TRAVEL, counted[0] - self.ekf.get(TRAVEL), travel_variance);
        let turn = Measurement::direct(TURN, counted[1] - self.ekf.get(TURN), turn_variance);
        if !self.encoder_gate.admits(self.ekf.together(&travel, &turn)) {
            self.turn_away(counted, turned_rad, sample, rolled);
            return false;
        }
        self.at_odds = None;
        self.notice_leaning(&turn, rolled.elapsed_s, sample.stamp);
        self.ekf.update(&travel);
        let turn = Measurement { innovation: counted[1] - self.ekf.get(TURN), ..turn };
        self.ekf.update(&turn);
        self.carry_on(counted);
        if let Some(v_mps) = reported_speed_mps(sample) {
            self.hear_speed(v_mps, [(V, 1.0), (V, 0.0)]);
        }
        true
    }

    /// The counters count from this sample on; what the filter knows beyond them it keeps.
    fn carry_on(&mut self, counted: [f64; 2]) {
        self.ekf.shift(TRAVEL, -counted[0]);
        self.ekf.shift(TURN, -counted[1]);
    }

    fn stand_still(&mut self, counted: [f64; 2]) {
        let [speed, rate, hold] = STANDING_SIGMAS.map(|sigma| sigma * sigma);
        for (of, wanted, variance) in [
            (TRAVEL, counted[0], hold),
            (TURN, counted[1], hold),
            (V, 0.0, speed),
            (OMEGA, 0.0, rate),
        ] {
            self.ekf.update(&Measurement::direct(of, wanted - self.ekf.get(of), variance));
        }
        self.encoder_gate.admits(0.0);
        self.at_odds = None;
        self.lean = 0.0;
        self.carry_on(counted);
    }

    /// One counter is dead: what the other one shows is ℓ ± ½ track φ.
    fn hear_one_wheel(&mut self, sample: &EncoderSample, rolled: &Rolled, dead: Side) -> bool {
        let (index, sign, speed_mps) = match dead {
            Side::Left => (1, 1.0, sample.right_mps),
            Side::Right => (0, -1.0, sample.left_mps),
        };
        let arm_m = 0.5 * sign * self.track_m;
        let shown_m = self.ekf.get(TRAVEL) + arm_m * self.ekf.get(TURN);
        let [travel_variance, _] = self.ekf.counter_variances();
        let z = Measurement {
            of: [(TRAVEL, 1.0), (TURN, arm_m)],
            innovation: rolled.by_m[index] - shown_m,
            variance: 2.0 * travel_variance,
        };
        let normalised = z.innovation * z.innovation / self.ekf.innovation_variance(&z);
        let believed = self.encoder_gate.admits(normalised);
        if believed {
            self.ekf.update(&z);
            if let Some(v_mps) = reported_mps(speed_mps) {
                let gain = 1.0 + self.ekf.get(TURN_GAIN);
                self.hear_speed(v_mps, [(V, 1.0), (OMEGA, arm_m * gain)]);
            }
        } else if self.encoder_gate.in_a_row > 50 {
            self.ekf.doubt(V, 1.0);
            self.health.recovery = Some(sample.stamp);
        }
        // What the two counters say of the turn is worth nothing: both count afresh.
        self.ekf.anchor();
        believed
    }

    /// A speed as the wheels report it.
    fn hear_speed(&mut self, v_mps: f64, of: [(usize, f64); 2]) {
        let expected_mps = of[0].1 * self.ekf.get(of[0].0) + of[1].1 * self.ekf.get(of[1].0);
        let sigma = SPEED_SIGMA_MPS + SPEED_SHARE * v_mps.abs();
        let z = Measurement { of, innovation: v_mps - expected_mps, variance: sigma * sigma };
        if z.innovation * z.innovation <= ONE_NUMBER * self.ekf.innovation_variance(&z) {
            self.ekf.update(&z);
        }
    }

    /// Counters that are not believed: what they counted since the last sample is left out. When that
    /// has gone on for too long, it is the filter that is wrong.
    fn turn_away(&mut self, counted: [f64; 2], turned_rad: f64, sample: &EncoderSample, rolled: &Rolled) {
        let stamp = sample.stamp;
        if self.encoder_gate.in_a_row > 1 {
            // One in a thousand good samples is turned away too.
            self.health.slip = Some(stamp);
        }
        let (since, odds_rad) = self.at_odds.unwrap_or((stamp, 0.0));
        let odds_rad = odds_rad + counted[1] - turned_rad;
        self.at_odds = Some((since, odds_rad));
        self.ekf.anchor();
        let lasted_s = stamp.seconds_since(since);
        if lasted_s < PATIENCE_S {
            return;
        }
        self.at_odds = None;
        self.lean = 0.0;
        self.health.recovery = Some(stamp);
        self.distrust_until = Some(stamp.after_ns((DISTRUST_S * 1e9) as u64));
        self.ekf.replace(V, counted[0] / rolled.elapsed_s, 0.01);
        if odds_rad.abs() <= LARGEST_BIAS_STEP_RADPS * lasted_s {
            self.ekf.doubt(BIAS, BIAS_SIGMA_RADPS);
        }
    }

    /// Sees whether the turn by the counters leans to one side of the turn by the gyro.
    fn notice_leaning(&mut self, turn: &Measurement, elapsed_s: f64, stamp: Time) {
        let sigma = libm::sqrt(self.ekf.innovation_variance(turn));
        self.lean += (turn.innovation / sigma - self.lean) * (elapsed_s / LEAN_S).min(1.0);
        if self.lean.abs() > LEAN_LIMIT {
            self.lean = 0.0;
            self.ekf.doubt(BIAS, BIAS_SIGMA_RADPS);
            self.health.bias = Some(stamp);
        }
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
        let held_s = if known { elapsed_s } else { elapsed_s.min(HOLD_S) };
        let (_, turn_rad) = self.ekf.predict(held_s, accel_mps2);
        self.odometer_m += TURNING_ARM_M * turn_rad.abs();
        if held_s < elapsed_s {
            self.ekf.replace(V, 0.0, 1.0);
            self.ekf.replace(OMEGA, 0.0, 1.0);
            self.ekf.predict(elapsed_s - held_s, None);
        }
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
