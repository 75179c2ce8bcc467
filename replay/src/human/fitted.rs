//! A person fitted to the log, with the recorded residual: abduction, action, prediction.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use schemas::{Pose, wrap};

use super::anchored::Model;
use super::bearing::{Gains, Habits, ask};
use super::goals::{Explained, GRID_M, delay_ticks, explain};
use crate::recording::{Look, Recording, State};

/// State distances that count as one: metres and radians.
const SCALE: (f64, f64) = (0.5, 1.0);

/// State distance at which the recorded residual has lost two fifths of its weight.
const FADE: f64 = 1.0;

/// How far two poses are apart: 1 at half a metre or at one radian.
pub(crate) fn state_distance(a: &Pose, b: &Pose) -> f64 {
    let (dx, dy) = ((a.x_m - b.x_m) / SCALE.0, (a.y_m - b.y_m) / SCALE.0);
    let turned = wrap(a.theta_rad - b.theta_rad) / SCALE.1;
    libm::sqrt(dx * dx + dy * dy + turned * turned)
}

/// What is found out about a recording's person, once: every arm and level of a comparison asks.
#[derive(Clone, Debug, Default)]
pub(crate) struct Explanations {
    known: Arc<Mutex<Known>>,
    habits: Arc<OnceLock<Habits>>,
    constant_share: Arc<OnceLock<f64>>,
}

type Known = Vec<(Gains, Arc<Explained>)>;

impl Explanations {
    /// Gains whose explanations are kept: the prior's and the pooled ones.
    const KEPT: usize = 2;

    /// What the person usually asks for.
    pub(super) fn habits(&self, find: impl FnOnce() -> Habits) -> Habits {
        *self.habits.get_or_init(find)
    }

    /// Share of the time in which the joystick was held still.
    pub(super) fn constant_share(&self, find: impl FnOnce() -> f64) -> f64 {
        *self.constant_share.get_or_init(find)
    }

    fn of(&self, gains: Gains, explain: impl FnOnce() -> Explained) -> Arc<Explained> {
        let known = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, explained)) = known().iter().find(|(of, _)| *of == gains) {
            return Arc::clone(explained);
        }
        let explained = Arc::new(explain());
        let mut known = known();
        known.truncate(Explanations::KEPT - 1);
        known.insert(0, (gains, Arc::clone(&explained)));
        explained
    }
}

/// The law with a person's goals, gains and habits.
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    look: Look,
    explained: Arc<Explained>,
    gains: Gains,
}

impl Fit {
    pub(crate) fn new(recording: &Arc<Recording>, gains: Gains) -> Fit {
        let explained =
            recording.explanations().of(gains, || explain(recording, &gains, GRID_M, usize::MAX));
        Fit { look: recording.look(), explained, gains }
    }

    /// What the law leaves unexplained on the recorded states, [m/s, rad/s].
    pub(crate) fn residual(&self) -> [f64; 2] {
        self.explained.residual
    }

    /// What the law asks for at a tick when the robot was seen at `pose`.
    fn ask(&self, tick: usize, pose: &Pose) -> [f64; 2] {
        let goal = self.explained.goal(tick);
        ask(&self.gains, &self.explained.habits, &goal, pose, Recording::tick_s(tick))
    }

    /// What the law asked for at a tick of the recording.
    fn recorded(&mut self, tick: usize) -> Option<[f64; 2]> {
        let seen = tick.saturating_sub(delay_ticks(self.gains.delay_s));
        let state = self.look.at(seen)?.state?;
        Some(self.ask(tick, &state.pose))
    }
}

/// The fitted person looking at a simulated robot.
pub(crate) struct Fitted {
    fit: Fit,
    /// Poses since one reaction time ago, newest last.
    seen: VecDeque<Pose>,
    keep: usize,
}

impl Fitted {
    pub(crate) fn new(fit: Fit) -> Fitted {
        let keep = delay_ticks(fit.gains.delay_s) + 1;
        Fitted { fit, seen: VecDeque::with_capacity(keep + 1), keep }
    }

    /// What the law asks for now, and what it asked for in the recording: [m/s, rad/s] each.
    pub(crate) fn both(&mut self, tick: usize, pose: &Pose) -> Option<([f64; 2], [f64; 2])> {
        self.seen.push_back(*pose);
        if self.seen.len() > self.keep {
            self.seen.pop_front();
        }
        let seen = self.seen.front()?;
        Some((self.fit.ask(tick, seen), self.fit.recorded(tick)?))
    }
}

impl Model for Fitted {
    fn ask(&mut self, tick: usize, now: &State, then: &State, asked: [f64; 2]) -> [f64; 2] {
        let Some((model, recorded)) = self.both(tick, &now.pose) else { return asked };
        let distance = state_distance(&now.pose, &then.pose) / FADE;
        let weight = libm::exp(-0.5 * distance * distance);
        [0, 1].map(|axis| model[axis] + weight * (asked[axis] - recorded[axis]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::{record, scenario};
    use schemas::SensorSuite;

    /// One explanation for all who ask with the same gains; another world has its own.
    #[test]
    fn a_person_is_explained_once_for_each_gains() {
        let log = record(&scenario("random:rect:goal:2", 3.0), "human", SensorSuite::Sonar);
        let recording = Arc::new(Recording::read(log.open()).unwrap());
        let other = Gains { k_theta: 2.0, ..Gains::PRIOR };
        let [first, second, third] =
            [Gains::PRIOR, other, Gains::PRIOR].map(|gains| Fit::new(&recording, gains));
        assert!(Arc::ptr_eq(&first.explained, &third.explained));
        assert!(!Arc::ptr_eq(&first.explained, &second.explained));
        let anew = explain(&recording, &other, GRID_M, usize::MAX);
        assert_eq!(second.explained.goals, anew.goals);
        let empty = schemas::World::default();
        let elsewhere = Arc::new(Recording::clone(&recording).in_world(empty, None));
        let there = Fit::new(&elsewhere, other);
        let anew = explain(&elsewhere, &other, GRID_M, usize::MAX);
        assert!(!Arc::ptr_eq(&there.explained, &second.explained));
        assert_eq!(there.explained.goals, anew.goals);
    }
}
