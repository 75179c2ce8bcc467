//! Contract: sets, switch, selection and safety layer behave as specification §§5, 9 and 12 say.

use controller::safety::{Braking, Cone, Limits, clip, scale, scale_velocities};
use controller::sharing::{
    Switch, classify_printed, classify_total, critical_distance_m, danger, select,
};
use proptest::prelude::*;
use schemas::Region;

/// Any f64 at all, with the awkward ones made likely.
fn anything() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>(),
        -10.0..10.0f64,
        Just(0.0),
        Just(-0.0),
        Just(f64::NAN),
        Just(f64::INFINITY),
        Just(f64::NEG_INFINITY),
        Just(f64::MAX),
    ]
}

fn bounds() -> impl Strategy<Value = (f64, f64)> {
    (0.1..4.0, 0.01..2.0).prop_map(|(b1, more)| (b1, b1 + more))
}

/// The definition of §5, word for word.
fn by_definition(d: f64, v: f64, b1: f64, b2: f64) -> Region {
    let dc = |b: f64| b * b * v.abs() / (1.0 + b * v.abs());
    if d.is_nan() || !v.is_finite() || d <= 0.0 || (v != 0.0 && d <= dc(b1)) {
        Region::Danger
    } else if d >= dc(b2) {
        Region::Safe
    } else {
        Region::Hysteresis
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Dc is the inverse of |v| = 1/(b−D) − 1/b, increases in |v| and b, and stays below b.
    #[test]
    fn the_critical_distance_inverts_the_curve((b1, b2) in bounds(), v in 0.001..3.0f64) {
        let dc = critical_distance_m(v, b1);
        prop_assert!((1.0 / (b1 - dc) - 1.0 / b1 - v).abs() < 1e-9 * (1.0 + v));
        prop_assert!(dc < b1);
        prop_assert!(critical_distance_m(1.01 * v, b1) > dc);
        prop_assert!(critical_distance_m(v, b2) > dc);
        prop_assert_eq!(critical_distance_m(-v, b1), dc);
    }

    /// Exactly one class for every D and v, and the one that the definition gives.
    #[test]
    fn the_sets_are_total(d in anything(), v in anything(), (b1, b2) in bounds()) {
        let region = classify_total(d, d, v, b1, b2);
        prop_assert!(region != Region::Unspecified);
        // Where |v| overflows in Dc the definition says nothing; then it must not be safe.
        if (b2 * b2 * v).is_finite() {
            prop_assert_eq!(region, by_definition(d, v, b1, b2));
        } else {
            prop_assert!(region != Region::Safe);
        }
    }

    #[test]
    fn the_edges_of_the_sets_are_as_specified((b1, b2) in bounds(), v in -1.0..1.0f64) {
        prop_assume!(v != 0.0);
        let class = |d: f64| classify_total(d, d, v, b1, b2);
        prop_assert_eq!(class(critical_distance_m(v, b1)), Region::Danger);
        prop_assert_eq!(class(critical_distance_m(v, b2)), Region::Safe);
        prop_assert_eq!(class(b2), Region::Safe);
        prop_assert_eq!(class(0.0), Region::Danger);
        prop_assert_eq!(class(f64::INFINITY), Region::Safe);
        prop_assert_eq!(classify_total(1e-9, 1e-9, 0.0, b1, b2), Region::Safe);
    }

    /// The margin shrinks D in the comparisons only: contact goes by D itself.
    #[test]
    fn the_margin_is_no_contact((b1, b2) in bounds(), d in 0.001..0.01) {
        prop_assert_eq!(classify_total(d, d - 0.02, 0.1, b1, b2), Region::Danger);
        prop_assert_eq!(classify_total(d, d - 0.02, 0.0, b1, b2), Region::Hysteresis);
        prop_assert_eq!(classify_total(-d, 1.0, 0.0, b1, b2), Region::Danger);
    }

    /// (12) as printed: backwards is safe, NaN is danger, and the three classes exclude each other.
    #[test]
    fn the_printed_sets(d in anything(), v in anything(), (b1, b2) in bounds()) {
        let region = classify_printed(d, v, b1, b2);
        let t = |b: f64| if d >= b { f64::INFINITY } else { 1.0 / (b - d) - 1.0 / b };
        let expected = if d.is_nan() || v.is_nan() {
            Region::Danger
        } else if v < 0.0 {
            Region::Safe
        } else if d <= b1 && v >= t(b1) {
            Region::Danger
        } else if d > b2 || v <= t(b2) {
            Region::Safe
        } else {
            Region::Hysteresis
        };
        prop_assert_eq!(region, expected);
    }

    /// In the half-plane that (12) speaks of, 0 < D < b1 and v > 0, both forms agree but for
    /// rounding at the edges.
    #[test]
    fn both_forms_agree_where_the_paper_speaks((b1, b2) in bounds(), d in 0.001..0.999f64, v in 0.001..5.0f64) {
        let d = d * b1;
        let off = |b: f64| (d - critical_distance_m(v, b)).abs() > 1e-9;
        prop_assume!(off(b1) && off(b2));
        prop_assert_eq!(classify_total(d, d, v, b1, b2), classify_printed(d, v, b1, b2));
    }

    /// While D and v sweep within the hysteresis set, k never changes.
    #[test]
    fn hysteresis_keeps_k(
        (b1, b2) in bounds(),
        human in any::<bool>(),
        sweep in prop::collection::vec((0.01..0.99f64, 0.05..1.0f64), 1..50),
    ) {
        let mut switch = Switch { human, seen_safe: true };
        for (share, v) in sweep {
            let (near, far) = (critical_distance_m(v, b1), critical_distance_m(v, b2));
            let d = near + share * (far - near);
            let region = classify_total(d, d, v, b1, b2);
            prop_assert_eq!(region, Region::Hysteresis);
            switch = switch.next(region);
            prop_assert_eq!(switch.human, human);
        }
    }

    /// k = 0 until the safe set has been seen; 1 in it; 0 in the dangerous one.
    #[test]
    fn the_switch_starts_with_the_law(regions in prop::collection::vec(0..3u8, 0..40)) {
        let mut switch = Switch::default();
        prop_assert_eq!(switch.k(), 0.0);
        let mut seen = false;
        for region in regions {
            let region = [Region::Safe, Region::Hysteresis, Region::Danger][region as usize];
            seen |= region == Region::Safe;
            switch = switch.next(region);
            prop_assert_eq!(switch.seen_safe, seen);
            prop_assert!(!switch.human || seen);
            match region {
                Region::Safe => prop_assert_eq!(switch.k(), 1.0),
                Region::Danger => prop_assert_eq!(switch.k(), 0.0),
                _ => {}
            }
        }
    }

    /// (14) selects bit for bit, whatever the other input is.
    #[test]
    fn selection_is_exact(a in [anything(), anything()], b in [anything(), anything()]) {
        prop_assert_eq!(select(true, a, b).map(f64::to_bits), b.map(f64::to_bits));
        prop_assert_eq!(select(false, a, b).map(f64::to_bits), a.map(f64::to_bits));
    }

    /// The signal to the person is within [0, 1], 1 in the dangerous set, and does not grow with D.
    #[test]
    fn danger_falls_with_distance(
        d in anything(), more in 0.0..5.0f64, v in -0.7..0.7f64, (b1, b2) in bounds(),
    ) {
        let at = |d: f64| danger(classify_total(d, d, v, b1, b2), d, v, b1, b2, 0.5);
        let here = at(d);
        prop_assert!((0.0..=1.0).contains(&here));
        if classify_total(d, d, v, b1, b2) == Region::Danger {
            prop_assert_eq!(here, 1.0);
        }
        prop_assert!(d.is_nan() || at(d + more) <= here);
        prop_assert_eq!(at(b2 + 0.5), 0.0);
    }

    /// S1 keeps the curvature and the limits, never turns anything round, and leaves what is within
    /// the limits alone, bit for bit. Clipping keeps the limits.
    #[test]
    fn scaling_keeps_the_curvature(v in -5.0..5.0f64, omega in -9.0..9.0f64) {
        let limits = Limits([0.7, 2.0]);
        let [vs, os] = scale([v, omega], &limits);
        prop_assert_eq!(scale_velocities([v, omega], &limits), [vs, os]);
        prop_assert!(vs.abs() <= 0.7 && os.abs() <= 2.0);
        prop_assert!((vs * omega - os * v).abs() < 1e-12 * (1.0 + (v * omega).abs()));
        prop_assert!(vs * v >= 0.0 && os * omega >= 0.0);
        let at_limit = vs.abs() > 0.7 - 1e-12 || os.abs() > 2.0 - 1e-12;
        prop_assert!(at_limit || [vs, os] == [v, omega]);
        let [vc, oc] = clip([v, omega], &limits);
        prop_assert!(vc.abs() <= 0.7 && oc.abs() <= 2.0);
        prop_assert!(v.abs() > 0.7 || vc.to_bits() == v.to_bits());
        prop_assert!(omega.abs() > 2.0 || oc.to_bits() == omega.to_bits());
    }

    /// S1 where the law asks for absurd turns: a tenth of the speed stays, if within its limit.
    #[test]
    fn scaling_leaves_a_tenth_of_the_speed(v in -20.0..20.0f64, omega in 20.0..1e6f64) {
        let [vs, os] = scale_velocities([v, omega], &Limits([0.7, 2.0]));
        prop_assert!((vs - (0.1 * v).clamp(-0.7, 0.7)).abs() < 1e-12);
        prop_assert!((os - 2.0).abs() < 1e-12);
    }

    /// S2: idempotent, never faster, never another way, never touches ω, identity when far and at
    /// rest; and within a straight wall's half-plane one period never crosses the wall.
    #[test]
    fn projection_is_a_projection(
        v in -0.7..0.7f64, omega in -2.0..2.0f64, heading in -7.0..7.0f64, wall_m in -0.1..3.0f64,
    ) {
        let cone = Cone {
            period_s: 0.1, guard_m: 0.02, v_disc_mps: 0.3, spread_rad: 0.05,
            turning_s: 0.1, omega_now_radps: 0.0, brake_mps2: None,
        };
        // A wall at x = wall_m, the robot at the origin.
        let ray = |angle: f64| {
            let cos = libm::cos(angle);
            if cos > 1e-12 { wall_m / cos } else { f64::INFINITY }
        };
        let once = cone.project([v, omega], heading, ray);
        let twice = cone.project(once, heading, ray);
        prop_assert_eq!(once.map(f64::to_bits), twice.map(f64::to_bits));
        prop_assert_eq!(once[1].to_bits(), omega.to_bits());
        prop_assert!(once[0].abs() <= v.abs() && once[0] * v >= 0.0);
        if wall_m > 0.02 + 0.03 + 0.07 || v == 0.0 {
            prop_assert_eq!(once[0].to_bits(), v.to_bits());
        }
        // The farthest that the arc can come towards the wall in one period.
        let samples = 200;
        let mut x = 0.0;
        for i in 0..samples {
            let t = (f64::from(i) + 0.5) / f64::from(samples) * 0.1;
            x += once[0] * libm::cos(heading + omega * t) * 0.1 / f64::from(samples);
            prop_assert!(x <= wall_m.max(0.0) + 1e-9);
        }
        // What is not known stops.
        let blind = cone.project([v, omega], heading, |_| f64::NAN);
        prop_assert_eq!(blind[0], 0.0);
    }

    /// With a plant that brakes at a, what is allowed can still stop: v Ts + v²/(2a) fits.
    #[test]
    fn a_slow_plant_can_still_stop(free_m in -0.5..3.0f64) {
        let cone = Cone {
            period_s: 0.1, guard_m: 0.02, v_disc_mps: 0.0, spread_rad: 0.05,
            turning_s: 0.5, omega_now_radps: 0.0, brake_mps2: Some(0.3),
        };
        let v = cone.speed_limit_mps(free_m);
        let needed_m = v * 0.1 + v * v / 0.6;
        prop_assert!(v >= 0.0);
        if free_m > 0.02 {
            prop_assert!((needed_m - (free_m - 0.02)).abs() < 1e-9);
        } else {
            prop_assert_eq!(v, 0.0);
        }
    }

    /// S3: idempotent, within the limits, identity when far, and never more speed than asked for.
    #[test]
    fn braking_is_a_projection(
        v in -0.7..0.7f64, omega in -2.0..2.0f64, u1 in -2.0..2.0f64, u2 in -6.0..6.0f64,
        heading in -7.0..7.0f64, wall_m in -0.1..4.0f64,
    ) {
        let braking = Braking { v_mps: v, omega_radps: omega, ..BRAKING };
        let ray = |angle: f64| {
            let cos = libm::cos(angle);
            if cos > 1e-12 { wall_m / cos } else { f64::INFINITY }
        };
        let once = braking.project([u1, u2], heading, ray);
        let twice = braking.project(once, heading, ray);
        prop_assert_eq!(once.map(f64::to_bits), twice.map(f64::to_bits));
        prop_assert_eq!(once[1].to_bits(), u2.to_bits());
        prop_assert!(once[0].abs() <= 2.0);
        let (asked, next) = (v + u1 * 0.1, v + once[0] * 0.1);
        let hardest = (v.abs() - 0.2).max(0.0);
        prop_assert!(next.abs() <= asked.abs().max(hardest) + 1e-12, "{} {}", asked, next);
        if wall_m > 1.0 {
            prop_assert_eq!(once.map(f64::to_bits), [u1, u2].map(f64::to_bits));
        }
        // What is not known brakes.
        let blind = braking.project([u1, u2], heading, |_| f64::NAN);
        prop_assert!((v + blind[0] * 0.1).abs() <= hardest + 1e-12);
    }

    /// S3, step after step, whatever is asked for: a robot of accelerations that starts at rest in
    /// a room of four walls never leaves it. (Recursive feasibility: tested, not proved.)
    #[test]
    fn braking_keeps_a_room(
        half_m in 0.3..2.0f64,
        asked in prop::collection::vec(([-2.0..2.0f64, -6.0..6.0f64], 1..8usize), 5..40),
    ) {
        let (mut x, mut y, mut heading, mut v, mut omega) = (0.0_f64, 0.0_f64, 0.3, 0.0, 0.0);
        for (u, periods) in asked {
            for _ in 0..periods {
                let ray = |angle: f64| {
                    let (sin, cos) = libm::sincos(angle);
                    let along = |at: f64, step: f64| {
                        if step > 1e-12 { (half_m - at) / step }
                        else if step < -1e-12 { (-half_m - at) / step }
                        else { f64::INFINITY }
                    };
                    along(x, cos).min(along(y, sin))
                };
                let limits = Limits([0.7, 2.0]);
                let wanted = clip([v + u[0] * 0.1, omega + u[1] * 0.1], &limits);
                let u = [(wanted[0] - v) / 0.1, (wanted[1] - omega) / 0.1];
                let braking = Braking { v_mps: v, omega_radps: omega, ..BRAKING };
                let [u1, u2] = braking.project(u, heading, ray);
                for _ in 0..20 {
                    let dt = 0.1 / 20.0;
                    let (middle_v, middle) =
                        (v + 0.5 * u1 * dt, heading + 0.5 * omega * dt);
                    x += middle_v * libm::cos(middle) * dt;
                    y += middle_v * libm::sin(middle) * dt;
                    heading += (omega + 0.5 * u2 * dt) * dt;
                    v += u1 * dt;
                    omega += u2 * dt;
                    prop_assert!(x.abs() < half_m && y.abs() < half_m, "{x} {y} of {half_m}");
                }
            }
        }
    }
}

const BRAKING: Braking = Braking {
    period_s: 0.1,
    guard_m: 0.02,
    v_disc_mps: 0.0,
    spread_rad: 0.05,
    accel_mps2: 2.0,
    alpha_radps2: 6.0,
    v_mps: 0.0,
    omega_radps: 0.0,
};
