//! What breaks, on a drive with every sensor: IMU with accelerometer at 100 Hz, encoders at 50 Hz, one
//! fault each. The robot stands for 0.4 s first.

use super::*;

/// How the robot moves and what is wrong, by the time since the start in milliseconds.
struct Drive {
    v_mps: f64,
    omega_radps: f64,
    /// What the gyro adds.
    gyro: fn(u64) -> f64,
    /// How much the wheels turn more than they should; left, then right.
    wheels: fn(u64) -> [f64; 2],
    /// What the accelerometer says of the forward acceleration.
    accel: fn(f64) -> f64,
}

impl Default for Drive {
    fn default() -> Drive {
        Drive {
            v_mps: 0.5,
            omega_radps: 0.0,
            gyro: |_| 0.0,
            wheels: |_| [1.0; 2],
            accel: |mps2| mps2,
        }
    }
}

/// What came of it.
struct Outcome {
    odometry: Odometry,
    /// What was said at some encoder sample, and at the last one before something else was said.
    said: Vec<(u64, EstimatorStatus)>,
    off_m: f64,
    off_rad: f64,
}

impl Outcome {
    fn said(&self, status: EstimatorStatus) -> bool {
        self.said.iter().any(|(_, said)| *said == status)
    }

    fn now(&self) -> EstimatorStatus {
        self.said.last().expect("something was said").1
    }
}

/// Speeds reach their values within 0.25 s, at 2 m/s² for 0.5 m/s.
fn drive(drive: &Drive, to_ms: u64) -> Outcome {
    let mut odometry = Odometry::new(Pose::default(), TRACK_M);
    let (mut pose, mut counted_m) = (Pose::default(), [0.0; 2]);
    let mut said: Vec<(u64, EstimatorStatus)> = Vec::new();
    let mut before = (0.0, 0.0);
    for t_ms in (0..=to_ms).step_by(10) {
        let share = (t_ms.saturating_sub(400) as f64 / 250.0).min(1.0);
        let (v, omega) = (share * drive.v_mps, share * drive.omega_radps);
        let step_s = if t_ms == 0 { 0.0 } else { 0.01 };
        let (mean_v, mean_omega) = (0.5 * (v + before.0), 0.5 * (omega + before.1));
        let forward_mps2 = if t_ms == 0 { 0.0 } else { (v - before.0) / step_s };
        before = (v, omega);
        let [along_x, along_y] = arc_s(pose.theta_rad, mean_omega, step_s);
        pose.x_m += mean_v * along_x;
        pose.y_m += mean_v * along_y;
        pose.theta_rad += mean_omega * step_s;
        let half_m = 0.5 * TRACK_M * mean_omega;
        let spin = (drive.wheels)(t_ms);
        counted_m[0] += spin[0] * (mean_v - half_m) * step_s;
        counted_m[1] += spin[1] * (mean_v + half_m) * step_s;
        odometry.imu(&ImuSample {
            stamp: at(t_ms),
            accel_mps2: [(drive.accel)(forward_mps2), v * omega, 9.81],
            gyro_radps: [0.0, 0.0, omega + (drive.gyro)(t_ms)],
            mag_ut: [0.0; 3],
        });
        if t_ms % 20 == 0 {
            let half_mps = 0.5 * TRACK_M * omega;
            odometry.encoders(&EncoderSample {
                stamp: at(t_ms),
                left_m: libm::floor(counted_m[0] * 1e3) * 1e-3,
                right_m: libm::floor(counted_m[1] * 1e3) * 1e-3,
                left_mps: spin[0] * (v - half_mps),
                right_mps: spin[1] * (v + half_mps),
            });
            let status = odometry.report(at(t_ms)).status;
            if said.last().is_none_or(|(_, before)| *before != status) {
                said.push((t_ms, status));
            }
        }
    }
    let estimate = odometry.estimate().pose;
    let off_m = libm::hypot(estimate.x_m - pose.x_m, estimate.y_m - pose.y_m);
    Outcome { odometry, said, off_m, off_rad: (estimate.theta_rad - pose.theta_rad).abs() }
}

/// Nothing is wrong, nothing is said. Of 5 s only the ticks are lost, and what a gyro cannot know while
/// the turn rate ramps up: half a sample of it, 0.8 · 0.005 = 0.004 rad.
#[test]
fn without_a_fault_all_is_well() {
    for omega_radps in [0.0, 0.8, -0.8] {
        let outcome = drive(&Drive { omega_radps, ..Drive::default() }, 5_400);
        assert_eq!(outcome.said, [(0, EstimatorStatus::Ok)]);
        assert!(
            outcome.off_m < 0.012 && outcome.off_rad < 0.006,
            "{} {}",
            outcome.off_m,
            outcome.off_rad
        );
        let report = outcome.odometry.report(at(5_400));
        assert_eq!((report.encoders_rejected, report.gyro_rejected), (0, 0));
        assert!(outcome.off_m < 3.0 * (report.sigma[0] + report.sigma[1]));
    }
}

/// One turn rate of 10 rad/s would turn the heading by 0.1 rad. It is turned away: nothing moves.
#[test]
fn a_wild_turn_rate_is_turned_away() {
    let wild = Drive { gyro: |t_ms| if t_ms == 2_010 { 10.0 } else { 0.0 }, ..Drive::default() };
    let (with, without) = (drive(&wild, 3_000), drive(&Drive::default(), 3_000));
    assert!((with.off_m - without.off_m).abs() < 1e-3 && with.off_rad < 1e-3);
    assert_eq!(with.odometry.report(at(3_000)).gyro_rejected, 1);
    assert!(with.said(EstimatorStatus::GyroRejected));
    assert_eq!(with.now(), EstimatorStatus::Ok);
}

/// A turn rate that goes on to be wild is believed after three samples: the robot is being spun. What
/// those three turned, 0.03 s · 10 rad/s, is made good from the wheels or lost.
#[test]
fn a_turn_rate_that_stays_wild_is_believed() {
    let spun = Drive { gyro: |t_ms| if t_ms > 2_000 { 10.0 } else { 0.0 }, ..Drive::default() };
    let outcome = drive(&spun, 2_200);
    assert!((outcome.odometry.estimate().omega_radps - 10.0).abs() < 0.5);
    assert!(outcome.odometry.report(at(2_200)).gyro_rejected <= 3);
}

/// Half a second in which the wheels turn twice as fast as the robot goes: 0.25 m too much. The first
/// sample of it, 20 ms and 0.01 m, may be believed, and the last half turned away, as much again.
#[test]
fn a_burst_of_slip_is_left_out() {
    for omega_radps in [0.0, 0.6] {
        let burst = Drive {
            omega_radps,
            wheels: |t_ms| if (2_001..=2_500).contains(&t_ms) { [2.0; 2] } else { [1.0; 2] },
            ..Drive::default()
        };
        let outcome = drive(&burst, 4_000);
        assert!(outcome.said(EstimatorStatus::Slip));
        assert_eq!(outcome.now(), EstimatorStatus::Ok);
        assert!(
            outcome.off_m < 0.02 && outcome.off_rad < 0.01,
            "{} {}",
            outcome.off_m,
            outcome.off_rad
        );
        let rejected = outcome.odometry.report(at(4_000)).encoders_rejected;
        assert!((24..=26).contains(&rejected), "{rejected} of 25");
    }
}

/// An accelerometer that is stuck contradicts the wheels when the robot starts. After a second the
/// wheels are believed: of 0.5 m/s at most that second is lost, and the speed is right.
#[test]
fn a_stuck_accelerometer_costs_a_second_at_most() {
    let outcome = drive(&Drive { accel: |_| 0.0, ..Drive::default() }, 6_000);
    assert!(outcome.off_m < 0.5 * 1.05, "{}", outcome.off_m);
    assert!((outcome.odometry.estimate().v_mps - 0.5).abs() < 0.01);
    assert_eq!(outcome.now(), EstimatorStatus::Ok);
}

/// The bias steps by 0.05 rad/s at 3 s. Until the wheels' turn leans by 0.8 of its deviation, and the new
/// bias is learnt, no more than a second goes by: 0.05 rad. Driving straight, that is all. In a steady
/// turn of 0.4 rad/s a gain κ, known to 0.05, explains a part as well: 0.02²/(0.02² + 0.05²) = 14 % of
/// the step stay wrong, 0.007 rad/s and 0.08 rad after 12 s. Not to notice would cost 0.6 rad.
#[test]
fn a_step_of_the_bias_is_noticed_and_learnt() {
    for (omega_radps, most_rad) in [(0.0, 0.05), (0.4, 0.05 + 0.085)] {
        let step = Drive {
            omega_radps,
            gyro: |t_ms| if t_ms >= 3_000 { 0.06 } else { 0.01 },
            ..Drive::default()
        };
        let outcome = drive(&step, 15_000);
        assert!(outcome.said(EstimatorStatus::GyroBias), "{:?}", outcome.said);
        assert_eq!(outcome.now(), EstimatorStatus::Ok);
        assert!(outcome.off_rad < most_rad, "{}", outcome.off_rad);
        let bias = outcome.odometry.gyro_bias_radps();
        assert!((bias - 0.06).abs() < 0.01, "{bias}");
    }
}

/// A counter stops at 2 s. The other one and the gyro tell the rest. Until 0.03 m are missed, 60 ms at
/// 0.5 m/s, the speed holds; no more than those 0.03 m are at stake. Believed, the dead counter would
/// halve the travel of 3 s, 0.75 m, and turn the heading by 1.5 m/0.5 m = 3 rad.
#[test]
fn a_dead_encoder_is_replaced_by_the_other_and_the_gyro() {
    let left: fn(u64) -> [f64; 2] = |t_ms| if t_ms > 2_000 { [0.0, 1.0] } else { [1.0; 2] };
    let right: fn(u64) -> [f64; 2] = |t_ms| if t_ms > 2_000 { [1.0, 0.0] } else { [1.0; 2] };
    for (wheels, status) in
        [(left, EstimatorStatus::EncoderLeftDead), (right, EstimatorStatus::EncoderRightDead)]
    {
        for omega_radps in [0.0, 0.6, -0.6] {
            let outcome = drive(&Drive { omega_radps, wheels, ..Drive::default() }, 5_000);
            assert_eq!(outcome.now(), status, "{:?}", outcome.said);
            assert!(outcome.off_m < 0.03, "{omega_radps}: {}", outcome.off_m);
            assert!(outcome.off_rad < 0.01, "{}", outcome.off_rad);
            assert!((outcome.odometry.estimate().v_mps - 0.5).abs() < 0.02);
            let noticed_ms = outcome.said.last().expect("it was said").0;
            assert!(noticed_ms <= 2_000 + 120, "{noticed_ms}");
        }
    }
}

/// The left counter is dead, the robot goes on at 0.4 m/s and turns faster and slower at 6 rad/s². Its right
/// wheel tells the mean of 20 ms, which is 0.25 m · 6 rad/s² · 10 ms = 15 mm/s behind. Taken for the wheel's
/// present speed, all of it would go into the travel. Half of it does: the filter holds each rate of the gyro
/// for its 10 ms, the middle of which is 5 ms ago.
#[test]
fn the_one_wheel_left_tells_a_mean_too() {
    let mut odometry = Odometry::new(Pose::default(), TRACK_M);
    let [mut turned_rad, mut omega_radps, mut before_rad, mut worst_mps] = [0.0_f64; 4];
    for t_ms in (0..=3_000).step_by(10) {
        let rate_radps2 = match t_ms {
            1_510..=1_700 | 2_110..=2_300 => 6.0,
            1_810..=2_000 | 2_410..=2_600 => -6.0,
            _ => 0.0,
        };
        let mean_radps = omega_radps + 0.5 * rate_radps2 * 0.01;
        if t_ms > 0 {
            turned_rad += mean_radps * 0.01;
            omega_radps += rate_radps2 * 0.01;
        }
        odometry.imu(&gyro(t_ms, omega_radps));
        if t_ms % 20 == 0 {
            let t_s = t_ms as f64 * 1e-3;
            let mean_radps = (turned_rad - before_rad) / 0.02;
            let mut sample = wheels(t_ms, 0.4 * t_s, turned_rad, 0.4, mean_radps);
            if t_ms > 1_000 {
                (sample.left_m, sample.left_mps) = (0.4, 0.0);
            }
            odometry.encoders(&sample);
            before_rad = turned_rad;
            if t_ms > 1_500 {
                worst_mps = worst_mps.max((odometry.estimate().v_mps - 0.4).abs());
            }
        }
    }
    assert_eq!(odometry.report(at(3_000)).status, EstimatorStatus::EncoderLeftDead);
    assert!(worst_mps < 0.0076, "{worst_mps}");
}

/// A robot that pivots about its left wheel does not move it: 0.25 m/s and 1 rad/s.
#[test]
fn a_wheel_that_is_turned_about_is_not_dead() {
    let pivot = Drive { v_mps: 0.25, omega_radps: 1.0, ..Drive::default() };
    let outcome = drive(&pivot, 5_000);
    assert_eq!(outcome.said, [(0, EstimatorStatus::Ok)]);
}

/// The counter lives again: so does the estimate.
#[test]
fn a_counter_may_come_back() {
    let wheels = |t_ms| if (2_001..=3_000).contains(&t_ms) { [0.0, 1.0] } else { [1.0; 2] };
    let outcome = drive(&Drive { wheels, ..Drive::default() }, 5_000);
    assert!(outcome.said(EstimatorStatus::EncoderLeftDead));
    assert_eq!(outcome.now(), EstimatorStatus::Ok);
    assert!(
        outcome.off_m < 0.03 && outcome.off_rad < 0.01,
        "{} {}",
        outcome.off_m,
        outcome.off_rad
    );
}

/// Every second second of the wheels is nonsense. The filter never loses its head: speeds and pose stay
/// those of a robot, and 20 ms of sense are enough to be right about the speed again.
#[test]
fn it_never_diverges() {
    let wheels = |t_ms| if t_ms / 1_000 % 2 == 1 { [-3.0, 2.0] } else { [1.0; 2] };
    let outcome = drive(&Drive { wheels, omega_radps: 0.3, ..Drive::default() }, 60_900);
    assert!(outcome.off_rad < 0.3, "{}", outcome.off_rad);
    // Believing the wheels of the bad half, v = −0.25, would cost 0.75 · 30 = 22 m.
    assert!(outcome.off_m < 5.0, "{}", outcome.off_m);
    assert!((outcome.odometry.estimate().v_mps - 0.5).abs() < 0.05);
    let report = outcome.odometry.report(at(60_900));
    assert!(report.encoders_rejected > 500);
    // Without wheels and accelerometer the speed is anyone's guess, jumps of 0.5 m/s in each of 100
    // samples: 5 m/s after a second, √⅓ · 5 m gone astray in it, √30 times that at the end.
    assert!(report.sigma.iter().all(|sigma| *sigma < 16.0), "{:?}", report.sigma);
}
