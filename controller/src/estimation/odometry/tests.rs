//! Contract: on motion that a unicycle can make, the estimate equals the closed form; gaps are bridged;
//! nonsense is ignored; faults are said and cost no more than they must; nothing panics.
//!
//! Closed form of constant v and ω from the origin: x = (v/ω) sin ωt, y = (v/ω)(1 − cos ωt), θ = ωt;
//! the wheels travel (v ∓ ω·track/2)t.

mod faults;

use proptest::prelude::*;
use schemas::SIMULATION_EPOCH;

use super::*;

const TRACK_M: f64 = 0.5;

fn at(t_ms: u64) -> Time {
    SIMULATION_EPOCH.after_ns(t_ms * 1_000_000)
}

fn gyro(t_ms: u64, rate_radps: f64) -> ImuSample {
    ImuSample { stamp: at(t_ms), gyro_radps: [0.0, 0.0, rate_radps], ..ImuSample::default() }
}

/// Wheels of a robot that has gone `along_m` and turned `turned_rad` since the start.
fn wheels(t_ms: u64, along_m: f64, turned_rad: f64, v_mps: f64, omega_radps: f64) -> EncoderSample {
    let half_m = 0.5 * TRACK_M;
    EncoderSample {
        stamp: at(t_ms),
        left_m: along_m - half_m * turned_rad,
        right_m: along_m + half_m * turned_rad,
        left_mps: v_mps - half_m * omega_radps,
        right_mps: v_mps + half_m * omega_radps,
    }
}

fn on_arc(v_mps: f64, omega_radps: f64, t_ms: u64) -> Pose {
    let turned = omega_radps * t_ms as f64 * 1e-3;
    let radius_m = v_mps / omega_radps;
    Pose {
        x_m: radius_m * libm::sin(turned),
        y_m: radius_m * (1.0 - libm::cos(turned)),
        theta_rad: turned,
    }
}

/// Drives an arc for `to_ms` with the gyro at 100 Hz and the encoders at 50 Hz, less what the
/// filters leave out.
fn drive_arc(
    v: f64,
    omega: f64,
    to_ms: u64,
    gyro_heard: impl Fn(u64) -> bool,
    encoders_heard: impl Fn(u64) -> bool,
) -> Odometry {
    let mut odometry = Odometry::new(Pose::default(), TRACK_M);
    for t_ms in (0..=to_ms).step_by(10) {
        if gyro_heard(t_ms) {
            odometry.imu(&gyro(t_ms, omega));
        }
        if t_ms % 20 == 0 && encoders_heard(t_ms) {
            let t = t_ms as f64 * 1e-3;
            odometry.encoders(&wheels(t_ms, v * t, omega * t, v, omega));
        }
    }
    odometry
}

#[track_caller]
fn assert_near(actual: Pose, wanted: Pose, tolerance: f64) {
    let off = (actual.x_m - wanted.x_m)
        .abs()
        .max((actual.y_m - wanted.y_m).abs())
        .max((actual.theta_rad - wanted.theta_rad).abs());
    assert!(off <= tolerance, "{actual:?} is {off} from {wanted:?}");
}

#[test]
fn an_arc_is_followed_exactly() {
    for (v, omega) in [(0.5, 0.8), (-0.3, 1.7), (0.7, -2.0), (0.4, 1e-7)] {
        let odometry = drive_arc(v, omega, 10_000, |_| true, |_| true);
        let estimate = odometry.estimate();
        assert_near(estimate.pose, on_arc(v, omega, 10_000), 1e-9);
        assert!((estimate.v_mps - v).abs() < 1e-12 && (estimate.omega_radps - omega).abs() < 1e-12);
        assert_eq!(estimate.stamp, Some(at(10_000)));
    }
}

/// Speeding up at 2 m/s² and braking again to rest: wheels tell the mean of 20 ms, which is 0.02 m/s behind,
/// and the accelerometer what came since. Where all tell the truth, the estimate is the truth.
#[test]
fn reported_speeds_are_means_since_the_last_sample() {
    let mut odometry = Odometry::new(Pose::default(), TRACK_M);
    let [mut along_m, mut v_mps, mut before_m] = [0.0_f64; 3];
    for t_ms in (0..=900).step_by(10) {
        let accel_mps2 = match t_ms {
            110..=400 => 2.0,
            510..=800 => -2.0,
            _ => 0.0,
        };
        if t_ms > 0 {
            along_m += v_mps * 0.01 + 0.5 * accel_mps2 * 1e-4;
            v_mps += accel_mps2 * 0.01;
        }
        odometry.imu(&ImuSample { accel_mps2: [accel_mps2, 0.0, 9.81], ..gyro(t_ms, 0.0) });
        if t_ms % 20 == 0 {
            let mean_mps = if t_ms > 0 { (along_m - before_m) / 0.02 } else { 0.0 };
            odometry.encoders(&wheels(t_ms, along_m, 0.0, mean_mps, 0.0));
            before_m = along_m;
            let off_mps = odometry.estimate().v_mps - v_mps;
            assert!(off_mps.abs() < 1e-9, "{t_ms} ms: {off_mps}");
        }
    }
}

/// Blind for 0.9 s on an arc of 0.8 rad/s. For the first 0.2 s the speed of before holds. The 0.35 m
/// and 0.576 rad of the rest the counters tell of afterwards; the filter lays them along a mean
/// direction of that time, which the chord's own is within ± a quarter of the turn of: 0.35 · 0.144 =
/// 0.05 m. Poses in between lie on the chord, whose sagitta is 0.35 · 0.576/8 = 0.025 m.
#[test]
fn a_gap_in_the_encoders_is_bridged_by_counters_and_gyro() {
    let odometry = drive_arc(0.5, 0.8, 2_000, |_| true, |t| !(600..1_500).contains(&t));
    assert_near(odometry.estimate().pose, on_arc(0.5, 0.8, 2_000), 0.05);
    assert!((odometry.estimate().pose.theta_rad - 1.6).abs() < 1e-9);
    assert_near(odometry.pose_at(at(1_230)).unwrap(), on_arc(0.5, 0.8, 1_230), 0.05 + 0.025);
    assert_eq!(odometry.report(at(2_000)).encoders_rejected, 0);
    let blind = drive_arc(0.5, 0.8, 1_400, |_| true, |t| t < 600);
    assert_eq!(blind.report(at(1_400)).status, EstimatorStatus::EncodersMissing);
}

#[test]
fn without_a_gyro_the_wheels_give_the_heading() {
    let never = drive_arc(0.5, 0.8, 2_000, |_| false, |_| true);
    let fell_silent = drive_arc(0.5, 0.8, 2_000, |t| t < 700, |_| true);
    let paused = drive_arc(0.5, 0.8, 2_000, |t| !(700..1_000).contains(&t), |_| true);
    for odometry in [never, fell_silent, paused] {
        assert_near(odometry.estimate().pose, on_arc(0.5, 0.8, 2_000), 1e-9);
        assert!((odometry.estimate().omega_radps - 0.8).abs() < 1e-9);
    }
}

#[test]
fn a_gap_in_both_is_bridged_by_the_counters() {
    let heard = |t: u64| !(500..1_500).contains(&t);
    let odometry = drive_arc(0.5, 0.8, 2_000, heard, heard);
    assert_near(odometry.estimate().pose, on_arc(0.5, 0.8, 2_000), 1e-9);
}

#[test]
fn during_a_gap_the_speed_holds_for_a_fifth_of_a_second() {
    // Straight ahead at 0.5 m/s; the encoders fall silent after 1 s, the gyro goes on.
    let odometry = drive_arc(0.5, 0.0, 3_000, |_| true, |t| t <= 1_000);
    let estimate = odometry.estimate();
    assert_eq!(estimate.stamp, Some(at(1_000)));
    assert_near(estimate.pose, Pose { x_m: 0.5 + 0.5 * 0.2, ..Pose::default() }, 1e-12);
}

#[test]
fn the_pose_of_any_recent_instant_is_known() {
    let odometry = drive_arc(0.5, 0.8, 2_000, |_| true, |_| true);
    for t_ms in [900, 1_003, 1_990, 1_995, 2_000] {
        // Between samples 10 ms apart the chord misses the arc by v·ω·(10 ms)²/8 = 5e-6 m.
        assert_near(odometry.pose_at(at(t_ms)).unwrap(), on_arc(0.5, 0.8, t_ms), 5e-6);
    }
    // Ahead of the samples along the arc.
    for t_ms in [2_040, 2_200] {
        assert_near(odometry.pose_at(at(t_ms)).unwrap(), on_arc(0.5, 0.8, t_ms), 1e-9);
    }
    assert_eq!(odometry.pose_at(at(2_201)), None);
    assert_eq!(odometry.pose_at(at(500)), None);
    assert_eq!(Odometry::new(Pose::default(), TRACK_M).pose_at(at(0)), None);
}

/// A velocity command takes effect at once: at 100 ms the speed steps from 0 to 0.7 m/s. The gyro
/// sample at 110 ms finds the old speed; the encoders at 120 ms tell of 0.014 m, half of which had
/// been gone by 110 ms. Whole millimetres are not taken at their word: within σ of a tick, 0.3 mm.
#[test]
fn what_was_reckoned_between_two_encoder_samples_is_corrected() {
    let mut odometry = Odometry::new(Pose::default(), TRACK_M);
    for t_ms in (0..=100).step_by(20) {
        odometry.imu(&gyro(t_ms, 0.0));
        odometry.encoders(&wheels(t_ms, 0.0, 0.0, 0.0, 0.0));
    }
    odometry.imu(&gyro(110, 0.0));
    assert_eq!(odometry.pose_at(at(110)).unwrap().x_m, 0.0);
    odometry.imu(&gyro(120, 0.0));
    odometry.encoders(&wheels(120, 0.014, 0.0, 0.7, 0.0));
    assert!((odometry.pose_at(at(110)).unwrap().x_m - 0.007).abs() < 3e-4);
    assert!((odometry.pose_at(at(120)).unwrap().x_m - 0.014).abs() < 3e-4);
}

/// 0.4 s of standing teach the bias; 20 s of driving straight ahead then end where they should.
/// Without it the heading would be off by 0.01·20 = 0.2 rad.
#[test]
fn the_gyros_bias_is_learnt_while_standing() {
    const BIAS_RADPS: f64 = 0.01;
    let mut odometry = Odometry::new(Pose::default(), TRACK_M);
    for t_ms in (0..=20_400).step_by(10) {
        odometry.imu(&gyro(t_ms, BIAS_RADPS));
        if t_ms % 20 == 0 {
            let driven_s = t_ms.saturating_sub(400) as f64 * 1e-3;
            let v = if t_ms > 400 { 0.5 } else { 0.0 };
            odometry.encoders(&wheels(t_ms, 0.5 * driven_s, 0.0, v, 0.0));
        }
    }
    // 30 samples of σ 0.005 rad/s, for all that the filter knows, are good to 0.001.
    assert!((odometry.gyro_bias_radps() - BIAS_RADPS).abs() < 1e-4);
    // The standing robot has not turned, whatever the gyro said before that was known.
    assert!(odometry.estimate().pose.theta_rad.abs() <= 1e-3);
    assert!((odometry.estimate().pose.x_m - 10.0).abs() < 1e-3);
}

/// Turning on the spot more slowly than a bias may be: the gyro's first samples come before the
/// encoders can tell. 10 s at 0.04 rad/s are 0.4 rad.
#[test]
fn a_slow_turn_is_not_bias() {
    let mut odometry = Odometry::new(Pose::default(), TRACK_M);
    for t_ms in (0..=10_400_u64).step_by(10) {
        let turned_s = t_ms.saturating_sub(400) as f64 * 1e-3;
        let omega = if t_ms > 400 { 0.04 } else { 0.0 };
        odometry.imu(&gyro(t_ms, omega));
        if t_ms % 20 == 0 {
            odometry.encoders(&wheels(t_ms, 0.0, 0.04 * turned_s, 0.0, omega));
        }
    }
    assert!(odometry.gyro_bias_radps().abs() < 1e-4);
    assert_near(odometry.estimate().pose, Pose { theta_rad: 0.4, ..Pose::default() }, 1e-3);
}

/// A robot that is turned by hand, or whose encoders are dead, still turns.
#[test]
fn a_fast_turn_with_standing_wheels_is_believed() {
    let mut odometry = Odometry::new(Pose::default(), TRACK_M);
    for t_ms in (0..=1_000).step_by(10) {
        odometry.imu(&gyro(t_ms, 0.5));
        odometry.encoders(&wheels(t_ms, 0.0, 0.0, 0.0, 0.0));
    }
    assert!((odometry.estimate().pose.theta_rad - 0.5).abs() < 1e-12);
    assert_eq!(odometry.gyro_bias_radps(), 0.0);
}

#[test]
fn nonsense_changes_nothing() {
    let odometry = drive_arc(0.5, 0.8, 1_000, |_| true, |_| true);
    let mut disturbed = odometry.clone();
    for rate in [f64::NAN, f64::INFINITY, 36.0] {
        disturbed.imu(&gyro(1_010, rate));
    }
    // Late, or twice.
    disturbed.imu(&gyro(1_000, 5.0));
    disturbed.imu(&gyro(990, 5.0));
    for travel in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        disturbed.encoders(&wheels(1_020, travel, 0.0, 0.5, 0.8));
    }
    disturbed.encoders(&wheels(1_000, 7.0, 0.0, 0.5, 0.8));
    disturbed.encoders(&wheels(980, 7.0, 0.0, 0.5, 0.8));
    assert_eq!(state(&disturbed), state(&odometry));
}

/// Unknown wheel speeds do not hide known travel: v is travel over time.
#[test]
fn travel_stands_in_for_unknown_speeds() {
    let mut odometry = Odometry::new(Pose::default(), TRACK_M);
    odometry.encoders(&wheels(0, 0.0, 0.0, f64::NAN, 0.0));
    assert_eq!(odometry.estimate().v_mps, 0.0);
    odometry.encoders(&wheels(20, 0.01, 0.0, f64::NAN, 0.0));
    assert!((odometry.estimate().v_mps - 0.5).abs() < 1e-12);
}

/// The counters restart from 0 at 1 s, in the middle of an arc: the step of 20 ms in which they do
/// is driven with the speeds of before, so nothing is lost.
#[test]
fn counters_may_start_again() {
    let mut odometry = Odometry::new(Pose::default(), TRACK_M);
    for t_ms in (0..=2_000).step_by(10) {
        odometry.imu(&gyro(t_ms, 0.8));
        if t_ms % 20 == 0 {
            let counted_from_ms = if t_ms > 1_000 { 100_000_000 } else { 0 };
            let t = (t_ms as f64 - f64::from(counted_from_ms)) * 1e-3;
            odometry.encoders(&wheels(t_ms, 0.5 * t, 0.8 * t, 0.5, 0.8));
        }
    }
    assert_near(odometry.estimate().pose, on_arc(0.5, 0.8, 2_000), 1e-9);
}

/// The clock is set back by an hour in the middle of an arc. The 10 ms of the sample that brings the
/// news cannot be timed; everything else counts.
#[test]
fn a_clock_set_back_starts_afresh_where_the_robot_is() {
    let mut odometry = drive_arc(0.5, 0.0, 1_000, |_| true, |_| true);
    let before = odometry.estimate().pose;
    let hour_ns = 3_600_000_000_000;
    let earlier = |stamp: Time| Time(stamp.0 - hour_ns);
    for t_ms in (1_020..=2_000).step_by(20) {
        let mut imu = gyro(t_ms, 0.0);
        imu.stamp = earlier(imu.stamp);
        odometry.imu(&imu);
        let t = t_ms as f64 * 1e-3;
        let mut encoders = wheels(t_ms, 0.5 * t, 0.0, 0.5, 0.0);
        encoders.stamp = earlier(encoders.stamp);
        odometry.encoders(&encoders);
    }
    let estimate = odometry.estimate();
    assert_eq!(estimate.stamp, Some(earlier(at(2_000))));
    assert!((estimate.pose.x_m - (before.x_m + 0.5 * 0.98)).abs() < 1e-9);
    assert!(odometry.pose_at(at(900)).is_none(), "the old clock's past is gone");
}

/// ∫(|v| + 0.2|ω|)dt over 10 s of v = −0.3, ω = 1.7 is 3 + 3.4 = 6.4 m.
#[test]
fn the_odometer_counts_travel_and_turning() {
    let odometry = drive_arc(-0.3, 1.7, 10_000, |_| true, |_| true);
    assert!((odometry.odometer_m() - 6.4).abs() < 1e-9);
}

fn state(odometry: &Odometry) -> u64 {
    let mut digest = Digest::default();
    odometry.fold(&mut digest, SIMULATION_EPOCH);
    digest.value()
}

fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -2.0..2.0,
        1 => Just(0.0),
        1 => proptest::num::f64::ANY,
    ]
}

#[derive(Clone, Copy, Debug)]
enum Heard {
    Imu(ImuSample),
    Encoders(EncoderSample),
}

fn any_sample() -> impl Strategy<Value = Heard> {
    let stamp = prop_oneof![
        6 => (0_u64..3_000).prop_map(at),
        1 => any::<u64>().prop_map(Time),
    ];
    (stamp, prop::array::uniform4(any_number()), any::<bool>()).prop_map(|(stamp, n, is_imu)| {
        if is_imu {
            Heard::Imu(ImuSample {
                stamp,
                accel_mps2: [n[1], n[2], 9.81],
                gyro_radps: [0.0, n[3], n[0]],
                mag_ut: [20.0, n[3], -45.0],
            })
        } else {
            Heard::Encoders(EncoderSample {
                stamp,
                left_m: n[0],
                right_m: n[1],
                left_mps: n[2],
                right_mps: n[3],
            })
        }
    })
}

/// Instants that there need not be: which of them there is counts, not only its value.
#[test]
fn an_instant_does_not_hash_like_another() {
    let hash = |reached, gyro| {
        let mut odometry = Odometry::new(Pose::default(), TRACK_M);
        (odometry.reached, odometry.gyro) = (reached, gyro);
        let mut digest = Digest::default();
        odometry.fold(&mut digest, SIMULATION_EPOCH);
        digest.value()
    };
    assert_ne!(hash(Some(at(20)), None), hash(None, Some(at(20))));
}

proptest! {
    /// Whatever arrives, in whatever order, every number of the estimate stays finite.
    #[test]
    fn nothing_makes_the_estimate_unusable(samples in prop::collection::vec(any_sample(), 0..200)) {
        let mut odometry = Odometry::new(Pose::default(), TRACK_M);
        for sample in samples {
            match sample {
                Heard::Imu(imu) => odometry.imu(&imu),
                Heard::Encoders(encoders) => odometry.encoders(&encoders),
            }
            let estimate = odometry.estimate();
            prop_assert!(estimate.pose.is_finite(), "{estimate:?}");
            prop_assert!(estimate.v_mps.is_finite() && estimate.omega_radps.is_finite());
            prop_assert!(odometry.odometer_m().is_finite());
            let report = odometry.report(at(1_500));
            prop_assert!(report.sigma.iter().all(|sigma| sigma.is_finite()), "{report:?}");
            prop_assert!(report.gyro_bias_radps.is_finite());
            if let Some(pose) = odometry.pose_at(at(1_500)) {
                prop_assert!(pose.is_finite());
            }
        }
    }
}
