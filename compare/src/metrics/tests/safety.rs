//! Clearance, contact, and leaving the admissible set.

use schemas::{Disc, Pose};

use super::close;
use crate::metrics::ViolationKind;
use crate::synthetic::Run;

#[test]
fn min_clearance_is_the_least_over_the_run() {
    close(Run::clearances(&[0.5, 0.2, 0.3]).metric("min_clearance_m"), 0.2);
    close(Run::clearances(&[0.5, -0.1, f64::NAN]).metric("min_clearance_m"), -0.1);
    // Nothing to keep clear of, or nothing known.
    assert_eq!(Run::clearances(&[f64::INFINITY]).metric("min_clearance_m"), None);
    assert_eq!(Run::clearances(&[f64::NAN]).metric("min_clearance_m"), None);
}

#[test]
fn near_miss_is_the_time_below_a_tenth_of_a_metre_and_clear() {
    // Each sample stands 0.1 s, the last one no time: 0.05 counts, 0.1 and 0 do not.
    close(Run::clearances(&[0.05, 0.1, 0.0, -0.1, 0.09, 0.05]).metric("near_miss_s"), 0.2);
    close(Run::clearances(&[1.0, 1.0]).metric("near_miss_s"), 0.0);
    assert_eq!(Run::clearances(&[f64::NAN, f64::NAN]).metric("near_miss_s"), None);
}

#[test]
fn a_hole_in_the_record_is_not_filled() {
    // 0.05 m at 0 s, next known at 10 s: at most 0.5 s of it is a near miss.
    let mut run = Run::new();
    run.truth(0.0, |truth| truth.clearance_m = 0.05).truth(10.0, |_| {}).step(10.0, |_| {});
    close(run.metric("near_miss_s"), 0.5);
}

#[test]
fn collisions_are_maximal_intervals_of_contact() {
    // Contact at 0.1..0.2 and at 0.5; touching (d = 0) is contact; NaN neither ends nor starts one.
    let run = Run::clearances(&[0.1, 0.0, -0.1, f64::NAN, 0.2, -0.05, 0.3]);
    close(run.metric("collisions"), 2.0);
    let run = Run::clearances(&[-0.1, f64::NAN, -0.1]);
    close(run.metric("collisions"), 1.0);
    close(Run::clearances(&[0.1]).metric("collisions"), 0.0);
    assert_eq!(Run::clearances(&[f64::NAN]).metric("collisions"), None);
}

#[test]
fn contact_speed_is_that_of_the_fastest_first_touch() {
    let mut run = Run::new();
    // Touches backwards at 0.3 m/s, gets faster while in contact, then touches again at 0.1 m/s.
    for (i, (clearance_m, v_mps)) in
        [(0.1, -0.4), (0.0, -0.3), (-0.1, -0.6), (0.1, 0.0), (-0.1, 0.1)].into_iter().enumerate()
    {
        run.truth(i as f64 * 0.1, |truth| {
            truth.clearance_m = clearance_m;
            truth.v_mps = v_mps;
        });
    }
    run.step(0.0, |_| {});
    close(run.metric("contact_speed_mps"), 0.3);
    assert_eq!(Run::clearances(&[1.0]).metric("contact_speed_mps"), None);
}

#[test]
fn every_leaving_of_the_static_admissible_set_is_counted_and_listed() {
    // Outside at 0.1..0.2, back on the edge at 0.3, outside again at 0.4 until the end.
    let run = Run::clearances(&[0.1, -0.01, -0.03, 0.0, -0.02, -0.02]);
    close(run.metric("invariance_breaches"), 2.0);
    let violations = run.measured().violations;
    assert_eq!(violations.len(), 2);
    let [first, second] = [violations[0], violations[1]];
    assert_eq!(first.kind, ViolationKind::LeftAdmissibleSet);
    close(Some(first.t_s), 0.1);
    close(Some(first.until_s), 0.2);
    close(Some(first.depth_m), 0.03);
    close(Some(first.speed_mps), 0.5);
    close(Some(second.t_s), 0.4);
    close(Some(second.until_s), 0.5);
    // Rounding is not leaving.
    assert!(Run::clearances(&[-1e-12]).measured().violations.is_empty());
    assert_eq!(Run::clearances(&[f64::NAN]).metric("invariance_breaches"), None);
}

#[test]
fn the_first_and_the_worst_leaving_are_told() {
    let run = Run::clearances(&[0.1, -0.01, -0.03, 0.0, -0.02]);
    close(run.metric("invariance_first_s"), 0.1);
    close(run.metric("invariance_worst_m"), 0.03);
    let never = Run::clearances(&[0.1, 0.0]);
    assert_eq!(never.metric("invariance_first_s"), None);
    close(never.metric("invariance_worst_m"), 0.0);
    assert_eq!(Run::clearances(&[f64::NAN]).metric("invariance_worst_m"), None);
}

#[test]
fn the_barrier_condition_allows_half_of_the_clearance_in_a_tenth_of_a_second() {
    // 0.4 → 0.2 is allowed, → 0.09 is not, → 0.04 neither (the same interval), → 0.03 is; then
    // outside, where the way back is not asked for; then 0.2 → 0.05 is another breach.
    let run = Run::clearances(&[0.4, 0.2, 0.09, 0.04, 0.03, -0.1, -0.2, 0.2, 0.05]);
    // 0.03 → −0.1 is a breach of its own.
    close(run.metric("barrier_breaches"), 3.0);
    // Twice as far apart: a quarter must be left.
    let mut slow = Run::new();
    for (t_s, h) in [(0.0, 0.4), (0.2, 0.1), (0.4, 0.024)] {
        slow.truth(t_s, |truth| truth.clearance_static_m = h);
    }
    slow.step(0.0, |_| {});
    close(slow.metric("barrier_breaches"), 1.0);
    assert_eq!(Run::clearances(&[0.4]).metric("barrier_breaches"), None);
}

/// A disc of 0.2 m radius touches the front edge of a body of 0.5 m at the origin when its centre
/// is 0.45 m ahead.
#[test]
fn contact_with_a_disc_is_active_only_when_the_robot_moves_towards_it() {
    let contact = |v_mps: f64, centre_m: [f64; 2]| {
        let mut run = Run::new();
        for (t_s, touching) in [(0.0, false), (0.1, true), (0.2, false)] {
            run.truth(t_s, |truth| {
                truth.pose = Pose::default();
                truth.v_mps = v_mps;
                truth.clearance_m = if touching { -0.05 } else { 0.1 };
                truth.clearance_static_m = 1.0;
                let centre_m = if touching { centre_m } else { [5.0, 5.0] };
                truth.discs = vec![Disc { centre_m, radius_m: 0.2 }];
            });
        }
        run.step(0.0, |_| {});
        let violations = run.measured().violations;
        assert_eq!(violations.len(), 1);
        assert_eq!((violations[0].t_s * 1e3).round(), 100.0);
        close(Some(violations[0].depth_m), 0.05);
        // The static set was not left.
        close(run.metric("invariance_breaches"), 0.0);
        close(run.metric("collisions"), 1.0);
        violations[0].kind
    };
    let ahead = [0.4, 0.0];
    assert_eq!(contact(0.3, ahead), ViolationKind::CollisionDiscActive);
    assert_eq!(contact(0.0, ahead), ViolationKind::CollisionDiscPassive);
    assert_eq!(contact(-0.3, ahead), ViolationKind::CollisionDiscPassive);
    // From the side the forward speed has no component towards the disc.
    assert_eq!(contact(0.3, [0.0, 0.4]), ViolationKind::CollisionDiscPassive);
    assert_eq!(contact(-0.3, [-0.4, 0.0]), ViolationKind::CollisionDiscActive);
}

#[test]
fn a_wall_and_a_disc_at_once_are_two_violations() {
    let mut run = Run::new();
    run.truth(0.0, |truth| {
        truth.pose = Pose::default();
        truth.clearance_m = -0.1;
        truth.clearance_static_m = -0.1;
        truth.discs = vec![Disc { centre_m: [0.4, 0.0], radius_m: 0.2 }];
    });
    run.step(0.0, |_| {});
    let kinds: Vec<_> = run.measured().violations.iter().map(|v| v.kind).collect();
    assert_eq!(kinds, [ViolationKind::LeftAdmissibleSet, ViolationKind::CollisionDiscActive]);
}
