//! Until when a closed-loop replay can be believed: where simulated and recorded run part.

use std::sync::Arc;

use schemas::{Cell, Event, Pose, Sample, SonarScan, Stamped, Time, Truth};
use simulator::JOYSTICK_PERIOD;

use crate::human::{Fit, Fitted, Gains, state_distance};
use crate::recording::{Look, Recording};

/// State distance at which the recorded person no longer saw what they would see now: half a metre,
/// or one radian.
const STATE_BOUND: f64 = 1.0;

/// Share of the echoes of a window that come from where the recorded sonars never saw anything.
const SENSOR_BOUND: f64 = 0.3;

/// Echoes in that window: about the last second of sixteen sonars.
const WINDOW: usize = 50;

/// How far the fitted person's joystick moves, in units of what the fit leaves unexplained, before
/// the recorded joystick counts as outside their band.
const HUMAN_BOUND: f64 = 2.0;

/// The least that a fit leaves unexplained, m/s and rad/s: no fit is better than a hand is steady.
const LEAST_RESIDUAL: [f64; 2] = [0.05, 0.1];

/// When simulated and recorded run first parted, by three criteria; seconds from the start, `None`
/// where they never did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Horizon {
    /// The robot was elsewhere: more than half a metre, or one radian, or both in part.
    pub state_s: Option<f64>,
    /// The sonars heard what the recorded ones never did, or the robot left what is known of a mapped
    /// world; `None` also without sonars.
    pub sensor_s: Option<f64>,
    /// The recorded joystick was outside what the fitted person would have done there.
    pub human_s: Option<f64>,
}

impl Horizon {
    /// The first crossing of any.
    pub fn first_s(&self) -> Option<f64> {
        let earlier = |a: Option<f64>, b: Option<f64>| match (a, b) {
            (Some(a), Some(b)) => Some(if b < a { b } else { a }),
            (a, b) => a.or(b),
        };
        earlier(earlier(self.state_s, self.sensor_s), self.human_s)
    }
}

/// Watches a closed-loop replay beside its recording.
pub(crate) struct Watch {
    recording: Arc<Recording>,
    look: Look,
    start: Time,
    fitted: Fitted,
    band: [f64; 2],
    pose: Option<Pose>,
    /// Of the last echoes: whether the recording knew the place.
    window: Vec<bool>,
    next: usize,
    horizon: Horizon,
    furthest: f64,
}

impl Watch {
    pub(crate) fn new(recording: Arc<Recording>, gains: Gains) -> Watch {
        let fit = Fit::new(&recording, gains);
        let residual = fit.residual();
        Watch {
            start: recording.header().run.start,
            fitted: Fitted::new(fit),
            band: [0, 1].map(|axis| HUMAN_BOUND * residual[axis].max(LEAST_RESIDUAL[axis])),
            look: recording.look(),
            recording,
            pose: None,
            window: Vec::with_capacity(WINDOW),
            next: 0,
            horizon: Horizon::default(),
            furthest: 0.0,
        }
    }

    pub(crate) fn observe(&mut self, event: &Stamped<Event>) {
        match &event.value {
            Event::Truth(truth) => self.truth(truth),
            Event::Sample(Sample::Sonar(scan)) => self.sonar(scan),
            _ => {}
        }
    }

    /// What it is watched beside.
    pub(crate) fn recording(&self) -> &Recording {
        &self.recording
    }

    /// The horizon so far.
    pub(crate) fn horizon(&self) -> Horizon {
        self.horizon
    }

    /// The greatest state distance so far; 0 certifies that nothing changed.
    pub(crate) fn furthest(&self) -> f64 {
        self.furthest
    }

    fn truth(&mut self, truth: &Truth) {
        self.pose = Some(truth.pose);
        let after_ns = truth.stamp.0.saturating_sub(self.start.0);
        if !after_ns.is_multiple_of(JOYSTICK_PERIOD.0) {
            return;
        }
        let tick = after_ns / JOYSTICK_PERIOD.0;
        let t_s = truth.stamp.seconds_since(self.start);
        // Where nobody ever looked anything may stand.
        let explored = self.recording.header().scenario.explored.as_ref();
        if explored.is_some_and(|map| map.at(truth.pose.position_m()) == Cell::Unknown) {
            self.horizon.sensor_s.get_or_insert(t_s);
        }
        let tick = usize::try_from(tick).unwrap_or(usize::MAX);
        let both = self.fitted.both(tick, &truth.pose);
        let Some(moment) = self.look.at(tick) else { return };
        if let Some(state) = &moment.state {
            let distance = state_distance(&truth.pose, &state.pose);
            if distance > self.furthest {
                self.furthest = distance;
            }
            if distance > STATE_BOUND {
                self.horizon.state_s.get_or_insert(t_s);
            }
        }
        if let Some((model, recorded)) = both
            && (0..2).any(|axis| (model[axis] - recorded[axis]).abs() > self.band[axis])
        {
            self.horizon.human_s.get_or_insert(t_s);
        }
    }

    fn sonar(&mut self, scan: &SonarScan) {
        let (Some(coverage), Some(pose)) = (self.recording.coverage(), &self.pose) else { return };
        for known in scan.echoes.iter().filter_map(|echo| coverage.knows(pose, echo)) {
            if self.window.len() < WINDOW {
                self.window.push(known);
            } else {
                self.window[self.next] = known;
            }
            self.next = (self.next + 1) % WINDOW;
        }
        let unknown = self.window.iter().filter(|known| !**known).count();
        if self.window.len() == WINDOW && unknown as f64 > SENSOR_BOUND * WINDOW as f64 {
            self.horizon.sensor_s.get_or_insert(scan.stamp.seconds_since(self.start));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::{record, scenario, spec};
    use crate::{Mode, Person, Replay};
    use schemas::SensorSuite;

    /// The state criterion is crossed at the first truth more than half a metre, or one radian, from
    /// the recorded one, as recomputed here from both runs.
    #[test]
    fn state_is_left_where_the_runs_part() {
        let scenario = scenario("random:slant:tracker:6", 12.0);
        let log = record(&scenario, "human", SensorSuite::Exact);
        let other = spec("tandem-kinematic", &scenario);
        let mut replay = Replay::new(|| Ok(log.open()), &other, Mode::Closed(Person::Playback))
            .expect("replays");
        let mut recorded = log.events.iter().filter_map(|event| match &event.value {
            Event::Truth(truth) => Some(truth.clone()),
            _ => None,
        });
        let mut parted_s = None;
        while let Some(event) = replay.next_event() {
            let Event::Truth(truth) = event.value else { continue };
            let then = recorded.next().expect("both run on the same grid");
            assert_eq!(then.stamp, truth.stamp);
            let (dx, dy) = (truth.pose.x_m - then.pose.x_m, truth.pose.y_m - then.pose.y_m);
            let mut turn =
                (truth.pose.theta_rad - then.pose.theta_rad).abs() % (2.0 * core::f64::consts::PI);
            if turn > core::f64::consts::PI {
                turn = 2.0 * core::f64::consts::PI - turn;
            }
            if parted_s.is_none() && 4.0 * (dx * dx + dy * dy) + turn * turn > 1.0 {
                parted_s = Some(truth.stamp.seconds_since(schemas::SIMULATION_EPOCH));
            }
        }
        let horizon = replay.finish().expect("has steps").horizon.expect("closed loop has one");
        assert!(parted_s.is_some());
        assert_eq!(horizon.state_s, parted_s);
        assert_eq!(horizon.sensor_s, None);
        assert!(horizon.first_s() <= horizon.state_s);
    }

    #[test]
    fn the_first_crossing_counts() {
        let horizon = |state_s, sensor_s, human_s| Horizon { state_s, sensor_s, human_s }.first_s();
        assert_eq!(horizon(None, None, None), None);
        assert_eq!(horizon(Some(3.0), None, Some(2.0)), Some(2.0));
        assert_eq!(horizon(Some(3.0), Some(1.0), Some(2.0)), Some(1.0));
    }
}
