//! Where the robot was over the last second or so.

use std::collections::VecDeque;

use schemas::{Pose, Time};

use crate::digest::Digest;

/// How many instants are kept. Gyro (100 Hz) and encoders (50 Hz) share instants, so this is 1.28 s,
/// well over the 0.5 s after which a sonar reading counts as unknown (specification, section 10).
const KNOTS: usize = 128;

/// A pose with its instant.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Knot {
    at: Time,
    pose: Pose,
    /// The path that led there from the anchor of then, driven at unit speed, seconds.
    path_s: [f64; 2],
}

/// The newest poses, in order of time.
#[derive(Clone, Debug)]
pub(super) struct Trail {
    knots: VecDeque<Knot>,
}

impl Trail {
    pub(super) fn new() -> Trail {
        Trail { knots: VecDeque::with_capacity(KNOTS) }
    }

    /// Adds the pose at `at`, which is not before the newest knot; at the same instant it replaces it.
    pub(super) fn push(&mut self, at: Time, pose: Pose, path_s: [f64; 2]) {
        if self.knots.back().is_some_and(|newest| newest.at == at) {
            self.knots.pop_back();
        } else if self.knots.len() == KNOTS {
            self.knots.pop_front();
        }
        self.knots.push_back(Knot { at, pose, path_s });
    }

    /// Forgets everything.
    pub(super) fn clear(&mut self) {
        self.knots.clear();
    }

    /// Forgets what came after `at`.
    pub(super) fn forget_after(&mut self, at: Time) {
        while self.knots.back().is_some_and(|newest| newest.at > at) {
            self.knots.pop_back();
        }
    }

    /// Puts every knot after `since` where its path leads from `anchor_m` at `v_mps`. There the path
    /// ends: the next one starts at the newest knot.
    pub(super) fn settle(&mut self, since: Time, anchor_m: [f64; 2], v_mps: f64) {
        for knot in self.knots.iter_mut().rev().take_while(|knot| knot.at > since) {
            knot.pose.x_m = anchor_m[0] + v_mps * knot.path_s[0];
            knot.pose.y_m = anchor_m[1] + v_mps * knot.path_s[1];
            knot.path_s = [0.0; 2];
        }
    }

    /// The pose at `at`, between knots along the straight line; `None` before the oldest knot and
    /// after the newest.
    pub(super) fn pose_at(&self, at: Time) -> Option<Pose> {
        let mut later: Option<&Knot> = None;
        for knot in self.knots.iter().rev() {
            if knot.at <= at {
                let Some(later) = later else {
                    return (knot.at == at).then_some(knot.pose);
                };
                let share = at.seconds_since(knot.at) / later.at.seconds_since(knot.at);
                let between = |from: f64, to: f64| from + share * (to - from);
                return Some(Pose {
                    x_m: between(knot.pose.x_m, later.pose.x_m),
                    y_m: between(knot.pose.y_m, later.pose.y_m),
                    theta_rad: between(knot.pose.theta_rad, later.pose.theta_rad),
                });
            }
            later = Some(knot);
        }
        None
    }

    pub(super) fn fold(&self, digest: &mut Digest, start: Time) {
        for knot in &self.knots {
            digest.time(knot.at, start);
            digest.pose(&knot.pose);
            digest.numbers(&knot.path_s);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose(x_m: f64) -> Pose {
        Pose { x_m, y_m: -x_m, theta_rad: 2.0 * x_m }
    }

    /// The ring keeps the newest 128 instants, whatever came before, and interpolates in between.
    #[test]
    fn the_newest_instants_are_kept() {
        let mut trail = Trail::new();
        assert_eq!(trail.pose_at(Time(0)), None);
        for i in 0..1000_u64 {
            trail.push(Time(10 * i), pose(i as f64), [0.0; 2]);
        }
        assert_eq!(trail.pose_at(Time(9990)), Some(pose(999.0)));
        assert_eq!(trail.pose_at(Time(9991)), None);
        assert_eq!(trail.pose_at(Time(9985)), Some(pose(998.5)));
        assert_eq!(trail.pose_at(Time(10 * 872)), Some(pose(872.0)));
        assert_eq!(trail.pose_at(Time(10 * 872 - 1)), None);
    }

    /// A second pose at the newest instant replaces the first.
    #[test]
    fn the_same_instant_is_replaced() {
        let mut trail = Trail::new();
        trail.push(Time(0), pose(0.0), [0.0; 2]);
        trail.push(Time(10), pose(1.0), [0.0; 2]);
        trail.push(Time(10), pose(2.0), [0.0; 2]);
        assert_eq!(trail.pose_at(Time(5)), Some(pose(1.0)));
    }

    /// Two samples after the anchor, whose paths are 10 and 20 ms long, turn out to have been driven
    /// at 0.5 m/s from (3, 0); what was before stays.
    #[test]
    fn knots_move_to_where_their_path_leads() {
        let mut trail = Trail::new();
        for i in 0..4_u64 {
            let path_s = if i < 2 { [0.0; 2] } else { [0.0, 0.01 * (i - 1) as f64] };
            trail.push(Time(10 * i), pose(0.0), path_s);
        }
        trail.settle(Time(10), [3.0, 0.0], 0.5);
        assert_eq!(trail.pose_at(Time(10)), Some(pose(0.0)));
        let position = |at| trail.pose_at(at).map(|pose| pose.position_m());
        assert_eq!(position(Time(20)), Some([3.0, 0.005]));
        assert_eq!(position(Time(30)), Some([3.0, 0.01]));
    }
}
