//! Where the robot will be, and how fast, when its next command takes effect.

use std::collections::VecDeque;

use schemas::{Plant, Span, Time};

use crate::digest::Digest;
use crate::safety::{Drive, Moving, arc};

/// Times longer than this are not predicted over, seconds: what is that old no longer counts.
const HORIZON_S: f64 = 0.5;

/// More commands than this are never on their way at once.
const MOST: usize = 512;

/// The commands that are on their way to the wheels, or in force there.
#[derive(Clone, Debug)]
pub(super) struct Underway {
    plant: Plant,
    /// When each was given, the oldest first.
    given: VecDeque<(Time, Drive)>,
    /// How many there are room for.
    most: usize,
}

impl Underway {
    /// None yet; room for as many as the plant's delay holds.
    pub(super) fn new(plant: Plant, control_period_s: f64) -> Underway {
        let held = libm::ceil(plant.actuator_delay_s.clamp(0.0, HORIZON_S) / control_period_s);
        let most = (held as usize).min(MOST - 2) + 2;
        Underway { plant, given: VecDeque::with_capacity(most), most }
    }

    /// Takes note of a command.
    pub(super) fn give(&mut self, at: Time, drive: Drive) {
        if self.given.len() == self.most {
            self.given.pop_front();
        }
        self.given.push_back((at, drive));
    }

    /// The robot as the command of `now` will find it. `robot` is how it was `age_s` ago: it moves on
    /// along its speeds of then, and along the commands on their way for the plant's delay. Both times
    /// end at half a second. Without either nothing changes, not a bit.
    pub(super) fn foresee(&self, robot: &Moving, age_s: f64, now: Time) -> Moving {
        let mut robot = *robot;
        let finite = robot.speeds.iter().all(|speed| speed.is_finite());
        if !finite {
            return robot;
        }
        if age_s > 0.0 {
            robot.pose = arc(&robot.pose, robot.speeds, age_s.min(HORIZON_S));
        }
        let delay_s = self.plant.actuator_delay_s.min(HORIZON_S);
        let delay = Span::from_seconds(delay_s.max(0.0));
        // A command is in force from its delay on until that of the next one.
        let mut from_s = 0.0;
        for (index, (at, drive)) in self.given.iter().enumerate() {
            let until_s = match self.given.get(index + 1) {
                Some((next, _)) => (*next + delay).seconds_since(now).min(delay_s),
                None => delay_s,
            };
            if until_s <= from_s || *at > now {
                continue;
            }
            robot.speeds = drive.taken_up(&self.plant, robot.speeds);
            robot.advance(&self.plant, *drive, until_s - from_s);
            from_s = until_s;
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
        assert_eq!(underway(0.0, &[(0.9, drive)]).foresee(&robot, 0.0, at(1.0)), robot);
        assert_eq!(underway(0.0, &[]).foresee(&robot, f64::NAN, at(1.0)), robot);
        let blind = Moving { pose, speeds: [f64::NAN, 1.0] };
        assert_eq!(underway(0.1, &[(0.9, drive)]).foresee(&blind, 0.1, at(1.0)).pose, pose);
    }

    #[test]
    fn a_quarter_circle_ends_where_geometry_says() {
        // Radius v/ω = 0.5 m, a quarter turn to the left in 0.4 s.
        let omega = std::f64::consts::FRAC_PI_2 / 0.4;
        let robot = Moving { pose: Pose::default(), speeds: [0.5 * omega, omega] };
        let end = underway(0.0, &[]).foresee(&robot, 0.4, at(1.0)).pose;
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
        let end = underway(0.25, &given).foresee(&robot, 0.0, at(1.0));
        assert!((end.pose.x_m - (0.05 * 0.1 + 0.1 * 0.2 + 0.1 * 0.4)).abs() < 1e-12, "{end:?}");
        assert_eq!(end.speeds, [0.4, 0.0]);
    }

    /// Accelerations on their way change the speed that the next command finds.
    #[test]
    fn accelerations_lead_to_speeds() {
        let given = [(0.9, Drive::Accelerations([2.0, -6.0]))];
        let robot = Moving { pose: Pose::default(), speeds: [0.1, 0.0] };
        let end = underway(0.1, &given).foresee(&robot, 0.0, at(1.0));
        assert!((end.speeds[0] - 0.3).abs() < 1e-12 && (end.speeds[1] + 0.6).abs() < 1e-12);
        assert!((end.pose.x_m - 0.02).abs() < 1e-4, "{end:?}");
    }
}
