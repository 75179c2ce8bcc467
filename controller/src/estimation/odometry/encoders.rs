//! What the encoders tell.

use schemas::{EncoderSample, Time};

use super::Odometry;
use crate::digest::Digest;
use crate::estimation::ekf::{
    BIAS, BIAS_SIGMA_RADPS, Ekf, Measurement, OMEGA, TRAVEL, TURN, TURN_GAIN, V,
};
use crate::estimation::gate::ONE_NUMBER;
use crate::estimation::wheels::{Rolled, Side, reported_mps, reported_speed_mps};

/// How well standing wheels say that the robot stands: m/s, rad/s, and metres or radians.
const STANDING_SIGMAS: [f64; 3] = [1e-3, 1e-3, 1e-5];

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

/// How well a reported speed is the mean since the last sample, m/s, where the accelerometer tells how the
/// speed changed meanwhile: its 0.3 m/s² for half of 20 ms.
const FELT_SIGMA_MPS: f64 = 0.003;

/// And a share of the speed: what the wheels slip.
const SPEED_SHARE: f64 = 0.02;

/// And a share of the change of speed meanwhile: between the mean over 20 ms of a jump and that of a ramp of
/// the same middle lies none of it, of a ramp over one of the accelerometer's 10 ms and a jump at their end a
/// quarter.
const CHANGE_SHARE: f64 = 0.15;

/// Where the accelerometer tells nothing the speed may change by so much more, m/s²: half of what the plant
/// can do.
const UNFELT_MPS2: f64 = 1.0;

/// A reported speed is never worse than this, m/s, but for those shares.
pub(super) const SPEED_SIGMA_MPS: f64 = 0.01;

/// Speeds are means over no more than this, seconds: two samples.
const MEAN_S: f64 = 0.05;

/// The present speed of a place of the robot as the filter has it, beside its mean since the last encoder
/// sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lead {
    /// By how much it is more than the mean, m/s.
    ahead_mps: f64,
    /// How well the mean is known, m/s.
    sigma_mps: f64,
}

/// What the filter held once it had heard an encoder sample.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Settled {
    /// Forward speed, m/s, and turn rate as the counters see it, rad/s.
    speeds: [f64; 2],
    /// What the counters should have shown beyond their reading then: metres, radians.
    told: [f64; 2],
}

impl Settled {
    pub(super) fn of(ekf: &Ekf) -> Settled {
        let gain = 1.0 + ekf.get(TURN_GAIN);
        Settled {
            speeds: [ekf.get(V), gain * ekf.get(OMEGA)],
            told: [ekf.get(TRAVEL), ekf.get(TURN)],
        }
    }

    /// Forward speed, m/s.
    pub(super) fn v_mps(&self) -> f64 {
        self.speeds[0]
    }

    pub(super) fn fold(&self, digest: &mut Digest) {
        digest.numbers(&self.speeds);
        digest.numbers(&self.told);
    }
}

impl Odometry {
    /// Without a gyro: what the counters say beyond what has been predicted already becomes the speeds
    /// of the time that is left up to `stamp`.
    pub(super) fn drive(&mut self, counted: [f64; 2], since: Time, stamp: Time) {
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

    /// How the speed of a place `arm_m` to the right of the robot's middle has changed since the last encoder
    /// sample, `elapsed_s` ago, by what the filter, which has reached the present one, made of it.
    pub(super) fn lead(&self, arm_m: f64, elapsed_s: f64) -> Lead {
        if elapsed_s > MEAN_S || self.released.is_some() {
            return Lead { ahead_mps: 0.0, sigma_mps: SPEED_SIGMA_MPS };
        }
        let there = |[ahead, turning]: [f64; 2]| ahead + arm_m * turning;
        let now = Settled::of(&self.ekf);
        let mean_mps = (there(now.told) - there(self.settled.told)) / elapsed_s;
        let changed_mps = there(now.speeds) - there(self.settled.speeds);
        let unfelt_mps = (UNFELT_MPS2 * self.unfelt_s).min(SPEED_SIGMA_MPS - FELT_SIGMA_MPS);
        let sigma_mps = FELT_SIGMA_MPS + unfelt_mps + CHANGE_SHARE * changed_mps.abs();
        Lead { ahead_mps: there(now.speeds) - mean_mps, sigma_mps }
    }

    /// Takes what the wheels did into the filter, which has reached their instant. False if it was not
    /// believed.
    pub(super) fn hear_wheels(
        &mut self,
        sample: &EncoderSample,
        rolled: &Rolled,
        gyro_is_heard: bool,
    ) -> bool {
        let counted = rolled.travel_and_turn(self.track_m);
        let turned_rad = self.ekf.get(TURN) / (1.0 + self.ekf.get(TURN_GAIN));
        if rolled.jumped {
            self.encoder_gate.turn_away();
            self.health.slip = Some(sample.stamp);
            self.ekf.anchor();
            return false;
        }
        let dead = if gyro_is_heard {
            self.wheels.dead(rolled, turned_rad, self.track_m)
        } else {
            self.wheels.presume_alive();
            None
        };
        if let Some(side) = dead {
            self.health.dead = Some((sample.stamp, side));
            self.at_odds = None;
            return self.hear_one_wheel(sample, rolled, side);
        }
        if rolled.standing() && !self.fast {
            self.stand_still(counted);
            return true;
        }
        let lead = self.lead(0.0, rolled.elapsed_s);
        let [travel_variance, turn_variance] = self.ekf.counter_variances();
        let travel =
            Measurement::direct(TRAVEL, counted[0] - self.ekf.get(TRAVEL), travel_variance);
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
            self.hear_speed(v_mps, [(V, 1.0), (V, 0.0)], lead);
        }
        true
    }

    /// The counters count from this sample on; what the filter knows beyond them it keeps.
    pub(super) fn carry_on(&mut self, counted: [f64; 2]) {
        self.ekf.shift(TRAVEL, -counted[0]);
        self.ekf.shift(TURN, -counted[1]);
    }

    pub(super) fn stand_still(&mut self, counted: [f64; 2]) {
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
    pub(super) fn hear_one_wheel(
        &mut self,
        sample: &EncoderSample,
        rolled: &Rolled,
        dead: Side,
    ) -> bool {
        let (index, sign, speed_mps) = match dead {
            Side::Left => (1, 1.0, sample.right_mps),
            Side::Right => (0, -1.0, sample.left_mps),
        };
        let arm_m = 0.5 * sign * self.track_m;
        let lead = self.lead(arm_m, rolled.elapsed_s);
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
                self.hear_speed(v_mps, [(V, 1.0), (OMEGA, arm_m * gain)], lead);
            }
        } else if self.encoder_gate.in_a_row > 50 {
            self.ekf.doubt(V, 1.0);
            self.health.recovery = Some(sample.stamp);
        }
        // What the two counters say of the turn is worth nothing: both count afresh.
        self.ekf.anchor();
        believed
    }

    /// A speed as the wheels report it: the mean since their last sample.
    pub(super) fn hear_speed(&mut self, v_mps: f64, of: [(usize, f64); 2], lead: Lead) {
        let expected_mps = of[0].1 * self.ekf.get(of[0].0) + of[1].1 * self.ekf.get(of[1].0);
        let sigma = lead.sigma_mps + SPEED_SHARE * v_mps.abs();
        let innovation = v_mps + lead.ahead_mps - expected_mps;
        let z = Measurement { of, innovation, variance: sigma * sigma };
        if z.innovation * z.innovation <= ONE_NUMBER * self.ekf.innovation_variance(&z) {
            self.ekf.update(&z);
        }
    }

    /// Counters that are not believed: what they counted since the last sample is left out. When that
    /// has gone on for too long, it is the filter that is wrong.
    pub(super) fn turn_away(
        &mut self,
        counted: [f64; 2],
        turned_rad: f64,
        sample: &EncoderSample,
        rolled: &Rolled,
    ) {
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
    pub(super) fn notice_leaning(&mut self, turn: &Measurement, elapsed_s: f64, stamp: Time) {
        let sigma = libm::sqrt(self.ekf.innovation_variance(turn));
        self.lean += (turn.innovation / sigma - self.lean) * (elapsed_s / LEAN_S).min(1.0);
        if self.lean.abs() > LEAN_LIMIT {
            self.lean = 0.0;
            self.ekf.doubt(BIAS, BIAS_SIGMA_RADPS);
            self.health.bias = Some(stamp);
        }
    }
}
