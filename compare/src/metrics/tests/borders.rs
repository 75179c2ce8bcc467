//! Borders of what counts, away from the origin: what the closest test of a rule by hand leaves open.

use schemas::{Disc, Pose};

use super::close;
use crate::metrics::{CATALOGUE, Violation, ViolationKind};
use crate::synthetic::{PERIOD_S, Run};

/// The violations of a run in which the robot stands at a pose, with one disc beside it, and what is said
/// to be its clearance.
fn beside(pose: Pose, v_mps: f64, disc: Disc, clearance_m: f64) -> Vec<Violation> {
    let mut run = Run::new();
    run.truth(0.0, |truth| {
        (truth.pose, truth.v_mps) = (pose, v_mps);
        (truth.clearance_m, truth.clearance_static_m) = (clearance_m, 1.0);
        truth.discs = vec![disc];
    });
    run.step(0.0, |_| {});
    run.measured().violations
}

/// A disc whose edge is `deep_m` inside the front of a body of 0.5 m that is turned by `theta_rad`,
/// `aside_m` to the left of its middle.
fn before_the_front(pose: Pose, aside_m: f64, deep_m: f64) -> Disc {
    let (sin, cos) = pose.theta_rad.sin_cos();
    let ahead_m = 0.25 + 0.2 - deep_m;
    let centre_m =
        [pose.x_m + cos * ahead_m - sin * aside_m, pose.y_m + sin * ahead_m + cos * aside_m];
    Disc { centre_m, radius_m: 0.2 }
}

/// The same contact, wherever the robot is and whichever way it looks.
#[test]
fn a_contact_is_the_same_everywhere() {
    for theta_rad in [0.0, 0.7, 2.5, -1.9] {
        let pose = Pose { x_m: 2.0, y_m: -3.0, theta_rad };
        for aside_m in [0.0, 0.1, -0.1] {
            let disc = before_the_front(pose, aside_m, 0.03);
            let ahead = beside(pose, 0.3, disc, -0.03);
            assert_eq!(ahead.len(), 1, "{theta_rad} {aside_m}");
            assert_eq!(ahead[0].kind, ViolationKind::CollisionDiscActive);
            close(Some(ahead[0].depth_m), 0.03);
            let away = beside(pose, -0.3, disc, -0.03);
            assert_eq!(away[0].kind, ViolationKind::CollisionDiscPassive);
        }
    }
}

/// 1.5 mm/s towards a disc is active, 1 mm/s is not: the limit is one of speed, whatever the distance.
#[test]
fn a_millimetre_a_second_is_not_yet_active() {
    let pose = Pose::default();
    let disc = before_the_front(pose, 0.0, 0.05);
    let kind = |v_mps| beside(pose, v_mps, disc, -0.05)[0].kind;
    assert_eq!(kind(1.5e-3), ViolationKind::CollisionDiscActive);
    assert_eq!(kind(1.0e-3), ViolationKind::CollisionDiscPassive);
}

/// Touching is contact, and to touch is to be 0 deep in; to stand a hair clear is not.
#[test]
fn to_touch_is_contact() {
    // 0.25 + 0.25: sums of powers of two, so that the distance is 0 exactly.
    let touching = Disc { centre_m: [0.5, 0.0], radius_m: 0.25 };
    let violations = beside(Pose::default(), 0.3, touching, 0.0);
    assert_eq!(violations.len(), 1);
    assert_eq!(violations[0].depth_m, 0.0);
    let clear = Disc { centre_m: [0.500_001, 0.0], ..touching };
    assert_eq!(beside(Pose::default(), 0.3, clear, 0.0), []);
}

/// The set is closed, up to a nanometre of rounding.
#[test]
fn a_nanometre_is_not_outside() {
    assert!(Run::clearances(&[-1e-9]).measured().violations.is_empty());
    assert_eq!(Run::clearances(&[-1.1e-9]).measured().violations.len(), 1);
}

/// What the files and the reports call them, and for which of them a controller answers.
#[test]
fn violations_have_names() {
    let of =
        |kind: ViolationKind| (kind.name(), kind.words(), kind.counts_against_the_controller());
    assert_eq!(
        [
            ViolationKind::LeftAdmissibleSet,
            ViolationKind::CollisionDiscActive,
            ViolationKind::CollisionDiscPassive
        ]
        .map(of),
        [
            ("left_admissible_set", "left the admissible set", true),
            ("collision_disc_active", "moved towards a moving disc that touched it", true),
            ("collision_disc_passive", "was run into by a moving disc", false),
        ]
    );
}

/// k changes every 0.3 s from 2 s on: the changes that undo one within 0.5 s are chatter, and each is in the
/// profile when it happens. The mean of k grows where k is 1.
#[test]
fn chatter_and_the_share_are_in_the_profile() {
    let mut run = Run::new();
    for i in 0..40 {
        let (t_s, late) = (f64::from(i) * PERIOD_S, i >= 20);
        let k = if late && (i / 3) % 2 == 1 { 0.0 } else { 1.0 };
        run.step(t_s, |step| step.k = k).command(t_s, 0.5, 0.0);
    }
    let measured = run.measured();
    let bins = |name: &str| {
        let i = CATALOGUE.iter().position(|metric| metric.name == name).expect("a metric");
        measured.profile.contributions(i, 1.0)
    };
    // i = 21, 24, …, 39 change k: seven, of which all but the first undo one 0.3 s old; 4 s are a fifteenth
    // of a minute. 2.1 s; then 2.4, 2.7; then 3.0, 3.3, 3.6, 3.9 s.
    close(measured.metrics.get("chatter_per_min"), 6.0 * 15.0);
    let per_change = 15.0;
    let want = [0.0, 0.0, 2.0, 4.0].map(|changes| changes * per_change);
    let got = bins("chatter_per_min");
    assert!(
        got.len() == 4 && got.iter().zip(want).all(|(got, want)| (got - want).abs() < 1e-9),
        "{got:?}"
    );
    // 0.1 s each of k = 1, of 4 s: 10, 10, then 2.0, 2.4–2.6: 4, then 3.0–3.2, 3.6–3.8: 6.
    let got = bins("human_share");
    let want = [10.0, 10.0, 4.0, 6.0].map(|steps| steps / 40.0);
    assert!(
        got.len() == 4 && got.iter().zip(want).all(|(got, want)| (got - want).abs() < 1e-9),
        "{got:?}"
    );
}

/// Without time in which something could have happened there is no rate.
#[test]
fn no_time_has_no_rate() {
    let mut run = Run::new();
    run.step(0.0, |step| step.control_period_s = 0.0).command(0.0, 0.5, 0.0);
    assert_eq!(run.metric("switches_per_min"), None);
    assert_eq!(run.metric("human_share"), None);
}

/// Interventions less than 0.3 s apart are one, those just 0.3 s apart are two.
#[test]
fn interventions_merge_below_three_tenths_of_a_second() {
    let steps = |gap: usize| {
        let human = (1.0, [0.5, 0.0]);
        let law = (0.0, [0.1, 0.0]);
        let mut steps = vec![law];
        steps.extend(std::iter::repeat_n(human, gap));
        steps.push(law);
        steps.resize(10, human);
        Run::decisions(&steps).metric("interventions_per_min")
    };
    // Of one second.
    close(steps(2), 60.0);
    close(steps(3), 120.0);
}

/// A contact that the robot first suffers and then presses on with is its own doing, at the speed that it then has.
#[test]
fn one_active_moment_makes_a_contact_active() {
    let stretch = |speeds_mps: [f64; 2]| {
        let mut run = Run::new();
        for (t_s, v_mps) in [0.0, 0.1].into_iter().zip(speeds_mps) {
            run.truth(t_s, |truth| {
                (truth.pose, truth.v_mps) = (Pose::default(), v_mps);
                (truth.clearance_m, truth.clearance_static_m) = (-0.05, 1.0);
                truth.discs = vec![before_the_front(Pose::default(), 0.0, 0.05)];
            });
        }
        run.step(0.0, |_| {});
        let violations = run.measured().violations;
        assert_eq!(violations.len(), 1);
        (violations[0].kind, violations[0].speed_mps)
    };
    assert_eq!(stretch([0.0, 0.3]), (ViolationKind::CollisionDiscActive, 0.3));
    assert_eq!(stretch([0.3, 0.2]), (ViolationKind::CollisionDiscActive, 0.3));
    assert_eq!(stretch([0.0, 0.0]), (ViolationKind::CollisionDiscPassive, 0.0));
    assert_eq!(stretch([-0.2, 0.0]), (ViolationKind::CollisionDiscPassive, 0.2));
}

/// Half of the clearance in 0.1 s is allowed, and from the edge itself nothing is asked for; two samples of
/// one instant say nothing about a rate. A breach is in the profile when it happens.
#[test]
fn half_of_the_clearance_may_be_used_up() {
    // A power of ½ to the power 1, and 0.1 s that is 0.1 s exactly: from 0 on.
    close(Run::clearances(&[0.5, 0.25]).metric("barrier_breaches"), 0.0);
    close(Run::clearances(&[0.5, 0.249]).metric("barrier_breaches"), 1.0);
    close(Run::clearances(&[0.0, -0.1]).metric("barrier_breaches"), 0.0);
    let mut twice = Run::new();
    twice.truth(0.0, |truth| truth.clearance_static_m = 0.5);
    twice.truth(0.0, |truth| truth.clearance_static_m = 0.1).step(0.0, |_| {});
    assert_eq!(twice.metric("barrier_breaches"), None);

    let mut clearances_m = vec![0.5; 40];
    clearances_m[25] = 0.1;
    let measured = Run::clearances(&clearances_m).measured();
    let i =
        CATALOGUE.iter().position(|metric| metric.name == "barrier_breaches").expect("a metric");
    assert_eq!(measured.profile.contributions(i, 1.0), [0.0, 0.0, 1.0]);
}

/// Only what adds up over time has moments that carry it.
#[test]
fn what_does_not_add_up_has_no_profile() {
    let mut run = Run::clearances(&[0.5, 0.05, 0.5]);
    run.command(0.0, 0.1, 0.0);
    let measured = run.measured();
    let bins = |name: &str| {
        let i = CATALOGUE.iter().position(|metric| metric.name == name).expect("a metric");
        measured.profile.contributions(i, 1.0)
    };
    assert!(!bins("near_miss_s").is_empty());
    for name in ["min_clearance_m", "collisions", "invariance_breaches", "cosine"] {
        assert!(bins(name).is_empty(), "{name}");
    }
}

/// The depth of a disc whose middle is inside the body: its radius, and the least way out for the middle.
#[test]
fn a_disc_may_be_deep_inside() {
    let disc = Disc { centre_m: [0.1, 0.05], radius_m: 0.2 };
    let violations = beside(Pose::default(), 0.0, disc, -0.35);
    assert_eq!(violations.len(), 1);
    close(Some(violations[0].depth_m), 0.2 + 0.15);
}
