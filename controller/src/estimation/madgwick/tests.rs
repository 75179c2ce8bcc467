//! Contract: from any start the filter comes to the attitude that gravity and field show; it follows
//! a turn; what is implausible is left out; nothing makes it anything but an attitude.
//!
//! True attitudes are made from rotation matrices Rz(yaw) Ry(pitch) Rx(roll) here, not quaternions. The
//! field is London's, (19.5, 0, −45) µT. Per sample of 10 ms the correction turns the attitude by
//! 2β · 10 ms, 0.0008 rad with β = 0.041, whatever the error: it gets no nearer than that.

use proptest::prelude::*;

use super::*;

const FIELD_EARTH_UT: [f64; 3] = [19.5, 0.0, -45.0];
const STEP_S: f64 = 0.01;
const DITHER_RAD: f64 = 2.0 * GAIN_NINE_AXES * STEP_S;

/// `vector` (earth frame) as a body at roll, pitch, yaw sees it: (Rz Ry Rx)ᵀ v, one axis at a time.
fn seen([roll, pitch, yaw]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    let (s, c) = libm::sincos(yaw);
    let (x, y) = (c * x + s * y, c * y - s * x);
    let (s, c) = libm::sincos(pitch);
    let (x, z) = (c * x - s * z, c * z + s * x);
    let (s, c) = libm::sincos(roll);
    [x, c * y + s * z, c * z - s * y]
}

fn resting(attitude: [f64; 3], field_ut: [f64; 3]) -> ImuSample {
    ImuSample {
        accel_mps2: seen(attitude, [0.0, 0.0, GRAVITY_MPS2]),
        mag_ut: seen(attitude, field_ut),
        ..ImuSample::default()
    }
}

fn hold(filter: &mut Madgwick, sample: &ImuSample, gyro: [f64; 3], seconds: f64) {
    for _ in 0..(seconds / STEP_S) as usize {
        filter.update(sample, gyro, STEP_S);
    }
}

#[track_caller]
fn assert_near(filter: &Madgwick, wanted: [f64; 3], tolerance_rad: f64) {
    for (angle, wanted) in filter.angles_rad().iter().zip(wanted) {
        let off = libm::remainder(angle - wanted, core::f64::consts::TAU);
        assert!(off.abs() <= tolerance_rad, "{:?} is not {wanted:?}", filter.angles_rad());
    }
}

/// The farthest start is half a turn off, π at 2β = 0.082 rad/s: 38 s if it went straight there.
#[test]
fn it_comes_to_the_true_attitude_from_a_wrong_start() {
    for attitude in [[0.0, 0.0, 2.0], [0.3, -0.2, 1.0], [-0.8, 0.5, -2.5], [3.0, 0.1, 0.4]] {
        let mut filter = Madgwick::new(0.0);
        hold(&mut filter, &resting(attitude, FIELD_EARTH_UT), [0.0; 3], 120.0);
        assert_near(&filter, attitude, 2.0 * DITHER_RAD);
    }
}

/// One radian of yaw alone takes at least 1/(2β) = 12.2 s, since no step turns by more than 2β Δt.
#[test]
fn it_comes_no_faster_than_its_gain() {
    let mut filter = Madgwick::new(0.0);
    hold(&mut filter, &resting([0.0, 0.0, 1.0], FIELD_EARTH_UT), [0.0; 3], 10.0);
    let yaw = filter.angles_rad()[2];
    assert!(yaw > 0.3 && yaw <= 10.0 * 2.0 * GAIN_NINE_AXES, "{yaw}");
}

/// Ten turns about the vertical at 0.5 rad/s. A step of the quaternion turns by 2 atan(ωΔt/2) instead
/// of ωΔt, short by (ωΔt)³/12 = 1e-8, 1.3e-4 in all, which the magnetometer takes away. The gradient is
/// taken where the filter was a sample ago (33), so it pulls ahead by up to ωΔt = 0.005.
#[test]
fn it_follows_a_steady_turn() {
    let omega = 0.5;
    let mut filter = Madgwick::new(0.7);
    let samples = (10.0 * core::f64::consts::TAU / omega / STEP_S) as usize;
    for i in 1..=samples {
        let attitude = [0.0, 0.0, 0.7 + omega * STEP_S * i as f64];
        filter.update(&resting(attitude, FIELD_EARTH_UT), [0.0, 0.0, omega], STEP_S);
        assert_near(&filter, attitude, omega * STEP_S + DITHER_RAD);
    }
}

/// A gyro that is wrong by 0.02 rad/s about z moves the quaternion at 0.01 per second, less than β: the
/// magnetometer holds the yaw. Without one it drifts by 0.02 · 60 = 1.2 rad, and roll and pitch hold.
#[test]
fn the_magnetometer_holds_the_yaw_against_a_bias() {
    let sample = resting([0.0; 3], FIELD_EARTH_UT);
    let mut with = Madgwick::new(0.0);
    hold(&mut with, &sample, [0.0, 0.0, 0.02], 60.0);
    assert_near(&with, [0.0; 3], 2.0 * DITHER_RAD);
    let mut without = Madgwick::new(0.0);
    hold(&mut without, &resting([0.0; 3], [0.0; 3]), [0.0, 0.0, 0.02], 60.0);
    assert_near(&without, [0.0, 0.0, 1.2], 1e-4);
}

/// Absent, NaN, too weak by a shield, too strong by a magnet: all the same six-axis form, which finds
/// roll and pitch and leaves the yaw alone.
#[test]
fn an_implausible_field_is_left_out() {
    let tilted = [0.2, -0.3, 0.0];
    let run = |field_ut| {
        let mut filter = Madgwick::new(1.0);
        let sample = ImuSample { mag_ut: field_ut, ..resting(tilted, FIELD_EARTH_UT) };
        hold(&mut filter, &sample, [0.0; 3], 60.0);
        filter
    };
    let absent = run([0.0; 3]);
    for field_ut in [[f64::NAN, 0.0, -45.0], [10.0, 0.0, 5.0], [80.0, 0.0, 0.0]] {
        assert_eq!(run(field_ut), absent);
    }
    let [roll, pitch, _] = absent.angles_rad();
    assert!((roll - 0.2).abs() < 2.0 * DITHER_RAD && (pitch + 0.3).abs() < 2.0 * DITHER_RAD);
    assert_ne!(run([19.5, 0.0, -45.0]), absent);
}

/// 3 m/s² of acceleration, a blow, no accelerometer: the gyro alone, here at rest, and the attitude
/// does not move.
#[test]
fn an_implausible_acceleration_is_left_out() {
    for accel_mps2 in [[3.0, 0.0, 9.81], [0.0, 0.0, 30.0], [0.0; 3], [f64::NAN, 0.0, 9.81]] {
        let mut filter = Madgwick::new(1.0);
        let sample = ImuSample { accel_mps2, mag_ut: [19.5, 0.0, -45.0], ..ImuSample::default() };
        hold(&mut filter, &sample, [0.0; 3], 10.0);
        assert_near(&filter, [0.0, 0.0, 1.0], 1e-12);
    }
}

#[test]
fn nothing_is_known_before_anything_is_heard() {
    assert!(Madgwick::new(0.3).angles_rad().iter().all(|angle| angle.is_nan()));
}

proptest! {
    /// Whatever arrives, the quaternion stays one of length 1 and the angles stay angles.
    #[test]
    fn nothing_makes_it_anything_but_an_attitude(
        samples in prop::collection::vec(
            (prop::array::uniform9(prop_oneof![3 => -50.0..50.0, 1 => proptest::num::f64::ANY]),
             proptest::num::f64::ANY),
            0..50,
        )
    ) {
        let mut filter = Madgwick::new(0.0);
        for (n, elapsed_s) in samples {
            let sample = ImuSample {
                accel_mps2: [n[0], n[1], n[2]],
                mag_ut: [n[3], n[4], n[5]],
                ..ImuSample::default()
            };
            filter.update(&sample, [n[6], n[7], n[8]], elapsed_s);
            prop_assert!((norm(&filter.q) - 1.0).abs() < 1e-12);
            prop_assert!(!filter.heard || filter.angles_rad().iter().all(|angle| angle.abs() <= 3.15));
        }
    }
}
