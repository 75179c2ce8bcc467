//! What came of a replay, counted while it runs.

use std::sync::Arc;

use schemas::log::LogError;
use schemas::{Event, Field, Lacking, Stamped, Step, Time, Value, wrap};

use crate::{Covered, Fault, Horizon, OutputHash, ReplayError, WarmUp};

/// The largest difference between a replayed and a recorded step.
#[derive(Clone, Debug, PartialEq)]
pub struct Deviation {
    /// Name of the field.
    pub field: &'static str,
    /// Absolute difference in the field's unit; +∞ where only one of the two is a number, or has the field.
    pub amount: f64,
    /// Unit of that; empty for a number without one.
    pub unit: &'static str,
    /// When, seconds from the start of the session.
    pub t_s: f64,
}

/// The first recorded step whose replay says something else.
#[derive(Clone, Debug, PartialEq)]
pub struct FirstDifference {
    /// The recorded step and its replay.
    pub steps: [Step; 2],
    /// What differs is that one of the two lost a field, which both have elsewhere.
    pub lost: bool,
}

/// What came of a replay.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Steps replayed.
    pub steps: u64,
    /// Steps in which the feedback law drove (k = 0).
    pub engaged_steps: u64,
    /// Hash of the replayed messages.
    pub output_hash: String,
    /// Hash of the recorded ones.
    pub recorded_hash: String,
    /// Whether the two agree: every compared message is the recorded one, bit for bit.
    pub identical_to_recorded: bool,
    /// The largest difference from the recorded steps; `None` where no number differs.
    pub max_deviation: Option<Deviation>,
    /// Where the two part; `None` where no step says anything else. The hidden state says nothing.
    pub first_difference: Option<Box<FirstDifference>>,
    /// Simulated or replayed time, seconds.
    pub duration_s: f64,
    /// The last thing that was replayed, seconds from the start of the session.
    pub end_s: f64,
    /// The faults that met nothing that they could change: the log has no such sensor, say.
    pub unmet_faults: Vec<Fault>,
    /// Where the log begins in the middle of its session: its first step, seconds from the session's start.
    /// What the controller had learnt until then is not in it.
    pub begins_late_s: Option<f64>,
    /// Why the replay ended before the log should have, where it did.
    pub damage: Option<String>,
    /// Closed loop: when the simulated run parted from the recorded one.
    pub horizon: Option<Horizon>,
    /// Closed loop: the greatest distance between simulated and recorded state, 1 at half a metre or
    /// one radian. 0 certifies that the person would have seen the same throughout.
    pub furthest: Option<f64>,
    /// Where only a part was replayed: whether its beginning is what the whole log gives.
    pub warm_up: Option<WarmUp>,
}

/// The running count behind an [`Outcome`].
pub(crate) struct Tally {
    start: Time,
    first: Option<Time>,
    last: Time,
    steps: u64,
    engaged_steps: u64,
    replayed: OutputHash,
    recorded: OutputHash,
    /// Of a field that one of both lacks: when first, seconds from the start, and in which step.
    lacking: Lacking<(f64, Box<FirstDifference>)>,
    /// What was replayed with nothing left out of it, from where something is that the recording lacks.
    whole: Option<OutputHash>,
    /// The first step that differs in what both say, and when that is, seconds from the start.
    first_difference: Option<(f64, Box<FirstDifference>)>,
    /// Index and time of the first recorded step.
    begins: Option<(u64, f64)>,
    deviation: Option<Deviation>,
    pub(crate) damage: Option<Arc<LogError>>,
}

const RECORDED: usize = 0;
const REPLAYED: usize = 1;

impl Tally {
    pub(crate) fn new(covered: Covered, start: Time) -> Tally {
        Tally {
            start,
            first: None,
            last: start,
            steps: 0,
            engaged_steps: 0,
            replayed: OutputHash::new(covered, start),
            recorded: OutputHash::new(covered, start),
            lacking: Lacking::default(),
            whole: None,
            first_difference: None,
            begins: None,
            deviation: None,
            damage: None,
        }
    }

    /// Takes in a replayed event; `recorded` is the recorded step seen last.
    ///
    /// A field that the recording is too old to have is not held against the replay.
    pub(crate) fn replayed(&mut self, event: &Stamped<Event>, recorded: Option<&Step>) {
        self.first.get_or_insert(event.at);
        self.last = event.at;
        let Event::Step(step) = &event.value else { return self.hash(event, event) };
        self.steps += 1;
        self.engaged_steps += u64::from(step.k == 0.0);
        self.lacking.hear(REPLAYED, has(step));
        match recorded.filter(|recorded| recorded.stamp == step.stamp) {
            None => self.hash(event, event),
            Some(recorded) => {
                let mut alike = step.clone();
                alike.leave_out_as(recorded);
                self.compare_steps(step, recorded);
                self.hash(&Stamped { at: event.at, value: Event::Step(alike) }, event);
            }
        }
    }

    /// Adds what was replayed to its hashes: as far as the recording has it, and whole.
    fn hash(&mut self, alike: &Stamped<Event>, whole: &Stamped<Event>) {
        if let Some(hash) = &mut self.whole {
            hash.update(whole);
        }
        self.replayed.update(alike);
    }

    pub(crate) fn recorded(&mut self, event: &Stamped<Event>) {
        if let Event::Step(step) = &event.value {
            self.lacking.hear(RECORDED, has(step));
            let t_s = step.stamp.seconds_since(self.start);
            self.begins.get_or_insert((step.step_index, t_s));
        }
        self.recorded.update(event);
    }

    fn compare_steps(&mut self, replayed: &Step, recorded: &Step) {
        let t_s = replayed.stamp.seconds_since(self.start);
        let steps =
            |lost| Box::new(FirstDifference { steps: [recorded.clone(), replayed.clone()], lost });
        let values = replayed.values().into_iter().zip(recorded.values());
        for (number, (field, (a, b))) in Step::FIELDS.iter().zip(values).enumerate() {
            if (a == Value::Absent) != (b == Value::Absent) {
                self.lacking.keep(number, || (t_s, steps(true)));
                if b == Value::Absent {
                    // Up to here nothing has been left out.
                    self.whole.get_or_insert_with(|| self.replayed.clone());
                }
                continue;
            }
            let (amount, unit) = difference(field, &a, &b);
            if amount > self.deviation.as_ref().map_or(0.0, |largest| largest.amount) {
                self.deviation = Some(Deviation { field: field.name, amount, unit, t_s });
            }
            if self.first_difference.is_none() && (amount > 0.0 || says_other(field, &a, &b)) {
                self.first_difference = Some((t_s, steps(false)));
            }
        }
    }

    pub(crate) fn finish(mut self) -> Result<Outcome, ReplayError> {
        if self.steps == 0 {
            return Err(self.damage.map_or(ReplayError::NoStep, ReplayError::Log));
        }
        let lost = self.lacking.lost().into_iter();
        if let Some((number, (t_s, steps))) = lost.min_by(|(_, a), (_, b)| a.0.total_cmp(&b.0)) {
            // Both have the field: that a step of one has not is a difference like any other.
            let amount = f64::INFINITY;
            let known = self.deviation.as_ref().filter(|known| known.amount == amount);
            if known.is_none_or(|known| t_s < known.t_s) {
                let Field { name: field, unit, .. } = Step::FIELDS[number];
                self.deviation = Some(Deviation { field, amount, unit, t_s });
            }
            // In one step with another difference as well: which of them comes first is for the diff to say.
            if self.first_difference.as_ref().is_none_or(|(first_s, _)| t_s <= *first_s) {
                self.first_difference = Some((t_s, steps));
            }
            if let Some(whole) = self.whole.take() {
                self.replayed = whole;
            }
        }
        let (output_hash, recorded_hash) = (self.replayed.hex(), self.recorded.hex());
        Ok(Outcome {
            steps: self.steps,
            engaged_steps: self.engaged_steps,
            // A damaged log has no whole recording to be identical to.
            identical_to_recorded: output_hash == recorded_hash && self.damage.is_none(),
            output_hash,
            recorded_hash,
            max_deviation: self.deviation,
            first_difference: self.first_difference.map(|(_, first)| first),
            duration_s: self.last.seconds_since(self.first.unwrap_or(self.start)),
            end_s: self.last.seconds_since(self.start),
            unmet_faults: Vec::new(),
            begins_late_s: self.begins.filter(|(index, _)| *index > 0).map(|(_, t_s)| t_s),
            damage: self.damage.map(|damage| damage.to_string()),
            horizon: None,
            furthest: None,
            warm_up: None,
        })
    }
}

/// Which fields a step has.
fn has(step: &Step) -> impl Iterator<Item = bool> {
    step.values().into_iter().map(|value| value != Value::Absent)
}

/// Whether two values that have no distance differ, other than in the hidden state.
fn says_other(field: &Field, a: &Value, b: &Value) -> bool {
    let number = matches!(a, Value::Number(_) | Value::Pair(_) | Value::Pose(_));
    !number && field.name != "state_hash" && a != b
}

/// How far two values of a field are apart, directions the short way round, and in which unit: of several
/// numbers those furthest apart. NaN equals NaN; a number and a NaN are infinitely far apart. Names, flags and
/// hashes have no distance: they are left to the hash and to `tandem diff`.
fn difference(field: &Field, a: &Value, b: &Value) -> (f64, &'static str) {
    let apart = |off: f64, direction: bool| if direction { wrap(off).abs() } else { off.abs() };
    let of = |a: f64, b: f64, direction: bool| match (a.is_nan(), b.is_nan()) {
        _ if a.to_bits() == b.to_bits() => 0.0,
        (true, true) => 0.0,
        (false, false) => apart(a - b, direction && (a - b).is_finite()),
        _ => f64::INFINITY,
    };
    let number = |a: f64, b: f64| of(a, b, field.is_direction());
    let mut most = (0.0, field.unit);
    let mut units = field.unit.split(", ");
    let mut part = |amount: f64| {
        let unit = units.next().unwrap_or(field.unit);
        if amount > most.0 {
            most = (amount, unit);
        }
    };
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => return (number(*a, *b), field.unit),
        (Value::Pair(a), Value::Pair(b)) => {
            part(number(a[0], b[0]));
            part(number(a[1], b[1]));
        }
        (Value::Pose(a), Value::Pose(b)) => {
            part(number(a.x_m, b.x_m));
            part(number(a.y_m, b.y_m));
            part(of(a.theta_rad, b.theta_rad, true));
        }
        _ => {}
    }
    most
}

#[cfg(test)]
mod tests {
    use schemas::Pose;

    use super::*;

    /// A step that lost a field, which differs in another one besides: the diff is told of both.
    #[test]
    fn what_was_lost_is_told_beside_another_difference() {
        let event = |stamp, step_index, clear_m, k| {
            let step = Step { safety_clear_m: clear_m, k, ..Step::unknown(stamp, step_index) };
            Stamped { at: stamp, value: Event::Step(Box::new(step)) }
        };
        let mut tally = Tally::new(Covered::Outputs, Time(0));
        let steps = [(Some(1.0), 1.0), (None, 0.0), (Some(1.0), 1.0)];
        for (index, (clear_m, k)) in (0..).zip(steps) {
            let recorded = event(Time(index * 100), index, clear_m, k);
            tally.recorded(&recorded);
            let Event::Step(step) = &recorded.value else { unreachable!("a step was made") };
            tally.replayed(&event(Time(index * 100), index, Some(1.0), 1.0), Some(step));
        }
        let first = tally.finish().expect("it has steps").first_difference.expect("they differ");
        assert_eq!(first.steps.map(|step| (step.step_index, step.k)), [(1, 0.0), (1, 1.0)]);
        assert!(first.lost);
    }

    /// A turn rate of 3.1 and one of −3.1 are far apart, two directions are not: 2π − 6.2.
    #[test]
    fn directions_differ_the_short_way_round() {
        let apart = |name: &str, a: Value, b: Value| {
            let field = Step::FIELDS.iter().find(|field| field.name == name).expect("is there");
            difference(field, &a, &b).0
        };
        let small = core::f64::consts::TAU - 6.2;
        let (a, b) = (Value::Number(3.1), Value::Number(-3.1));
        for field in ["yaw_rad", "psi_rad", "theta_e_rad"] {
            assert!((apart(field, a, b) - small).abs() < 1e-12, "{field}");
            assert_eq!(apart(field, a, Value::Number(f64::NAN)), f64::INFINITY);
            assert_eq!(apart(field, a, Value::Number(f64::INFINITY)), f64::INFINITY);
        }
        for field in ["omega_radps", "sigma_theta_rad", "d1_m"] {
            assert_eq!(apart(field, a, b), 6.2, "{field}");
        }
        let pose = |theta_rad| Value::Pose(Pose { x_m: 1.0, y_m: 2.0, theta_rad });
        assert!((apart("pose", pose(3.1), pose(-3.1)) - small).abs() < 1e-12);
    }
}
