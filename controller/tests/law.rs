//! Contract: the feedback law has the properties that the paper proves and the specification lists
//! (§§2–4, 12): the Lyapunov identities, the shape of `d_r`, the continuity of A, and symmetry.
//!
//! The Lyapunov functions' rates are taken by central differences along the model's own flow, so
//! that no derivative that the law computes is trusted.

use controller::law::admissible::admissible;
use controller::law::arctangent::{TOLERANCE, continuous_atan2, nearest_branch, wrap};
use controller::law::dynamic::{self, Speeds};
use controller::law::star::{Star, star, star_rates};
use controller::law::{Axis, BranchSigns, Gains, Side, Situation, kinematic};
use controller::plan::{Past, Scene, plan};
use controller::{Law, Params};
use proptest::prelude::*;
use std::f64::consts::{FRAC_1_SQRT_2, PI, SQRT_2};

const H_S: f64 = 1e-6;

fn axis() -> impl Strategy<Value = Axis> {
    (0.1..3.0, 0.1..3.0, -0.5..0.5, -0.5..0.5).prop_map(|(d_m, d_r_m, rate, accel)| Axis {
        d_m,
        d_r_m,
        d_r_rate_mps: rate,
        d_r_accel_mps2: accel,
    })
}

fn situation() -> impl Strategy<Value = Situation> {
    (axis(), axis(), any::<bool>(), -6.0..6.0).prop_map(|(ahead, aside, left, theta_e_rad)| {
        Situation {
            ahead,
            aside,
            side: if left { Side::Left } else { Side::Right },
            signs: BranchSigns::Sigma,
            theta_e_rad,
        }
    })
}

fn gains() -> impl Strategy<Value = Gains> {
    (0.05..1.0, 0.05..1.0, 0.1..4.0, 0.1..6.0, 0.0..2.0, 0.2..1.0).prop_map(
        |(gamma1, gamma2, gamma3, gamma4, gamma5, lambda)| Gains {
            gamma1,
            gamma2,
            gamma3,
            gamma4,
            gamma5,
            lambda,
        },
    )
}

/// The situation `dt` later, for constant v and ωe (rates beyond the first cancel in a central
/// difference, except those of the wanted distances, which the law is told).
fn later(at: &Situation, v: f64, omega_e: f64, dt: f64) -> Situation {
    let (sin, cos) = libm::sincos(at.theta_e_rad);
    let moved = |axis: &Axis, d_rate: f64| Axis {
        d_m: axis.d_m + d_rate * dt,
        d_r_m: axis.d_r_m + axis.d_r_rate_mps * dt + 0.5 * axis.d_r_accel_mps2 * dt * dt,
        d_r_rate_mps: axis.d_r_rate_mps + axis.d_r_accel_mps2 * dt,
        d_r_accel_mps2: axis.d_r_accel_mps2,
    };
    Situation {
        ahead: moved(&at.ahead, -v * cos),
        aside: moved(&at.aside, -at.sigma() * v * sin),
        theta_e_rad: at.theta_e_rad + omega_e * dt,
        ..*at
    }
}

/// θ* and v* on the branch on which e lies in [−π, π], as the controller takes them.
fn star_at(situation: &Situation, gains: &Gains) -> Star {
    let mut star = star(situation, gains, situation.theta_e_rad);
    star.theta_rad = nearest_branch(star.theta_rad, situation.theta_e_rad);
    star
}

fn star_near(situation: &Situation, gains: &Gains, near_rad: f64) -> Star {
    star(situation, gains, near_rad)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// (10), (11): L' = −γ1 z1² − γ2 z2² − γ3 e², on both sides, with moving references and a
    /// turning frame.
    #[test]
    fn the_kinematic_lyapunov_identity_holds(
        situation in situation(),
        gains in gains(),
        omega_r in -1.0..1.0,
    ) {
        let star = star_at(&situation, &gains);
        prop_assume!(star.v_mps > 0.01);
        let rates = star_rates(&situation, &gains, &star, star.v_mps);
        let [v, omega] = kinematic::feedback(
            &situation, &gains, star.theta_rad, rates.theta_radps, star.v_mps, omega_r,
        );
        let at = |dt: f64| {
            let moved = later(&situation, v, omega - omega_r, dt);
            let theta_star = star_near(&moved, &gains, star.theta_rad).theta_rad;
            kinematic::lyapunov(&moved, theta_star)
        };
        let rate = (at(H_S) - at(-H_S)) / (2.0 * H_S);
        let (z1, z2) = (situation.ahead.z(), situation.aside.z());
        let e = situation.theta_e_rad - star.theta_rad;
        let expected = -gains.gamma1 * z1 * z1 - gains.gamma2 * z2 * z2 - gains.gamma3 * e * e;
        // The third derivative grows with the turn rate; so does what is left of the difference.
        let tolerance = 1e-6 * (1.0 + expected.abs() + omega * omega);
        prop_assert!((rate - expected).abs() < tolerance, "{rate} {expected}");
    }

    /// (16), (17): L' = −γ1 z1² − γ2 z2² − γ3 (v−v*)²/λ − γ4 (ωe−ωe*)² − γ5 e², with weight 1/λ on
    /// (v−v*)² in L.
    #[test]
    fn the_dynamic_lyapunov_identity_holds(
        situation in situation(),
        gains in gains(),
        v in -0.7..0.7,
        omega_e in -1.5..1.5,
        omega_r_rate in -0.5..0.5,
    ) {
        let star = star_at(&situation, &gains);
        prop_assume!(star.v_mps > 0.05);
        let speeds = Speeds { v_mps: v, omega_e_radps: omega_e };
        let law = dynamic::feedback(&situation, &gains, &star, &speeds, omega_r_rate);
        let [u1, u2] = law.u;
        let weighed = |speeds: &Speeds, v_star: f64, plain: f64| {
            let dv = speeds.v_mps - v_star;
            plain + 0.5 * dv * dv * (1.0 / gains.lambda - 1.0)
        };
        let at = |dt: f64| {
            let moved = later(&situation, v, omega_e, dt);
            let then = Speeds {
                v_mps: v + u1 * dt,
                omega_e_radps: omega_e + (u2 - omega_r_rate) * dt,
            };
            let star = star_near(&moved, &gains, star.theta_rad);
            let rates = star_rates(&moved, &gains, &star, then.v_mps);
            let omega_e_star = dynamic::omega_e_star(
                &moved, &gains, star.theta_rad, rates.theta_radps, star.v_mps,
            );
            let plain =
                dynamic::lyapunov(&moved, &then, star.theta_rad, star.v_mps, omega_e_star);
            weighed(&then, star.v_mps, plain)
        };
        let rate = (at(H_S) - at(-H_S)) / (2.0 * H_S);
        let (z1, z2) = (situation.ahead.z(), situation.aside.z());
        let e = situation.theta_e_rad - star.theta_rad;
        let dv = v - star.v_mps;
        let domega = omega_e - law.omega_e_star_radps;
        let expected = -gains.gamma1 * z1 * z1
            - gains.gamma2 * z2 * z2
            - gains.gamma3 * dv * dv / gains.lambda
            - gains.gamma4 * domega * domega
            - gains.gamma5 * e * e;
        let scale = 1.0 + expected.abs() + domega.abs() * (1.0 + u2.abs()) + u1 * u1;
        prop_assert!((rate - expected).abs() < 1e-5 * scale, "{rate} {expected}");
    }

    /// The signs as printed are the law itself on the left; on the right they mirror θ* (erratum 7).
    #[test]
    fn left_hand_signs_are_the_law_on_the_left(situation in situation(), gains in gains()) {
        let printed = Situation { signs: BranchSigns::Left, ..situation };
        let left = Situation { side: Side::Left, ..situation };
        let left_printed = Situation { side: Side::Left, ..printed };
        prop_assert_eq!(star_at(&left, &gains), star_at(&left_printed, &gains));
        let sigma = star_at(&Situation { side: Side::Right, ..situation }, &gains);
        let as_printed = star_at(&Situation { side: Side::Right, ..printed }, &gains);
        prop_assert!(wrap(sigma.theta_rad + as_printed.theta_rad).abs() < 1e-9);
    }

    /// (8): never below ε, never below the wanted distance, monotone, slope within [0, 1].
    #[test]
    fn d_r_is_admissible(
        d_d in -3.0..3.0, step in 0.0..0.5, r in 0.05..3.0, epsilon in 0.01..0.3,
    ) {
        let (here, there) = (admissible(d_d, r, epsilon), admissible(d_d + step, r, epsilon));
        prop_assert!(here.d_r_m >= epsilon);
        prop_assert!(here.d_r_m >= d_d - 1e-12);
        prop_assert!(there.d_r_m >= here.d_r_m - 1e-12);
        prop_assert!((0.0..=1.0 + 1e-9).contains(&here.slope), "{}", here.slope);
        prop_assert!(here.curvature >= 0.0);
    }

    /// (8) is C1: value and slope agree on both sides of either joint; and the slope is that of the
    /// value, the curvature that of the slope, away from the joints.
    #[test]
    fn d_r_is_smooth(d_d in -2.0..3.0f64, r in 0.1..3.0, epsilon in 0.01..0.3) {
        let joints = [epsilon - (SQRT_2 - 1.0) * r, epsilon + (1.0 - FRAC_1_SQRT_2) * r];
        for joint in joints {
            let (below, above) =
                (admissible(joint - 1e-9, r, epsilon), admissible(joint + 1e-9, r, epsilon));
            prop_assert!((below.d_r_m - above.d_r_m).abs() < 1e-8);
            prop_assert!((below.slope - above.slope).abs() < 1e-7 * (1.0 + 1.0 / r));
        }
        let h = 1e-5;
        prop_assume!(joints.iter().all(|joint| (d_d - joint).abs() > 10.0 * h));
        let here = admissible(d_d, r, epsilon);
        let (below, above) = (admissible(d_d - h, r, epsilon), admissible(d_d + h, r, epsilon));
        prop_assert!(((above.d_r_m - below.d_r_m) / (2.0 * h) - here.slope).abs() < 1e-6);
        let curvature = (above.slope - below.slope) / (2.0 * h);
        prop_assert!((curvature - here.curvature).abs() < 1e-4 * (1.0 + here.curvature));
    }

    /// Definition 3: A is an angle of (x, y), at most half a turn from the previous one; too short
    /// a vector keeps it.
    #[test]
    fn the_arctangent_never_jumps(
        y in -5.0..5.0f64, x in -5.0..5.0f64, previous in -50.0..50.0f64,
    ) {
        let angle = continuous_atan2(y, x, previous, TOLERANCE);
        prop_assert!((angle - previous).abs() <= PI + 1e-9);
        let length = libm::hypot(x, y);
        if length > TOLERANCE {
            prop_assert!((libm::cos(angle) - x / length).abs() < 1e-9);
            prop_assert!((libm::sin(angle) - y / length).abs() < 1e-9);
        }
        let kept = continuous_atan2(y * 1e-8, x * 1e-8, previous, TOLERANCE);
        prop_assert_eq!(kept, previous);
    }

    #[test]
    fn wrapping_takes_whole_turns_only(angle in -100.0..100.0f64) {
        let wrapped = wrap(angle);
        prop_assert!(wrapped > -PI && wrapped <= PI);
        let turns = (angle - wrapped) / (2.0 * PI);
        prop_assert!((turns - turns.round()).abs() < 1e-9);
    }

    /// y → −y: side, θ* and ω_f change sign, v_f does not.
    #[test]
    fn the_feedback_step_is_mirror_symmetric(
        d1 in 0.01..3.0, d2l in 0.01..3.0, d2r in 0.01..3.0,
        delta in [-1.0..1.0, -1.0..1.0], q in [-0.5..0.5, -0.5..0.5],
        theta_e in -3.0..3.0, omega_r in -0.5..0.5,
    ) {
        let params = Params::default();
        let scene = Scene {
            d1_m: d1, d2l_m: d2l, d2r_m: d2r, delta_m: delta, q_mps: q,
            theta_e_rad: theta_e, omega_r_radps: omega_r, jumped: true,
            v_mps: f64::NAN, omega_radps: f64::NAN,
        };
        let mirrored = Scene {
            d2l_m: d2r, d2r_m: d2l,
            delta_m: [delta[0], -delta[1]], q_mps: [q[0], -q[1]],
            theta_e_rad: -theta_e, omega_r_radps: -omega_r,
            ..scene
        };
        let (a, b) = (plan(Law::Kinematic, &params, &scene, &Past::default()),
            plan(Law::Kinematic, &params, &mirrored, &Past::default()));
        let close = |x: f64, y: f64| (x - y).abs() <= 1e-9 * (1.0 + x.abs());
        let (star_a, star_b) = (a.outcome.unwrap().star, b.outcome.unwrap().star);
        // Ties of sides and of branches at e = ±π belong to nobody.
        prop_assume!((theta_e - star_a.theta_rad).abs() < PI - 1e-6);
        prop_assume!(a.situation.side != b.situation.side);
        prop_assert!(close(star_a.theta_rad, -star_b.theta_rad));
        prop_assert!(close(a.u[0], b.u[0]));
        prop_assert!(close(a.u[1], -b.u[1]), "{:?} {:?}", a.u, b.u);
    }
}

/// Lemma 1, in its discrete form: under the feedback alone, frame fixed, faces square and a fine
/// step, the distances stay positive and z → 0; L never increases.
#[test]
fn the_feedback_converges_from_everywhere() {
    // At the goal itself θ* is undefined (erratum 18): rest, but later than by default.
    let params = Params { v_rest_mps: 1e-5, ..Params::default() };
    let (dt, cap) = (0.005, params.cap_m);
    for (start, theta) in [([0.3, 0.2], 0.0), ([0.9, 0.8], 2.5), ([0.06, 0.5], -1.5)] {
        // A corner: one face ahead at x = 0, one to the left at y = 0, the robot below and behind;
        // the target rests where the distances are (0.4, 0.3).
        let ([mut d1, mut d2l], mut theta_e) = (start, theta);
        let mut past = Past::default();
        let mut last = f64::INFINITY;
        for step in 0..40_000 {
            assert!(d1 < cap && d2l < cap, "the corner is within the cap");
            let scene = Scene {
                d1_m: d1,
                d2l_m: d2l,
                d2r_m: 1e3,
                delta_m: [d1 - 0.4, d2l - 0.3],
                q_mps: [0.0; 2],
                theta_e_rad: theta_e,
                omega_r_radps: 0.0,
                jumped: step == 0,
                v_mps: f64::NAN,
                omega_radps: f64::NAN,
            };
            let plan = plan(Law::Kinematic, &params, &scene, &past);
            past = plan.past();
            let star = plan.outcome.unwrap().star;
            let lyapunov = kinematic::lyapunov(&plan.situation, star.theta_rad);
            assert!(lyapunov <= last + 1e-9, "L rose to {lyapunov} from {last} in step {step}");
            last = lyapunov;
            let [v, omega] = plan.u;
            d1 -= v * libm::cos(theta_e) * dt;
            d2l -= v * libm::sin(theta_e) * dt;
            theta_e += omega * dt;
            assert!(d1 > 0.0 && d2l > 0.0);
        }
        assert!((d1 - 0.4).abs() < 1e-3 && (d2l - 0.3).abs() < 1e-3, "ended at {d1}, {d2l}");
    }
}
