//! Where a replay parts from its recording, in the words of a diff.

use compare::{CompareError, FirstCause, Tolerances};
use replay::FirstDifference;
use schemas::{Event, Stamped, Step, Time, Value};

/// What differs first between recording, A, and replay, B, of a session that started at `start`.
pub(super) fn first_cause(first: &FirstDifference, start: Time) -> Option<FirstCause> {
    let absent = |step: &&Step| step.values().iter().filter(|v| **v == Value::Absent).count();
    // To a diff a field is lost only where its run has it elsewhere: in a step that both have.
    let elsewhere = first.steps.iter().min_by_key(absent).filter(|_| first.lost);
    let run = |step: &Step| {
        let after = elsewhere.map(|step| Step { stamp: step.stamp.after_ns(1), ..step.clone() });
        let events = [Some(step.clone()), after].into_iter().flatten();
        events.map(|step| Stamped { at: step.stamp, value: Event::Step(Box::new(step)) })
    };
    let [mut a, mut b] = first.steps.each_ref().map(run);
    let a = || Ok::<_, CompareError>(a.next());
    let b = || Ok(b.next());
    compare::diff(&Tolerances::exact(), (start, a), (start, b)).ok()?.first_cause
}
