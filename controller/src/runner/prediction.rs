//! Where the robot will be, and how fast, when its next command takes effect.

use std::collections::VecDeque;

use schemas::{Plant, Span, Time};

use crate::digest::Digest;
use crate::safety::{Drive, Moving, arc};

/// Times longer than this are not predicted over, seconds: what is that old no longer counts.
const HORIZON_S: f64 = 0.5;

/// Commands are kept until odometry this old, seconds, has felt them; two samples of the slowest sensor.
const CATCHING_UP_S: f64 = 0.05;

/// More commands than this are never on their way at once.
const MOST: usize = 512;

/// The commands that are on their way to the wheels, or in force there.
#[derive(Clone, Debug)]
pub(super) struct Underway {
    plant: Plant,
    /// From its being given to its taking effect.
    delay: Span,
    /// When each was given, the oldest first.
    given: VecDeque<(Time, Drive)>,
    /// How many there are room for.
    most: usize,
}

impl Underway {
    /// None yet; room for as many as the plant's delay holds.
    pub(super) fn new(plant: Plant, control_period_s: f64) -> Underway {
        let delay_s = plant.actuator_delay_s.clamp(0.0, HORIZON_S);
        let held = libm::ceil((delay_s + CATCHING_UP_S) / control_period_s);
        let most = (held as usize).min(MOST - 2) + 2;
        let delay = Span::from_seconds(delay_s);
        Underway { plant, delay, given: VecDeque::with_capacity(most), most }
    }

    /// Takes note of a command.
    pub(super) fn give(&mut self, at: Time, drive: Drive) {
        if self.given.len() == self.most {
            self.given.pop_front();
        }
        self.given.push_back((at, drive));
    }

    /// The robot as the command of `now` will find it: `robot` is how it was at `as_of`. From there it
    /// moves on along the commands that were given, each from the instant at which it takes effect
    /// until the next one does, and at its speeds of then before the first of them. What is older than
    /// half a second counts as half a second old. Where no time passes nothing changes, not a bit.
    pub(super) fn foresee(&self, robot: &Moving, as_of: Time, now: Time) -> Moving {
        let mut robot = *robot;
        let finite = robot.speeds.iter().all(|speed| speed.is_finite());
        if !finite {
            return robot;
        }
        let oldest = Time(now.0.saturating_sub(Span::from_seconds(HORIZON_S).0));
        let mut reached = as_of.clamp(oldest, now);
        let end = now + self.delay;
        // What was given after now was given by another clock.
        let mut coming = self.given.iter().filter(|(at, _)| *at <= now).peekable();
        let first = coming.peek().map_or(end, |(at, _)| *at + self.delay);
        robot.pose = arc(&robot.pose, robot.speeds, first.min(end).since(reached).seconds());
        reached = reached.max(first);
        while let Some((_, drive)) = coming.next() {
            let until = coming.peek().map_or(end, |(at, _)| *at + self.delay).min(end);
            if until > reached {
                robot.speeds = drive.taken_up(&self.plant, robot.speeds);
                robot.advance(&self.plant, *drive, until.since(reached).seconds());
                reached = until;
            }
        }
        robot
    }

    pub(super) fn fold(&self, digest: &mut Digest, start: Time) {
        for (at, drive) in &self.given {
            digest.time(*at, start);
            let (kind, numbers) = match drive {
                Drive::Velocities(velocities) => (0, velocities),
                Drive::Accelerations(accelerations) => (1, accelerations),
            };
            digest.word(kind);
            digest.numbers(numbers);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use schemas::Pose;

    const START: Time = Time(1_000_000_000_000);

    fn at(t_s: f64) -> Time {
        START + Span::from_seconds(t_s)
    }

    fn underway(delay_s: f64, given: &[(f64, Drive)]) -> Underway {
        let plant = Plant { actuator_delay_s: delay_s, ..Plant::default() };
        let mut underway = Underway::new(plant, 0.1);
        for (t_s, drive) in given {
            underway.give(at(*t_s), *drive);
        }
        underway
    }

    #[test]
    fn no_time_changes_no_bit() {
        let pose = Pose { x_m: 0.1, y_m: -0.0, theta_rad: 7.3 };
        let robot = Moving { pose, speeds: [0.5, 1.0] };
        let drive = Drive::Velocities([0.3, 2.0]);
        assert_eq!(underway(0.0, &[(0.9, drive)]).foresee(&robot, at(1.0), at(1.0)), robot);
        // A clock that is ahead.
        assert_eq!(underway(0.0, &[]).foresee(&robot, at(1.1), at(1.0)), robot);
        let blind = Moving { pose, speeds: [f64::NAN, 1.0] };
        assert_eq!(underway(0.1, &[(0.9, drive)]).foresee(&blind, at(0.9), at(1.0)).pose, pose);
    }

    #[test]
    fn a_quarter_circle_ends_where_geometry_says() {
        // Radius v/ω = 0.5 m, a quarter turn to the left in 0.4 s.
        let omega = std::f64::consts::FRAC_PI_2 / 0.4;
        let robot = Moving { pose: Pose::default(), speeds: [0.5 * omega, omega] };
        let end = underway(0.0, &[]).foresee(&robot, at(0.6), at(1.0)).pose;
        assert!((end.x_m - 0.5).abs() < 1e-12 && (end.y_m - 0.5).abs() < 1e-12, "{end:?}");
    }

    /// Three commands fill a delay of 0.25 s: what is left of the oldest, and two whole periods.
    #[test]
    fn every_command_on_its_way_counts() {
        let straight = |v: f64| Drive::Velocities([v, 0.0]);
        let given = [
            (0.6, straight(9.0)),
            (0.7, straight(0.1)),
            (0.8, straight(0.2)),
            (0.9, straight(0.4)),
        ];
        let robot = Moving { pose: Pose::default(), speeds: [0.1, 0.0] };
        let end = underway(0.25, &given).foresee(&robot, at(1.0), at(1.0));
        assert!((end.pose.x_m - (0.05 * 0.1 + 0.1 * 0.2 + 0.1 * 0.4)).abs() < 1e-12, "{end:?}");
        assert_eq!(end.speeds, [0.4, 0.0]);
    }

    /// The first command ever given, 0.1 s ago with a delay of 0.25 s, does nothing for another 0.15 s:
    /// until then the robot goes on as it does. Of the delay 0.1 s are left for it.
    #[test]
    fn the_first_command_waits_for_its_turn() {
        let given = [(0.9, Drive::Velocities([0.4, 0.0]))];
        let robot = Moving { pose: Pose::default(), speeds: [0.1, 0.0] };
        let end = underway(0.25, &given).foresee(&robot, at(1.0), at(1.0));
        assert!((end.pose.x_m - (0.15 * 0.1 + 0.1 * 0.4)).abs() < 1e-12, "{end:?}");
        assert_eq!(end.speeds, [0.4, 0.0]);
        let standing = underway(0.25, &[]).foresee(&robot, at(1.0), at(1.0));
        assert!((standing.pose.x_m - 0.25 * 0.1).abs() < 1e-12, "{standing:?}");
    }

    /// Odometry of 0.06 s ago has felt neither the command that took effect 0.02 s ago nor any later one.
    #[test]
    fn old_odometry_has_not_felt_what_came_since() {
        let straight = |v: f64| Drive::Velocities([v, 0.0]);
        let given = [(0.78, straight(0.1)), (0.88, straight(0.2)), (0.98, straight(0.4))];
        let robot = Moving { pose: Pose::default(), speeds: [0.1, 0.0] };
        let end = underway(0.1, &given).foresee(&robot, at(0.94), at(1.0));
        let expected_m = 0.04 * 0.1 + 0.1 * 0.2 + 0.02 * 0.4;
        assert!((end.pose.x_m - expected_m).abs() < 1e-12, "{end:?}");
    }

    /// What another clock gave never comes; what is half a second old or older counts as that old.
    #[test]
    fn clocks_may_be_set() {
        let robot = Moving { pose: Pose::default(), speeds: [0.1, 0.0] };
        let given = [(9.0, Drive::Velocities([0.7, 0.0]))];
        let end = underway(0.1, &given).foresee(&robot, at(-3.0), at(1.0));
        assert!((end.pose.x_m - 0.6 * 0.1).abs() < 1e-12, "{end:?}");
    }

    /// Accelerations on their way change the speed that the next command finds.
    #[test]
    fn accelerations_lead_to_speeds() {
        let given = [(0.9, Drive::Accelerations([2.0, -6.0]))];
        let robot = Moving { pose: Pose::default(), speeds: [0.1, 0.0] };
        let end = underway(0.1, &given).foresee(&robot, at(1.0), at(1.0));
        assert!((end.speeds[0] - 0.3).abs() < 1e-12 && (end.speeds[1] + 0.6).abs() < 1e-12);
        assert!((end.pose.x_m - 0.02).abs() < 1e-4, "{end:?}");
    }
}
