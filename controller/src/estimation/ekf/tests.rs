//! Contract: on motion that the model describes, errors are as large as the covariance says and
//! innovations as large as their variance; the covariance stays one whatever happens.
//!
//! The model is simulated here with its own noise: jumps of the turn rate, accelerations, a wandering
//! bias and gain, wheels with random errors, counters cut into ticks.

use core::f64::consts::TAU;

use proptest::prelude::*;

use super::*;
use crate::estimation::gate::{ONE_NUMBER, TWO_NUMBERS};

const TRACK_M: f64 = 0.5;

/// `SplitMix64` and the Box-Muller transform: noise of the test's own.
struct Dice(u64);

impl Dice {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let word = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((word ^ (word >> 31)) >> 11) as f64 / 9_007_199_254_740_992.0
    }

    fn normal(&mut self, sigma: f64) -> f64 {
        let radius = libm::sqrt(-2.0 * libm::log(1.0 - self.uniform()));
        sigma * radius * libm::cos(TAU * self.uniform())
    }
}

/// What is true: pose, speeds, bias, gain, and what the counters would show if they had no ticks.
struct Truth {
    pose: [f64; 3],
    v: f64,
    omega: f64,
    bias: f64,
    gain: f64,
    counted: [f64; 2],
}

/// One run of 4 s: normalised estimation error squared of the seven numbers that matter, and the sums
/// of the normalised innovations with how many there were.
struct Run {
    error: f64,
    gyro: f64,
    encoders: f64,
    samples: f64,
    rejected: usize,
}

fn run(seed: u64) -> Run {
    let dice = &mut Dice(seed);
    let step_s = 0.01;
    let gyro_sigma = 0.005;
    let mut filter = Ekf::new(Pose::default(), TRACK_M);
    filter.replace(V, 0.0, 1e-4);
    let mut truth = Truth {
        pose: [0.0; 3],
        v: dice.normal(0.01),
        omega: 0.0,
        bias: dice.normal(BIAS_SIGMA_RADPS),
        gain: dice.normal(TURN_GAIN_SIGMA),
        counted: [0.0; 2],
    };
    let mut shown = [0.0; 2];
    let mut run = Run { error: 0.0, gyro: 0.0, encoders: 0.0, samples: 0.0, rejected: 0 };
    for i in 1..=400 {
        let accel = 0.5 * libm::sin(0.1 * f64::from(i));
        truth.v += dice.normal(ACCEL_SIGMA_MPS2 * step_s);
        truth.v += dice.normal(ACCEL_SHARE * accel * step_s);
        // Turns are reined in, or a walk of such steps would spin the robot like a top.
        truth.omega = dice.normal(JUMP_RADPS / core::f64::consts::SQRT_2);
        truth.bias += dice.normal(BIAS_WANDER * libm::sqrt(step_s));
        truth.gain += dice.normal(TURN_GAIN_WANDER * libm::sqrt(step_s));
        let travel = (truth.v + 0.5 * accel * step_s) * step_s;
        let turn = truth.omega * step_s;
        truth.v += accel * step_s;
        let half = 0.5 * TRACK_M * turn;
        let slips = [travel - half, travel + half]
            .map(|wheel: f64| dice.normal(TRAVEL_NOISE * libm::sqrt(wheel.abs())));
        // The body moves by what the wheels rolled, less their errors; the counters turn by κ more.
        let moved = travel - 0.5 * (slips[0] + slips[1]);
        let towards = truth.pose[2] + 0.5 * turn;
        truth.pose[0] += moved * libm::cos(towards);
        truth.pose[1] += moved * libm::sin(towards);
        truth.pose[2] += turn;
        truth.counted[0] += travel;
        truth.counted[1] += (1.0 + truth.gain) * turn + (slips[1] - slips[0]) / TRACK_M;

        filter.predict(step_s, Some(accel));
        let rate = truth.omega + truth.bias + dice.normal(gyro_sigma);
        let z = Measurement {
            of: [(OMEGA, 1.0), (BIAS, 1.0)],
            innovation: rate - filter.get(OMEGA) - filter.get(BIAS),
            variance: gyro_sigma * gyro_sigma,
        };
        let normalised = z.innovation * z.innovation / filter.innovation_variance(&z);
        run.gyro += normalised;
        run.rejected += usize::from(normalised > ONE_NUMBER);
        filter.update(&z);
        if i % 2 == 0 {
            let [travel_variance, turn_variance] = filter.counter_variances();
            let before = shown;
            shown = [
                truth.counted[0] + dice.normal(libm::sqrt(travel_variance)),
                truth.counted[1] + dice.normal(libm::sqrt(turn_variance)),
            ];
            let by = [shown[0] - before[0], shown[1] - before[1]];
            let travel = Measurement::direct(TRAVEL, by[0] - filter.get(TRAVEL), travel_variance);
            let turn = Measurement::direct(TURN, by[1] - filter.get(TURN), turn_variance);
            let normalised = filter.together(&travel, &turn);
            run.encoders += normalised;
            run.rejected += usize::from(normalised > TWO_NUMBERS);
            filter.update(&travel);
            let innovation = by[1] - filter.get(TURN);
            filter.update(&Measurement { innovation, ..turn });
            filter.shift(TRAVEL, -by[0]);
            filter.shift(TURN, -by[1]);
            run.samples += 1.0;
        }
    }
    let truths =
        [truth.pose[0], truth.pose[1], truth.pose[2], truth.v, truth.omega, truth.bias, truth.gain];
    let error = SVector::<f64, 7>::from_fn(|of, _| truths[of] - filter.get(of));
    let covariance = SMatrix::<f64, 7, 7>::from_fn(|row, column| filter.p[(row, column)]);
    let weighted = covariance.cholesky().expect("it is positive definite").solve(&error);
    run.error = error.dot(&weighted);
    run
}

/// The mean of N values of χ² with n degrees of freedom is n, with a standard deviation of √(2n/N).
/// Bounds are four of these. Turn rates are drawn a little tamer than a walk, so that the gyro's
/// innovations, of variance 2 · (1.5/√2)² at most, are χ² too.
#[test]
fn errors_and_innovations_are_as_large_as_they_say() {
    const RUNS: u64 = 200;
    let runs: Vec<Run> = (0..RUNS).map(run).collect();
    let within = |name: &str, mean: f64, freedom: f64, count: f64| {
        let bound = 4.0 * libm::sqrt(2.0 * freedom / count);
        assert!((mean - freedom).abs() < bound, "{name}: {mean} is not {freedom} ± {bound}");
    };
    let n = RUNS as f64;
    let mean = |of: fn(&Run) -> f64| runs.iter().map(of).sum::<f64>() / n;
    within("errors", mean(|run| run.error), 7.0, n);
    let samples: f64 = runs.iter().map(|run| run.samples).sum();
    within("encoders", mean(|run| run.encoders) * n / samples, 2.0, samples);
    within("gyro", mean(|run| run.gyro) * n / (2.0 * samples), 1.0, 2.0 * samples);
    // Each gate turns away one in a thousand.
    let rejected = runs.iter().map(|run| run.rejected).sum::<usize>() as f64;
    let expected = 3.0 * samples * 1e-3;
    assert!((rejected - expected).abs() < 4.0 * libm::sqrt(expected), "{rejected} of {samples}");
}

#[derive(Clone, Copy, Debug)]
enum Act {
    Predict(f64, Option<f64>),
    Hear(usize, usize, f64, f64),
    Anchor,
    Doubt(usize, f64),
    Replace(usize, f64),
}

/// What the odometry may do: accelerations up to 16 g over 20 ms, or a minute without one.
fn any_act() -> impl Strategy<Value = Act> {
    let number = || prop_oneof![8 => -50.0..50.0, 1 => Just(0.0), 1 => -500.0..500.0];
    prop_oneof![
        4 => (1e-9..0.02, -157.0..157.0)
            .prop_map(|(elapsed_s, accel)| Act::Predict(elapsed_s, Some(accel))),
        2 => prop_oneof![4 => 1e-9..0.2, 1 => 0.2..60.0]
            .prop_map(|elapsed_s| Act::Predict(elapsed_s, None)),
        6 => (0..STATES, 0..STATES, number(), 1e-10..1.0)
            .prop_map(|(a, b, innovation, variance)| Act::Hear(a, b, innovation, variance)),
        1 => Just(Act::Anchor),
        1 => (0..STATES, 0.0..40.0).prop_map(|(of, sigma)| Act::Doubt(of, sigma)),
        1 => (0..STATES, number()).prop_map(|(of, value)| Act::Replace(of, value)),
    ]
}

proptest! {
    /// Symmetric to the bit, and no direction has a negative variance beyond the rounding, of a part in
    /// 10^12, of the largest that there was.
    #[test]
    fn the_covariance_stays_one(acts in prop::collection::vec(any_act(), 1..120)) {
        let mut filter = Ekf::new(Pose::default(), TRACK_M);
        let mut largest = 1.0;
        for act in acts {
            match act {
                Act::Predict(elapsed_s, accel) => {
                    filter.predict(elapsed_s, accel);
                }
                Act::Hear(a, b, innovation, variance) => filter.update(&Measurement {
                    of: [(a, 1.0), (b, if a == b { 0.0 } else { 0.25 })],
                    innovation,
                    variance,
                }),
                Act::Anchor => filter.anchor(),
                Act::Doubt(of, sigma) => filter.doubt(of, sigma),
                Act::Replace(of, value) => filter.replace(of, value, 1e-4),
            }
            filter.tidy();
            prop_assert_eq!(filter.p, filter.p.transpose());
            largest = filter.p.trace().max(largest);
            let least = filter.p.symmetric_eigenvalues().min();
            prop_assert!(least >= -1e-12 * largest, "{} of {}", least, largest);
        }
    }
}

/// A number that is not one must not stay.
#[test]
fn it_goes_on_from_the_last_good_pose() {
    let mut filter = Ekf::new(Pose { x_m: 1.0, y_m: 2.0, theta_rad: 0.5 }, TRACK_M);
    filter.tidy();
    filter.shift(X, f64::NAN);
    filter.tidy();
    assert_eq!(filter, Ekf::new(Pose { x_m: 1.0, y_m: 2.0, theta_rad: 0.5 }, TRACK_M));
    filter.doubt(THETA, f64::INFINITY);
    filter.tidy();
    assert_eq!(filter, Ekf::new(Pose { x_m: 1.0, y_m: 2.0, theta_rad: 0.5 }, TRACK_M));
}
