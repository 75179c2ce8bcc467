//! What differs, what does not, and what differed first.

use schemas::{Event, LawBranch, Reason, Stamped, Time};

use super::{Diff, Differ, Next, Reading, Tolerances, diff};
use crate::CompareError;
use crate::synthetic::{Run, at};

fn between(a: &Run, b: &Run, tolerances: &Tolerances) -> Diff {
    let mut next_a = a.events.iter().cloned();
    let mut next_b = b.events.iter().cloned();
    diff::<CompareError, _>(
        tolerances,
        (a.header.run.start, || Ok(next_a.next())),
        (b.header.run.start, || Ok(next_b.next())),
    )
    .expect("both runs have steps")
}

fn exact(a: &Run, b: &Run) -> Diff {
    between(a, b, &Tolerances::exact())
}

/// Three steps with a command each; `change` may alter the events.
fn run() -> Run {
    let mut run = Run::new();
    for i in 0..3 {
        let t_s = f64::from(i) * 0.1;
        run.truth(t_s, |_| {}).step(t_s, |_| {}).command(t_s, 0.5, 0.0);
    }
    run
}

/// Alters the n-th step of a run.
fn with_step(mut run: Run, n: usize, change: impl FnOnce(&mut schemas::Step)) -> Run {
    let steps = run.events.iter_mut().filter_map(|event| match &mut event.value {
        Event::Step(step) => Some(step),
        _ => None,
    });
    change(steps.into_iter().nth(n).expect("there is such a step"));
    run
}

fn fields(diff: &Diff) -> Vec<&str> {
    diff.fields.iter().map(|field| field.field.as_str()).collect()
}

/// A against A: the same, with as much compared as there is. NaN, of which these steps are full,
/// equals NaN.
#[test]
fn a_run_against_itself_is_the_same() {
    let diff = exact(&run(), &run());
    assert!(diff.same && diff.same_behaviour);
    assert_eq!((diff.compared.steps, diff.compared.messages), (3, 6));
    assert_eq!((diff.fields.len(), diff.first_cause), (0, None));
}

/// A field that only one run has, the other being from before it, differs in nothing; where both have it,
/// it is compared like any other, with the tolerance of its unit.
#[test]
fn a_field_that_one_run_lacks_says_nothing() {
    let with = |unknown, clear_m| {
        with_step(run(), 1, |step| (step.sonars_unknown, step.safety_clear_m) = (unknown, clear_m))
    };
    let a = with(Some(0), Some(0.5));
    assert!(exact(&a, &run()).same && exact(&run(), &a).same);
    let diff = exact(&a, &with(Some(1), Some(0.5)));
    assert_eq!(fields(&diff), ["sonars_unknown"]);
    assert_eq!(diff.first_cause.expect("something differs").node, "distances");
    let nearly = with(Some(0), Some(0.5004));
    assert_eq!(fields(&exact(&a, &nearly)), ["safety_clear_m"]);
    assert!(between(&a, &nearly, &Tolerances::practical()).same);
    let far = with(Some(0), Some(f64::INFINITY));
    assert_eq!(fields(&between(&a, &far, &Tolerances::practical())), ["safety_clear_m"]);
}

/// A run that has a field in some steps and lacks it in one is not from before it: it differs there, and
/// nowhere else, whichever side it is on and whenever the step comes.
#[test]
fn a_field_that_a_run_lost_is_a_difference() {
    let clear = |lost: Option<usize>| {
        (0..3).fold(run(), |run, n| {
            with_step(run, n, |step| step.safety_clear_m = (lost != Some(n)).then_some(0.31))
        })
    };
    let never = with_step(clear(Some(0)), 1, |step| step.safety_clear_m = None);
    let never = with_step(never, 2, |step| step.safety_clear_m = None);
    assert!(exact(&clear(None), &never).same && exact(&never, &clear(None)).same);
    for (n, t_s) in [(0, 0.0), (1, 0.1), (2, 0.2)] {
        for (a, b) in [(clear(None), clear(Some(n))), (clear(Some(n)), clear(None))] {
            let diff = exact(&a, &b);
            assert!(!diff.same && !diff.same_behaviour);
            assert_eq!(fields(&diff), ["safety_clear_m"]);
            let field = &diff.fields[0];
            assert_eq!((field.first_at_s, field.count, field.undefined), (t_s, 1, 1));
            assert_eq!((field.max_abs, diff.compared.differing), (None, 1));
            let cause = diff.first_cause.expect("something differs");
            assert_eq!((cause.t_s, cause.node.as_str()), (t_s, "distances"));
            assert!(cause.reason.contains("safety_clear_m is"), "{}", cause.reason);
            assert!(cause.reason.contains("absent in "), "{}", cause.reason);
            assert!(cause.reason.contains("0.310 m in "), "{}", cause.reason);
        }
    }
    // Each has it where the other lacks it; and beside a difference in amount.
    let diff = exact(&clear(Some(0)), &clear(Some(2)));
    assert_eq!((diff.fields[0].count, diff.compared.differing), (2, 2));
    let other = with_step(clear(Some(0)), 2, |step| {
        (step.safety_clear_m, step.d1_m) = (Some(0.41), 2.0);
    });
    let diff = exact(&clear(None), &other);
    assert_eq!(fields(&diff), ["d1_m", "safety_clear_m"]);
    let field = &diff.fields[1];
    assert_eq!((field.first_at_s, field.count, field.undefined), (0.0, 2, 1));
    assert!((field.max_abs.expect("both have a number at 0.2 s") - 0.1).abs() < 1e-12);
    assert_eq!((diff.compared.differing, diff.first_cause.expect("differs").t_s), (2, 0.0));
    // A message that only one run lacks a field in is no difference where the field is ignored.
    let ignoring = Tolerances::from_toml("ignore = [\"safety_clear_m\"]").expect("valid");
    assert!(between(&clear(None), &clear(Some(1)), &ignoring).same);
}

#[test]
fn only_the_time_from_the_start_counts() {
    let mut later = run();
    let hour_ns = 3_600_000_000_000;
    later.header.run.start = later.header.run.start.after_ns(hour_ns);
    for event in &mut later.events {
        event.at = event.at.after_ns(hour_ns);
        match &mut event.value {
            Event::Step(step) => step.stamp = step.stamp.after_ns(hour_ns),
            Event::Command(command) => command.stamp = command.stamp.after_ns(hour_ns),
            _ => {}
        }
    }
    assert!(exact(&run(), &later).same);
}

#[test]
fn a_number_tells_how_far_how_often_and_since_when() {
    let mut b = with_step(run(), 1, |step| step.d1_m = 1.5);
    b = with_step(b, 2, |step| step.d1_m = 1.0);
    let mut a = with_step(run(), 1, |step| step.d1_m = 1.0);
    a = with_step(a, 2, |step| step.d1_m = 1.1);
    let diff = exact(&a, &b);
    assert!(!diff.same && !diff.same_behaviour);
    assert_eq!(fields(&diff), ["d1_m"]);
    let field = &diff.fields[0];
    assert_eq!((field.node.as_str(), field.unit.as_str()), ("distances", "m"));
    assert_eq!(field.max_abs, Some(0.5));
    assert_eq!(field.max_abs_at_s, Some(0.1));
    assert_eq!(field.max_rel, Some(0.5 / 1.5));
    assert_eq!((field.first_at_s, field.count, field.undefined), (0.1, 2, 0));
    assert_eq!(diff.compared.differing, 2);
}

/// 3.1 and −3.1 are 2π − 6.2 apart as directions, and 6.2 as rates and deviations. To the bit they are
/// not the same, nor is a direction a whole turn further.
#[test]
fn directions_differ_the_short_way_round() {
    let small = std::f64::consts::TAU - 6.2;
    let both = |set: fn(&mut schemas::Step, f64)| {
        let with = |value| with_step(run(), 1, |step| set(step, value));
        exact(&with(3.1), &with(-3.1)).fields.remove(0)
    };
    for (name, set) in [
        ("pose.theta_rad", (|s, x| s.pose.theta_rad = x) as fn(&mut schemas::Step, f64)),
        ("roll_rad", |s, x| s.roll_rad = x),
        ("pitch_rad", |s, x| s.pitch_rad = x),
        ("yaw_rad", |s, x| s.yaw_rad = x),
        ("psi_rad", |s, x| s.psi_rad = x),
        ("theta_e_rad", |s, x| s.theta_e_rad = x),
        ("theta_star_rad", |s, x| s.theta_star_rad = x),
    ] {
        let field = both(set);
        assert_eq!(field.field, name);
        assert!((field.max_abs.expect("two numbers") - small).abs() < 1e-12, "{field:?}");
        assert!((field.max_rel.expect("two numbers") - small / 3.1).abs() < 1e-12, "{field:?}");
    }
    for set in [
        (|s, x| s.omega_radps = x) as fn(&mut schemas::Step, f64),
        |s, x| s.sigma_theta_rad = x,
        |s, x| s.u_f[1] = x,
        |s, x| s.pose.y_m = x,
    ] {
        assert_eq!(both(set).max_abs, Some(6.2));
    }
    let heading = |theta_rad| with_step(run(), 1, |step| step.pose.theta_rad = theta_rad);
    let (east, once_round) = (heading(0.5), heading(0.5 + std::f64::consts::TAU));
    assert!(!exact(&east, &once_round).same);
    assert!(between(&east, &once_round, &Tolerances::practical()).same);
    assert!(!between(&east, &heading(0.502), &Tolerances::practical()).same);
    assert_eq!(fields(&exact(&heading(f64::INFINITY), &heading(f64::NEG_INFINITY))).len(), 1);
}

#[test]
fn nan_against_a_number_is_a_difference_without_an_amount() {
    let b = with_step(run(), 0, |step| step.z1 = 0.25);
    let diff = exact(&run(), &b);
    assert_eq!(fields(&diff), ["z1"]);
    let field = &diff.fields[0];
    assert_eq!((field.max_abs, field.max_rel), (None, None));
    assert_eq!((field.count, field.undefined), (1, 1));
    let cause = diff.first_cause.expect("something differs");
    assert_eq!((cause.a, cause.b), (Reading::Number(f64::NAN), Reading::Number(0.25)));
    // No tolerance makes a number out of NaN.
    let wide = Tolerances::from_toml("[default]\nabs = inf\nrel = inf").expect("valid");
    assert!(!between(&run(), &b, &wide).same);
}

#[test]
fn infinities_equal_themselves_only() {
    let inf = with_step(run(), 0, |step| step.distance_human_m = f64::INFINITY);
    assert!(exact(&inf, &inf).same);
    let finite = with_step(run(), 0, |step| step.distance_human_m = 3.0);
    let diff = exact(&inf, &finite);
    assert_eq!((diff.fields[0].max_abs, diff.fields[0].undefined), (None, 0));
}

#[test]
fn a_step_that_one_run_lacks_has_a_row_of_its_own() {
    let mut shorter = run();
    // Without the second step, and without the last step and command.
    shorter
        .events
        .retain(|event| !(event.at == at(0.1).after_ns(6) || event.at > at(0.2).after_ns(5)));
    let diff = exact(&run(), &shorter);
    assert_eq!(diff.compared.steps, 1);
    // One step and two commands.
    assert_eq!(diff.compared.messages, 3);
    let rows: Vec<_> =
        diff.fields.iter().map(|f| (f.field.as_str(), f.count, f.first_at_s)).collect();
    assert_eq!(rows, [("steps_only_in_a", 2, 0.1), ("commands_only_in_a", 1, 0.2)]);
    let cause = diff.first_cause.expect("something differs");
    assert_eq!((cause.field.as_str(), cause.node.as_str()), ("steps_only_in_a", "input"));
    assert_eq!(cause.t_s, 0.1);

    let mirrored = exact(&shorter, &run());
    assert_eq!(fields(&mirrored), ["steps_only_in_b", "commands_only_in_b"]);
}

#[test]
fn another_period_compares_the_instants_that_both_have() {
    let mut fast = Run::new();
    for i in 0..5 {
        fast.step(f64::from(i) * 0.05, |_| {});
    }
    let mut slow = Run::new();
    for i in 0..3 {
        slow.step(f64::from(i) * 0.1, |_| {});
    }
    let diff = exact(&slow, &fast);
    assert_eq!(diff.compared.steps, 3);
    // The indices of the common instants differ from the second on.
    assert_eq!(fields(&diff), ["steps_only_in_b", "step_index"]);
    assert_eq!(diff.fields[0].count, 2);
}

/// The cause is the earliest time, and at that time the earliest stage of the data flow, however
/// large other differences are.
#[test]
fn the_first_cause_is_earliest_in_time_then_in_the_data_flow() {
    let mut a = with_step(run(), 1, |step| {
        step.k = 1.0;
        step.u_s = [0.5, 0.0];
        step.theta_star_rad = 0.1;
        step.d2l_m = 1.0;
    });
    let mut b = with_step(run(), 1, |step| {
        step.k = 0.0;
        step.reason = Reason::Danger;
        step.u_s = [0.0, 2.0];
        step.theta_star_rad = 3.0;
        step.d2l_m = 1.001;
    });
    // At the later step an earlier stage differs: not the first in time.
    a = with_step(a, 2, |step| step.pose.x_m = 0.0);
    b = with_step(b, 2, |step| step.pose.x_m = 9.0);
    let diff = exact(&a, &b);
    let cause = diff.first_cause.as_ref().expect("something differs");
    assert_eq!((cause.node.as_str(), cause.field.as_str()), ("distances", "d2l_m"));
    assert_eq!(cause.t_s, 0.1);
    assert_eq!((&cause.a, &cause.b), (&Reading::Number(1.0), &Reading::Number(1.001)));
    assert_eq!(
        cause.reason,
        "at 0.100 s d2l_m is 1 m in A and 1.001 m in B; everything before the stage `distances` \
         agrees up to then; A gives the reason `human`, B `danger`"
    );
    // The fields themselves stand in the order of the data flow.
    assert_eq!(
        fields(&diff),
        ["pose.x_m", "d2l_m", "theta_star_rad", "k", "reason", "u_s[0]", "u_s[1]"]
    );
    assert_eq!(diff.fields[6].unit, "rad/s");
}

/// The frame of the distances turns with the target: where both differ at once the target is the cause.
/// What the target follows from still comes before it.
#[test]
fn the_target_comes_before_the_distances_that_follow_from_it() {
    let wrong = |estimate: f64| {
        with_step(run(), 1, |step| {
            step.psi_rad = 0.5;
            step.d1_m = 0.7;
            step.target_vx_mps = 0.25;
            step.d_r1_m = 0.3;
            step.pose.y_m = estimate;
        })
    };
    let cause = |a: &Run, b: &Run| exact(a, b).first_cause.expect("something differs");
    let (right, straying) = (with_step(run(), 1, |step| step.pose.y_m = 0.0), wrong(1.0));
    let of_target = cause(&right, &wrong(0.0));
    assert_eq!((of_target.node.as_str(), of_target.field.as_str()), ("reference", "target_vx_mps"));
    assert!(of_target.reason.contains("nothing that the target follows from"));
    assert_eq!(cause(&right, &straying).node, "estimate");
    // Other quantities of the reference come after the distances.
    let both = with_step(run(), 1, |step| (step.d1_m, step.d_r1_m) = (0.7, 0.3));
    assert_eq!(cause(&run(), &both).node, "distances");
}

/// A sentence has the digits of a report, or as many as it takes to tell the two apart.
#[test]
fn a_sentence_tells_the_values_apart() {
    let reason = |a: f64, b: f64| {
        let (a, b) = (with_step(run(), 0, |s| s.z1 = a), with_step(run(), 0, |s| s.z1 = b));
        let reason = exact(&a, &b).first_cause.expect("differs").reason;
        reason.split(';').next().map(str::to_owned).expect("has a first part")
    };
    assert_eq!(reason(1.843_741, 0.5), "at 0.000 s z1 is 1.844 in A and 0.500 in B");
    assert_eq!(
        reason(0.25, 0.250_000_000_000_000_06),
        "at 0.000 s z1 is 0.25 in A and 0.25000000000000006 in B"
    );
    assert_eq!(reason(f64::INFINITY, f64::NAN), "at 0.000 s z1 is inf in A and NaN in B");
}

/// The state hash covers what no field shows; it differs between two versions from the start and
/// must not hide what happens.
#[test]
fn hidden_state_is_the_cause_only_where_nothing_else_is() {
    let hidden = with_step(run(), 0, |step| step.state_hash = 1);
    let diff = exact(&run(), &hidden);
    assert!(!diff.same && diff.same_behaviour);
    assert_eq!(diff.first_cause.expect("something differs").field, "state_hash");

    let both = with_step(hidden, 2, |step| step.law_branch = LawBranch::Rest);
    let diff = exact(&run(), &both);
    assert!(!diff.same_behaviour);
    assert_eq!(diff.first_cause.expect("something differs").field, "law_branch");
}

#[test]
fn commands_are_compared_with_what_they_accelerate() {
    let mut b = run();
    for event in &mut b.events {
        if let Event::Command(command) = &mut event.value {
            command.accel = Some([0.5, 0.0]);
        }
    }
    let diff = exact(&run(), &b);
    assert_eq!(fields(&diff), ["command.accel_mps2", "command.alpha_radps2"]);
    assert_eq!(diff.fields[0].undefined, 3);
}

#[test]
fn tolerances_are_absolute_or_relative_by_field() {
    let a = with_step(run(), 0, |step| {
        step.z1 = 1.0;
        step.u_s = [10.0, 0.0];
    });
    let b = with_step(run(), 0, |step| {
        step.z1 = 1.05;
        step.u_s = [10.1, 0.0];
    });
    let same = |toml: &str| {
        let tolerances = Tolerances::from_toml(toml).expect("valid");
        between(&a, &b, &tolerances).same
    };
    assert!(same("[default]\nabs = 0.11"));
    assert!(same("[default]\nrel = 0.0477\n[fields.u_s]\nrel = 0.01"));
    assert!(same("ignore = [\"u_s\"]\n[fields.z1]\nabs = 0.051"));
    assert!(same("ignore = [\"u_s[0]\", \"z1\"]"));
    assert!(!same("[default]\nabs = 0.09"));
    assert!(!same("[fields.z1]\nabs = 1"));
    assert!(!same(""));
    // What is reported carries its tolerance.
    let tolerances = Tolerances::from_toml("[default]\nabs = 0.07").expect("valid");
    let diff = between(&a, &b, &tolerances);
    assert_eq!(fields(&diff), ["u_s[0]"]);
    assert_eq!(diff.fields[0].tolerance.abs, 0.07);
}

#[test]
fn a_tolerance_file_that_cannot_be_meant_is_refused() {
    for (toml, names) in [
        ("[fields.no_such_field]\nabs = 1", "no_such_field"),
        ("ignore = [\"typo\"]", "typo"),
        ("[default]\nabs = -1.0", "default.abs"),
        ("[fields.z1]\nrel = nan", "z1.rel"),
        ("[default]\nabsolute = 1", "absolute"),
        ("not toml", "toml"),
    ] {
        let error = Tolerances::from_toml(toml).expect_err(toml).to_string();
        assert!(error.contains(names) || toml == "not toml", "{error}");
    }
}

#[test]
fn two_runs_without_a_step_or_command_are_an_error() {
    let mut empty = Run::new();
    empty.truth(0.0, |_| {});
    let mut differ = Differ::new(&Tolerances::exact(), Time(0), Time(0));
    empty.events.iter().for_each(|event| differ.a(event));
    assert!(matches!(differ.finish(), Err(CompareError::NothingToDiff)));
    // One of them empty is a difference, not an error.
    assert_eq!(fields(&exact(&run(), &empty)), ["steps_only_in_a", "commands_only_in_a"]);
}

/// A run that is cut is compared as far as it goes: what the other has beyond is no difference, what it has
/// before is one, and that all is the same nobody can say.
#[test]
fn a_run_that_is_cut_is_compared_as_far_as_it_goes() {
    let cut = |a: &Run, b: &Run, keep: usize, cut_a: bool| {
        let [mut a, mut b] = [(a, cut_a), (b, !cut_a)].map(|(run, is_cut)| {
            let keep = if is_cut { keep } else { run.events.len() };
            let mut events = run.events[..keep].iter().cloned();
            move || {
                Ok(match events.next() {
                    Some(event) => Next::Event(event),
                    None if is_cut => Next::Cut,
                    None => Next::End,
                })
            }
        });
        diff::<CompareError, _>(&Tolerances::exact(), (at(0.0), &mut a), (at(0.0), &mut b))
    };
    // Truth, step, command; after five events the second step is there and its command is not.
    let late = with_step(run(), 2, |step| step.d1_m = 1.0);
    let early = with_step(late.clone(), 1, |step| step.d1_m = 2.0);
    for cut_a in [true, false] {
        let diff = cut(&run(), &late, 5, cut_a).expect("both have steps");
        assert_eq!((diff.compared.steps, diff.compared.messages), (2, 3));
        assert!(diff.fields.is_empty() && diff.first_cause.is_none(), "{diff:?}");
        assert!(!diff.whole && !diff.same && !diff.same_behaviour);
        let diff = cut(&run(), &early, 5, cut_a).expect("both have steps");
        assert_eq!((fields(&diff), diff.fields[0].count, diff.whole), (vec!["d1_m"], 1, false));
        // Cut in its last message or right behind it: nothing more is known.
        let diff = cut(&run(), &run(), 9, cut_a).expect("both have steps");
        assert!(diff.fields.is_empty() && !diff.same);
        let error = cut(&run(), &run(), 1, cut_a).expect_err("no step of it can be read");
        assert!(matches!(error, CompareError::NothingToDiff));
    }
    // A step that is missing before the cut is missing.
    let mut gap = run();
    gap.events.remove(1);
    let diff = cut(&gap, &run(), 8, true).expect("both have steps");
    assert_eq!(fields(&diff), ["steps_only_in_b"]);
    assert!(exact(&run(), &run()).whole);
}

#[test]
fn a_failing_source_ends_the_diff_with_its_error() {
    #[derive(Debug)]
    enum Error {
        Read,
        Compare,
    }
    impl From<CompareError> for Error {
        fn from(_: CompareError) -> Self {
            Error::Compare
        }
    }
    let start = at(0.0);
    let failing = || Err::<Option<Stamped<Event>>, Error>(Error::Read);
    let got = diff(&Tolerances::exact(), (start, failing), (start, || Ok(None)));
    assert!(matches!(got, Err(Error::Read)));
    let got = diff(&Tolerances::exact(), (start, || Ok(None)), (start, || Ok(None)));
    assert!(matches!(got, Err(Error::Compare)));
}

/// Whichever way the two streams are fed, the result is the same.
#[test]
fn the_order_of_feeding_does_not_matter() {
    let a = run();
    let b = with_step(run(), 1, |step| step.k = 0.0);
    let mut differ = Differ::new(&Tolerances::exact(), a.header.run.start, b.header.run.start);
    b.events.iter().for_each(|event| differ.b(event));
    a.events.iter().for_each(|event| differ.a(event));
    assert_eq!(differ.finish().expect("both have steps"), exact(&a, &b));
}

/// The shape that other programs read.
#[test]
fn json_has_the_agreed_keys_and_survives_the_way_back() {
    let b = with_step(run(), 1, |step| step.d1_m = 1.5);
    let diff = exact(&run(), &b);
    let json = serde_json::to_value(&diff).expect("has a JSON form");
    assert_eq!(json["same"], false);
    assert_eq!(json["compared"]["steps"], 3);
    assert_eq!(json["compared"]["messages"], 6);
    for key in ["field", "unit", "max_abs", "max_rel", "first_at_s", "count", "tolerance"] {
        assert!(json["fields"][0].get(key).is_some(), "{key}");
    }
    for key in ["t_s", "node", "field", "a", "b", "reason"] {
        assert!(json["first_cause"].get(key).is_some(), "{key}");
    }
    assert_eq!(json["first_cause"]["a"], "NaN");
    let back: Diff = serde_json::from_value(json).expect("reads its own JSON");
    assert_eq!(back, diff);
    let same = serde_json::to_value(exact(&run(), &run())).expect("has a JSON form");
    assert!(same["first_cause"].is_null());
}

/// Thirty steps of a law that commands velocities, or accelerations; `k` and `u_s` as given by step.
fn commanded(accelerates: bool, u_s: impl Fn(usize) -> f64) -> Run {
    let mut run = Run::new();
    for i in 0..30 {
        let t_s = i as f64 * 0.1;
        let u = u_s(i);
        run.step(t_s, |step| step.u_s = [u, 0.0]);
        let command = schemas::Command {
            stamp: at(t_s),
            twist: schemas::Twist { v_mps: 0.5, omega_radps: 0.0 },
            accel: accelerates.then_some([0.0, 0.0]),
        };
        let value = Event::Command(command);
        run.events.push(Stamped { at: at(t_s).after_ns(7), value });
    }
    run
}

/// An input is a velocity or an acceleration: the commands tell which.
#[test]
fn inputs_have_the_unit_of_their_law() {
    for (accelerates, unit) in [(false, "m/s"), (true, "m/s²")] {
        let diff = exact(&commanded(accelerates, |_| 0.1), &commanded(accelerates, |_| 0.3));
        assert_eq!(diff.fields[0].field, "u_s[0]");
        assert_eq!(diff.fields[0].unit, unit);
        let cause = diff.first_cause.expect("they differ");
        assert_eq!(cause.unit, unit);
        assert!(cause.reason.contains(&format!("0.100 {unit} in A and")), "{}", cause.reason);
    }
    // Laws of both kinds have no common unit.
    let mixed = exact(&commanded(false, |_| 0.1), &commanded(true, |_| 0.3));
    assert_eq!(mixed.fields[0].unit, "m/s or m/s²");
}

#[test]
fn one_step_of_lag_is_told() {
    let wave = |i: usize| libm::sin(0.5 * i as f64);
    let late = exact(&commanded(false, |i| wave(i + 1)), &commanded(false, wave));
    assert_eq!(late.fields[0].lag_steps, Some(1));
    let early = exact(&commanded(false, wave), &commanded(false, |i| wave(i + 2)));
    assert_eq!(early.fields[0].lag_steps, Some(-2));
    let larger = exact(&commanded(false, wave), &commanded(false, |i| 1.1 * wave(i)));
    assert_eq!(larger.fields[0].lag_steps, None);
}

/// What nobody would notice is the same; what somebody would is not; a row of the file comes first.
#[test]
fn practical_tolerances_go_by_unit() {
    let with = |toml: &str, change: fn(&mut schemas::Step)| {
        let tolerances = Tolerances::from_toml(toml).expect("valid");
        between(&run(), &with_step(run(), 1, change), &tolerances).same
    };
    let practical = "base = \"practical\"";
    assert!(with(practical, |step| step.v_mps += 0.0009));
    assert!(!with(practical, |step| step.v_mps += 0.0011));
    assert!(with(practical, |step| step.state_hash = 9));
    assert!(!with("", |step| step.state_hash = 9));
    assert!(!with(practical, |step| step.law_branch = LawBranch::Left));
    let finer = "base = \"practical\"\n[units.\"m/s\"]\nabs = 1e-6";
    assert!(!with(finer, |step| step.v_mps += 0.0009));
    assert!(with(finer, |step| step.pose.x_m += 0.0009));
    let own = "base = \"practical\"\n[fields.v_mps]\nabs = 1.0";
    assert!(with(own, |step| step.v_mps += 0.9));
    let error = Tolerances::from_toml("[units.\"km\"]\nabs = 1.0").expect_err("no such unit");
    assert!(error.to_string().contains("unknown unit \"km\""), "{error}");
}
