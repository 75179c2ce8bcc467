//! Where the robot will be, and how fast, when its next command takes effect.

use std::collections::VecDeque;

use schemas::{Plant, Span, Time};

use crate::digest::Digest;
use crate::safety::{Drive, Moving, arc};

/// Times longer than this are not predicted over, seconds: what is that old no longer counts. Commands are
/// kept until odometry this old has felt them.
const HORIZON_S: f64 = 0.5;

/// More commands than this are not kept: the longest delay and the horizon at 1 kHz.
const MOST: usize = 1_024;

/// Up to this speed, m/s, a robot under accelerations counts as all but at rest.
const NEAR_REST_MPS: f64 = 0.03;

/// An estimate of a robot all but at rest that is no farther than this, m/s, from what the commands have
/// made of an earlier one differs by its noise: that is some mm/s.
const NOISE_MPS: f64 = 0.01;

/// For so many seconds that noise is averaged: three samples of the wheels, chosen.
const NOISE_AVERAGED_S: f64 = 0.06;

/// Less than this, m/s, is rounding.
const ROUNDING_MPS: f64 = 1e-9;

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
    /// The forward speed, m/s, that the last command of accelerations was to find.
    found_mps: f64,
}

impl Underway {
    /// None yet; room for as many as the plant's delay and the horizon hold.
    pub(super) fn new(plant: Plant, control_period_s: f64) -> Underway {
        let delay_s = plant.actuator_delay_s.clamp(0.0, HORIZON_S);
        let held = libm::ceil((delay_s + HORIZON_S) / control_period_s);
        let most = (held as usize).min(MOST - 2) + 2;
        let delay = Span::from_seconds(delay_s);
        Underway { plant, delay, given: VecDeque::with_capacity(most), most, found_mps: f64::NAN }
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
    /// until the next one does, and at its speeds of then before the first of them. From what is older than
    /// half a second it moves on for that long at its speeds of then. Where no time passes nothing changes,
    /// not a bit.
    pub(super) fn foresee(&self, robot: &Moving, as_of: Time, now: Time) -> Moving {
        let mut robot = *robot;
        let finite = robot.speeds.iter().all(|speed| speed.is_finite());
        if !finite {
            return robot;
        }
        let mut reached = as_of.min(now);
        if now.since(reached) > Span::from_seconds(HORIZON_S) {
            robot.pose = arc(&robot.pose, robot.speeds, HORIZON_S);
            reached = now;
        }
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

    /// The forward speed that the command of `now` will find, where it has been foreseen from the estimate
    /// as `foreseen_mps`. To come to rest a command takes away all the speed that there is thought to be; a
    /// robot that is all but at rest would follow the noise of the estimate, one step after the other. So
    /// there the estimate only corrects, by and by, what the last command is known to have led to.
    pub(super) fn settled_mps(&mut self, foreseen_mps: f64, now: Time) -> f64 {
        let expected_mps = match self.given.back() {
            Some((at, Drive::Accelerations([forward, _]))) if *at < now => {
                self.found_mps + forward * now.since(*at).seconds()
            }
            _ => f64::NAN,
        };
        let off_mps = foreseen_mps - expected_mps;
        let noise = (ROUNDING_MPS..NOISE_MPS).contains(&libm::fabs(off_mps));
        self.found_mps = foreseen_mps;
        if noise
            && libm::fabs(foreseen_mps) < NEAR_REST_MPS
            && let Some((at, _)) = self.given.back()
        {
            let share = (now.since(*at).seconds() / NOISE_AVERAGED_S).min(1.0);
            self.found_mps = expected_mps + share * off_mps;
        }
        self.found_mps
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
        digest.number(self.found_mps);
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

    /// At 100 Hz, odometry that is 0.3 s late has felt none of the last thirty commands: 0.1 m/s for 0.15 s
    /// of them, 0.5 m/s for the other 0.15 s.
    #[test]
    fn late_odometry_has_felt_no_command_since() {
        let mut underway = Underway::new(Plant { actuator_delay_s: 0.1, ..Plant::default() }, 0.01);
        for step in 0..100 {
            let v_mps = if step < 75 { 0.1 } else { 0.5 };
            underway.give(at(0.01 * f64::from(step)), Drive::Velocities([v_mps, 0.0]));
        }
        let robot = Moving { pose: Pose::default(), speeds: [0.1, 0.0] };
        let end = underway.foresee(&robot, at(0.7), at(1.0)).pose;
        // The first 0.5 m/s was given at 0.75 s, felt from 0.85 s on; the end is at 1.1 s.
        assert!((end.x_m - (0.15 * 0.1 + 0.25 * 0.5)).abs() < 1e-9, "{end:?}");
    }

    /// What another clock gave never comes; what is half a second old or older counts as that old.
    #[test]
    fn clocks_may_be_set() {
        let robot = Moving { pose: Pose::default(), speeds: [0.1, 0.0] };
        let given = [(9.0, Drive::Velocities([0.7, 0.0]))];
        let end = underway(0.1, &given).foresee(&robot, at(-3.0), at(1.0));
        assert!((end.pose.x_m - 0.6 * 0.1).abs() < 1e-12, "{end:?}");
    }

    fn dynamic(found_mps: f64, forward_mps2: f64) -> Underway {
        let mut underway = underway(0.1, &[]);
        // Nothing is expected yet.
        assert_eq!(underway.settled_mps(found_mps, at(0.99)).to_bits(), found_mps.to_bits());
        underway.give(at(0.99), Drive::Accelerations([forward_mps2, 0.0]));
        underway
    }

    /// A command of −0.4 m/s² for 10 ms takes 4 mm/s to rest. 3 mm/s that are foreseen instead count for a
    /// sixth, 10 of 60 ms; what is no noise counts whole: more of it, or farther from rest, or next to none.
    #[test]
    fn a_robot_at_rest_does_not_follow_noise() {
        let settled =
            |found_mps, foreseen_mps| dynamic(found_mps, -0.4).settled_mps(foreseen_mps, at(1.0));
        assert!((settled(0.004, 0.003) - 0.0005).abs() < 1e-12);
        assert!((settled(0.004, -0.003) + 0.0005).abs() < 1e-12);
        assert_eq!(settled(0.004, 0.011), 0.011);
        assert_eq!(settled(0.044, 0.042), 0.042);
        assert_eq!(settled(0.004, 1e-12), 1e-12);
        assert!(settled(0.004, f64::NAN).is_nan());
        assert_eq!(settled(f64::NAN, 0.003), 0.003);
    }

    /// What lasts is believed: after 0.3 s of the same, five times the time it is averaged over, all but
    /// e⁻⁵ of it, and no command of velocities expects anything.
    #[test]
    fn what_lasts_is_no_noise() {
        let mut underway = dynamic(0.0, 0.0);
        for step in 100..130 {
            underway.settled_mps(0.005, at(0.01 * f64::from(step)));
            underway.give(at(0.01 * f64::from(step)), Drive::Accelerations([0.0, 0.0]));
        }
        let settled = underway.settled_mps(0.005, at(1.3));
        assert!((settled - 0.005).abs() < 0.005 * 0.007, "{settled}");
        underway.give(at(1.3), Drive::Velocities([0.0, 0.0]));
        assert_eq!(underway.settled_mps(0.009, at(1.31)), 0.009);
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
