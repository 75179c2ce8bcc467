//! Edges: what a limit itself counts as, and when an additive metric grows.

use super::close;
use crate::metrics::CATALOGUE;
use crate::synthetic::Run;

/// A step every 0.1 s in which the person asks to turn at so much and the robot turns at so much.
fn turning(asked_radps: f64, done_radps: f64) -> Run {
    let mut run = Run::new();
    for i in 0..10 {
        let t_s = f64::from(i) * 0.1;
        run.step(t_s, |step| {
            (step.v_h_mps, step.omega_h_radps) = (0.0, asked_radps);
            (step.u_h, step.u_s) = ([0.0, asked_radps], [0.0, done_radps]);
        });
        run.command(t_s, 0.0, done_radps);
    }
    run
}

/// Limits are strict: of 2 rad/s, 0.1 is 0.05, which is what an intervention and a request have to exceed.
#[test]
fn what_is_just_at_a_limit_is_not_above_it() {
    assert_eq!(turning(0.0, 0.1).metric("interventions_per_min"), Some(0.0));
    assert!(turning(0.0, 0.100_001).metric("interventions_per_min") > Some(0.0));
    assert_eq!(turning(0.1, 0.1).metric("cosine"), None);
    close(turning(0.100_001, 0.2).metric("cosine"), 1.0);
}

/// Two seconds in which nothing happens, then two in which the law turns a robot that stands at 0.05 m:
/// what adds up does so then, and all of it is in the profile.
#[test]
fn the_profile_says_when_a_metric_grew() {
    let mut run = Run::new();
    for i in 0..40 {
        let (t_s, late) = (f64::from(i) * 0.1, i >= 20);
        run.truth(t_s, |truth| {
            truth.clearance_m = if late { 0.05 } else { 1.0 };
            truth.clearance_static_m = truth.clearance_m;
            truth.v_mps = if late { 0.0 } else { 0.5 };
        });
        run.step(t_s, |step| step.k = if late { 0.0 } else { 1.0 });
        let (v, omega) = if late { (0.0, 0.4) } else { (0.5, 0.0) };
        run.command(t_s, v, omega);
    }
    let measured = run.measured();
    for name in [
        "near_miss_s",
        "interventions_per_min",
        "switches_per_min",
        "deadlock_s",
        "override_m",
        "override_rad",
    ] {
        let i = CATALOGUE.iter().position(|metric| metric.name == name).expect(name);
        let bins = measured.profile.contributions(i, 0.25);
        let value = measured.metrics.get(name).expect(name);
        assert!(value > 0.0, "{name}");
        // 2 s are eight bins.
        assert!(bins.iter().take(8).all(|bin| *bin == 0.0), "{name}: {bins:?}");
        assert!((bins.iter().sum::<f64>() - value).abs() < 1e-9, "{name}: {bins:?} of {value}");
    }
}
