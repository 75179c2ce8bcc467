//! What holds for every run, however broken: nothing panics, nothing is made up.

use proptest::prelude::*;
use schemas::{
    Command, Disc, Event, NS_PER_S, Pose, Reason, SIMULATION_EPOCH, Stamped, Step, Time, Truth,
    Twist,
};

use crate::synthetic::{PERIOD_S, Run, pair, question};
use crate::{CATALOGUE, CompareError, Meter, Tolerances, compare, diff, report};

/// A number that a broken sensor may give.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => -3.0..3.0f64,
        1 => Just(0.0),
        1 => Just(f64::NAN),
        1 => Just(f64::INFINITY),
        1 => Just(f64::NEG_INFINITY),
        1 => Just(1e300),
    ]
}

/// Mostly a multiple of 50 ms; now and then before the start, or far off.
fn any_time() -> impl Strategy<Value = Time> {
    prop_oneof![
        8 => (0u64..40).prop_map(|n| SIMULATION_EPOCH.after_ns(n * NS_PER_S / 20)),
        1 => Just(Time(0)),
        1 => Just(Time(u64::MAX)),
    ]
}

fn any_event() -> impl Strategy<Value = Event> {
    let step = (any_time(), prop::array::uniform8(any_number()), any::<(bool, bool)>()).prop_map(
        |(stamp, x, (human, projected))| {
            let mut step = Step::unknown(stamp, 0);
            step.k = if human { 1.0 } else { x[0] };
            step.v_h_mps = x[1];
            step.omega_h_radps = x[2];
            step.pose = Pose { x_m: x[3], y_m: x[4], theta_rad: x[5] };
            step.v_mps = x[6];
            step.control_period_s = if projected { PERIOD_S } else { x[7] };
            step.projected = projected;
            step.reason = if human { Reason::Human } else { Reason::Danger };
            Event::Step(Box::new(step))
        },
    );
    let command = (any_time(), any_number(), any_number(), any::<bool>()).prop_map(
        |(stamp, v_mps, omega_radps, accelerates)| {
            let accel = accelerates.then_some([v_mps, omega_radps]);
            Event::Command(Command { stamp, twist: Twist { v_mps, omega_radps }, accel })
        },
    );
    let truth = (any_time(), prop::array::uniform8(any_number())).prop_map(|(stamp, x)| {
        Event::Truth(Truth {
            stamp,
            pose: Pose { x_m: x[0], y_m: x[1], theta_rad: x[2] },
            v_mps: x[3],
            omega_radps: x[4],
            clearance_m: x[5],
            clearance_static_m: x[6],
            discs: vec![Disc { centre_m: [x[0], x[7]], radius_m: 0.2 }],
        })
    });
    prop_oneof![3 => step, 3 => command, 2 => truth]
}

/// A run of such events, after one sound step.
fn any_run() -> impl Strategy<Value = Run> {
    prop::collection::vec(any_event(), 0..40).prop_map(|events| {
        let mut run = Run::new();
        run.step(0.0, |step| step.k = 0.0);
        for (i, value) in events.into_iter().enumerate() {
            run.events.push(Stamped { at: SIMULATION_EPOCH.after_ns(10 + i as u64), value });
        }
        run
    })
}

proptest! {
    /// Shares stay shares, counts and times stay non-negative, nothing infinite gets out.
    #[test]
    fn metrics_stay_in_their_range(run in any_run()) {
        let measured = run.measured();
        for (row, value) in CATALOGUE.iter().zip(measured.metrics.values()) {
            let Some(value) = *value else { continue };
            prop_assert!(value.is_finite(), "{}: {value}", row.name);
            let least = match row.name {
                // Overlap is a negative clearance; k is whatever the step says, here down to −3; a
                // stamp may lie before the start.
                "min_clearance_m" | "stop_margin_m" | "human_share" | "sparc"
                | "invariance_first_s" => f64::NEG_INFINITY,
                // Driving away from the goal, or against the request.
                "path_efficiency" | "cosine" => -1.0 - 1e-9,
                _ => 0.0,
            };
            let most = match row.name {
                "path_efficiency" | "cosine" => 1.0 + 1e-9,
                "unwarranted" | "missed" | "goal_reached" => 1.0,
                "min_ttc_s" => 3.0,
                "sparc" => 0.0,
                _ => f64::INFINITY,
            };
            prop_assert!(value <= most, "{}: {value}", row.name);
            prop_assert!(value >= least, "{}: {value}", row.name);
        }
        for violation in &measured.violations {
            prop_assert!(violation.until_s >= violation.t_s);
            prop_assert!(violation.depth_m >= 0.0);
        }
    }

    /// Measuring is a function of the run.
    #[test]
    fn measuring_twice_gives_the_same(run in any_run()) {
        // NaN in the path differs from itself, so compare what is printed.
        prop_assert_eq!(format!("{:?}", run.measured()), format!("{:?}", run.measured()));
    }

    /// A run is the same as itself, and a difference is one from either side.
    #[test]
    fn diffs_are_reflexive_and_symmetric(a in any_run(), b in any_run()) {
        let of = |a: &Run, b: &Run| pair("log", a, b).levels.remove(0).diff.expect("compared").expect("has steps");
        prop_assert!(of(&a, &a).same);
        let (there, back) = (of(&a, &b), of(&b, &a));
        prop_assert_eq!(there.same, back.same);
        prop_assert_eq!(there.compared, back.compared);
        let time = |diff: &crate::Diff| diff.first_cause.as_ref().map(|cause| cause.t_s);
        prop_assert_eq!(time(&there), time(&back));
        prop_assert_eq!(there.same, there.fields.is_empty());
        prop_assert_eq!(there.same, there.first_cause.is_none());
    }

    /// A comparison of broken runs is still a comparison, in every form.
    #[test]
    fn every_report_is_made(a in any_run(), b in any_run()) {
        let made = compare(&question(), vec![pair("log", &a, &b)]);
        let comparison = made.expect("the first step engages");
        prop_assert!(report::html(&comparison).is_ok());
        prop_assert!(report::json(&comparison).is_ok());
        prop_assert!(!report::terminal(&comparison).is_empty());
        prop_assert!(!report::markdown(&comparison).is_empty());
    }

    /// Tolerances only ever take differences away.
    #[test]
    fn a_wider_tolerance_finds_no_more(a in any_run(), b in any_run(), abs in 0.0..4.0f64) {
        let fields = |tolerances: &Tolerances| {
            let (mut x, mut y) = (a.events.iter().cloned(), b.events.iter().cloned());
            let start = SIMULATION_EPOCH;
            diff::<CompareError, _>(
                tolerances, (start, || Ok(x.next())), (start, || Ok(y.next())),
            ).expect("has steps").fields
        };
        let mut wide = Tolerances::exact();
        wide.default.abs = abs;
        let (exact, wide) = (fields(&Tolerances::exact()), fields(&wide));
        for field in &wide {
            let before = exact.iter().find(|other| other.field == field.field);
            prop_assert!(before.is_some_and(|before| before.count >= field.count));
        }
    }
}

/// Two hours at 10 Hz: what is kept of a run does not follow its length, and still adds up and
/// reaches its end.
#[test]
fn what_is_kept_of_a_run_is_bounded() {
    let run = Run::new();
    let mut meter = Meter::new(&run.header);
    for i in 0..72_000u64 {
        let mut one = Run::new();
        let t_s = i as f64 * PERIOD_S;
        let k = if i % 50 < 10 { 0.0 } else { 1.0 };
        one.step(t_s, |step| step.k = k).command(t_s, 0.4, 0.0);
        one.events.iter().for_each(|event| meter.observe(event));
    }
    let measured = meter.finish().expect("has steps");
    assert!(measured.track.points.len() <= 513);
    assert_eq!(measured.track.points.last().map(|p| (p.t_s * 10.0).round()), Some(71_999.0));
    assert_eq!(measured.track.switches.len(), 2880);
    assert!(measured.track.driving_at(7000.0).is_some());
    let column = CATALOGUE.iter().position(|row| row.name == "override_m");
    let column = column.expect("in the catalogue");
    let bins = measured.profile.contributions(column, measured.profile.bin_s());
    assert!(bins.len() <= 1024, "{}", bins.len());
    // 0.1 m/s less than asked for, for 7200 s.
    let sum: f64 = bins.iter().sum();
    assert!((sum - 720.0).abs() < 1e-6, "{sum}");
}
