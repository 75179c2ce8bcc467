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
    pub(super) fn push(&mut self, at: Time, pose: Pose) {
        if self.knots.back().is_some_and(|newest| newest.at == at) {
            self.knots.pop_back();
        } else if self.knots.len() == KNOTS {
            self.knots.pop_front();
        }
        self.knots.push_back(Knot { at, pose });
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

    /// The pose of the newest knot has just been moved by `by`: moves the others after `since` by
    /// their share of that, as if the error had grown evenly.
    pub(super) fn settle(&mut self, since: Time, by: Pose) {
        let Some(newest) = self.knots.back().map(|newest| newest.at) else { return };
        let whole_s = newest.seconds_since(since);
        for knot in self.knots.iter_mut().rev().skip(1).take_while(|knot| knot.at > since) {
            let share = knot.at.seconds_since(since) / whole_s;
            knot.pose.x_m += share * by.x_m;
            knot.pose.y_m += share * by.y_m;
            knot.pose.theta_rad += share * by.theta_rad;
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
            trail.push(Time(10 * i), pose(i as f64));
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
        trail.push(Time(0), pose(0.0));
        trail.push(Time(10), pose(1.0));
        trail.push(Time(10), pose(2.0));
        assert_eq!(trail.pose_at(Time(5)), Some(pose(1.0)));
    }

    /// Ten and twenty milliseconds after the instant up to which all is known, the pose turns out to
    /// have been off by 4 cm and 0.2 rad, and is replaced: the knot halfway moves by half of that, what
    /// was before stays.
    #[test]
    fn knots_move_by_their_share() {
        let mut trail = Trail::new();
        for i in 0..4_u64 {
            trail.push(Time(10 * i), pose(1.0));
        }
        trail.settle(Time(10), Pose { x_m: 0.04, y_m: 0.0, theta_rad: -0.2 });
        assert_eq!(trail.pose_at(Time(10)), Some(pose(1.0)));
        let at = |t| trail.pose_at(Time(t)).expect("it is recent");
        assert_eq!((at(20).x_m, at(20).y_m, at(20).theta_rad), (1.02, -1.0, 1.9));
        assert_eq!(at(30), pose(1.0));
    }
}
