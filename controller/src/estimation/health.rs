//! What the estimator says about itself.

use schemas::{EstimatorStatus, Time};

use super::wheels::Side;
use crate::digest::Digest;

/// For how long something that is over is still said, seconds: longer than the longest usual control
/// period, so that a step sees it.
const SAID_FOR_S: f64 = 0.25;

/// Encoders silent for longer than this, seconds, are missing. Five samples at 50 Hz.
const ENCODERS_SILENT_S: f64 = 0.1;

/// A gyro silent for longer than this, seconds, leaves the heading to the wheels. Five samples of the
/// 100 Hz gyro.
pub(super) const GYRO_HOLD_S: f64 = 0.05;

/// When what last happened.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Health {
    pub(super) slip: Option<Time>,
    pub(super) dead: Option<(Time, Side)>,
    pub(super) bias: Option<Time>,
    pub(super) recovery: Option<Time>,
    pub(super) gyro_rejected: Option<Time>,
}

impl Health {
    /// The most telling thing that can be said at `now`, given when gyro and encoders were last heard.
    pub(super) fn status(
        &self,
        now: Time,
        gyro: Option<Time>,
        encoders: Option<Time>,
    ) -> EstimatorStatus {
        let within = |at: Option<Time>, s: f64| at.is_some_and(|at| now.seconds_since(at) <= s);
        let said = |at: Option<Time>| within(at, SAID_FOR_S);
        if gyro.is_none() && encoders.is_none() {
            EstimatorStatus::Unspecified
        } else if !within(encoders, ENCODERS_SILENT_S) {
            EstimatorStatus::EncodersMissing
        } else if !within(gyro, GYRO_HOLD_S) {
            EstimatorStatus::GyroMissing
        } else if let Some((_, side)) = self.dead.filter(|(at, _)| said(Some(*at))) {
            match side {
                Side::Left => EstimatorStatus::EncoderLeftDead,
                Side::Right => EstimatorStatus::EncoderRightDead,
            }
        } else if said(self.recovery) {
            EstimatorStatus::Recovering
        } else if said(self.bias) {
            EstimatorStatus::GyroBias
        } else if said(self.slip) {
            EstimatorStatus::Slip
        } else if said(self.gyro_rejected) {
            EstimatorStatus::GyroRejected
        } else {
            EstimatorStatus::Ok
        }
    }

    pub(super) fn fold(&self, digest: &mut Digest, start: Time) {
        let dead = self.dead.map(|(at, _)| at);
        for at in [self.slip, dead, self.bias, self.recovery, self.gyro_rejected] {
            digest.word(u64::from(at.is_some()));
            if let Some(at) = at {
                digest.time(at, start);
            }
        }
        digest.word(u64::from(self.dead.is_some_and(|(_, side)| side == Side::Left)));
    }
}
