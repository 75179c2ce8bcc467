//! A part of a log, and how a replay gets to its beginning.

use schemas::{Span, Time};

/// The part of a log that is replayed: from and to, seconds from the start of the session.
///
/// What comes before is run through as well, for the state that it leaves behind. In open loop the
/// controller then is what it would be after the whole log. In closed loop the recorded commands
/// drive the simulated robot up to the beginning while the controller listens;
/// [`crate::Outcome::warm_up`] says whether all that it heard was what the log holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Beginning, seconds.
    pub from_s: f64,
    /// End, seconds; +∞ for the end of the log.
    pub to_s: f64,
}

impl Window {
    /// Whether an instant of a session that started at `start` belongs to the part.
    pub fn contains(self, start: Time, at: Time) -> bool {
        let between = Between::new(self, start);
        (between.from..=between.to).contains(&at)
    }
}

impl Default for Window {
    fn default() -> Self {
        Window { from_s: 0.0, to_s: f64::INFINITY }
    }
}

/// What the way to the beginning of a window was like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WarmUp {
    /// The state there is what the whole log gives, to the last bit.
    Exact,
    /// The simulation did not follow the log: the state there is another.
    Differs,
}

/// A window as instants.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Between {
    pub(crate) from: Time,
    pub(crate) to: Time,
}

impl Between {
    pub(crate) fn new(window: Window, start: Time) -> Between {
        let to = if window.to_s.is_finite() {
            // An instant's records follow it within a microsecond.
            (start + Span::from_seconds(window.to_s)).after_ns(999)
        } else {
            Time(u64::MAX)
        };
        Between { from: start + Span::from_seconds(window.from_s), to }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::{record, same, scenario, spec};
    use crate::{Mode, Outcome, Person, Replay};
    use schemas::{Event, SensorSuite, Stamped};

    const PART: Window = Window { from_s: 3.0, to_s: 6.0 };

    fn run(
        log: &crate::session::Recorded,
        spec: &controller::Spec,
        mode: Mode,
        window: Window,
    ) -> (Vec<Stamped<Event>>, Outcome) {
        let mut replay =
            Replay::new(|| Ok(log.open()), spec, mode).expect("replays").within(window, log.open());
        let events = std::iter::from_fn(|| replay.next_event()).collect();
        (events, replay.finish().expect("has steps"))
    }

    fn inside(events: &[Stamped<Event>]) -> Vec<Stamped<Event>> {
        let within = |event: &&Stamped<Event>| PART.contains(schemas::SIMULATION_EPOCH, event.at);
        events.iter().filter(within).cloned().collect()
    }

    /// In open loop a part of the log gives what the whole log gives there, whichever controller.
    #[test]
    fn an_open_loop_part_is_a_part_of_the_whole() {
        let scenario = scenario("random:slant:flowing:3", 8.0);
        let log = record(&scenario, "paper-kinematic", SensorSuite::Sonar);
        for controller in ["paper-kinematic", "tandem-kinematic"] {
            let spec = spec(controller, &scenario);
            let (whole, _) = run(&log, &spec, Mode::Open, Window::default());
            let (part, outcome) = run(&log, &spec, Mode::Open, PART);
            assert!(!part.is_empty());
            assert!(same(&part, &inside(&whole)));
            assert_eq!(outcome.warm_up, Some(WarmUp::Exact));
            assert_eq!(outcome.identical_to_recorded, controller == "paper-kinematic");
            assert!((outcome.duration_s - 3.0).abs() < 1e-6);
        }
    }

    /// In closed loop the recording controller continues the recording from any cut, and another
    /// controller takes over there: up to the cut the robot is where it was.
    #[test]
    fn a_closed_loop_part_begins_where_the_recording_was() {
        for (recorded_with, other, sensors) in [
            ("tandem-kinematic", "paper-kinematic", SensorSuite::Sonar),
            ("tandem-kinematic", "tandem-dynamic", SensorSuite::Exact),
            ("paper-dynamic", "tandem-kinematic", SensorSuite::Sonar),
        ] {
            let scenario = scenario("random:rect:tracker:4", 8.0);
            let log = record(&scenario, recorded_with, sensors);
            let mode = Mode::Closed(Person::Intent);
            let (part, outcome) = run(&log, &log.spec, mode, PART);
            assert_eq!(outcome.warm_up, Some(WarmUp::Exact), "{recorded_with}");
            assert!(outcome.identical_to_recorded, "{recorded_with}: {:?}", outcome.max_deviation);
            assert!(same(&part, &inside(&log.events)));

            let (part, _) = run(&log, &spec(other, &scenario), mode, PART);
            let first = |events: &[Stamped<Event>]| {
                events.iter().find_map(|event| match &event.value {
                    Event::Truth(truth) => Some(truth.pose),
                    _ => None,
                })
            };
            let (here, there) =
                (first(&part).expect("moves"), first(&inside(&log.events)).expect("moves"));
            assert!((here.x_m - there.x_m).abs() < 1e-9 && (here.y_m - there.y_m).abs() < 1e-9);
        }
    }

    /// A log whose plant was another than it claims cannot be led to its states, and says so.
    #[test]
    fn a_part_that_begins_elsewhere_says_so() {
        let mut scenario = scenario("random:rect:tracker:4", 8.0);
        scenario.plant.slip = 0.1;
        let mut log = record(&scenario, "human", SensorSuite::Exact);
        scenario.plant.slip = 0.0;
        log.rewrite(&scenario);
        let (_, outcome) = run(&log, &log.spec, Mode::Closed(Person::Playback), PART);
        assert_eq!(outcome.warm_up, Some(WarmUp::Differs));
    }
}
