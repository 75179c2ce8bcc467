//! The one pass over a run that feeds every metric.

use schemas::{
    Command, Event, Header, JoystickSample, Sample, Stamped, Step, Time, Timing, Truth, Twist,
};
use serde::{Deserialize, Serialize};

use super::accumulate::Accumulate;
use super::answers::Answers;
use super::catalogue::{CATALOGUE, Feed};
use super::echoes::Echoes;
use super::invariance::{Monitor, Violation};
use super::judge::{Judge, State};
use super::profile::Profile;
use super::sample::{
    DECISION_HOLD_LIMIT_PERIODS, Decision, LawState, MOTION_HOLD_LIMIT_S, Motion, Request, Setting,
    TTC_HORIZON_S,
};
use super::sets::Sets;
use super::sweep::{Course, Surroundings};
use super::track::{Switch, Track, TrackPoint};
use crate::CompareError;

/// What the motion of a run was taken from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Basis {
    /// `/truth`: a simulation knows.
    Truth,
    /// The controller's estimate and the scenario's world.
    Estimate,
}

/// A run's metrics.
#[derive(Clone, Debug, PartialEq)]
pub struct RunMetrics {
    values: Vec<Option<f64>>,
    /// What clearances and paths were computed from.
    pub basis: Basis,
    /// Controller steps seen.
    pub steps: u64,
    /// Those at which the feedback law drove (k = 0).
    pub engaged_steps: u64,
    /// Steps whose stamp did not come after the one before; their time counts as 0.
    pub steps_back_in_time: u64,
    /// From the first step to the end of the last, seconds, holes left out.
    pub duration_s: f64,
}

impl RunMetrics {
    /// A metric by its name; `None` where it has no meaning for this run or does not exist.
    pub fn get(&self, name: &str) -> Option<f64> {
        CATALOGUE.iter().position(|metric| metric.name == name).and_then(|i| self.values[i])
    }

    /// Every metric in the order of [`CATALOGUE`].
    pub fn values(&self) -> &[Option<f64>] {
        &self.values
    }
}

/// Everything that one pass over a run gives.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// The metrics.
    pub metrics: RunMetrics,
    /// What was violated, in the order of time.
    pub violations: Vec<Violation>,
    /// When the additive metrics grew.
    pub profile: Profile,
    /// The path, thinned, and every change of k.
    pub track: Track,
}

impl Measured {
    /// The numbers alone, without the path and without when they grew.
    #[must_use]
    pub fn bare(self) -> Measured {
        Measured { profile: Profile::new(), track: Track::new(), ..self }
    }
}

/// Reads a run event by event and measures it. A copy goes on from where it was made.
#[derive(Clone)]
pub struct Meter {
    start: Time,
    setting: Setting,
    accumulators: Vec<Box<dyn Accumulate>>,
    monitor: Monitor,
    surroundings: Surroundings,
    judge: Judge,
    collisions: Answers<6, f64>,
    echoes: Echoes,
    sets: Option<Sets>,
    distance_before_m: f64,
    profile: Profile,
    track: Track,
    basis: Basis,
    /// The newest motion, held back until the next one tells how long it stands.
    motion: Option<Motion>,
    /// The newest decision, held back likewise.
    pending: Option<Pending>,
    events: u64,
    steps: u64,
    engaged_steps: u64,
    steps_back_in_time: u64,
    duration_s: f64,
}

/// A step that waits for its command and for the step after it.
#[derive(Clone, Debug)]
struct Pending {
    stamp: Time,
    period_s: f64,
    decision: Decision,
    point: TrackPoint,
    switch: Switch,
}

impl std::fmt::Debug for Meter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Meter").field("events", &self.events).finish_non_exhaustive()
    }
}

impl Meter {
    /// A meter for the run with that header.
    pub fn new(header: &Header) -> Meter {
        let setting = Setting::new(&header.scenario);
        let surroundings = Surroundings::new(setting.world.clone(), setting.footprint);
        Meter {
            start: header.run.start,
            accumulators: accumulators(&setting),
            monitor: Monitor::new(setting.footprint),
            judge: Judge::new(surroundings.clone(), &setting.plant),
            surroundings,
            collisions: Answers::default(),
            echoes: Echoes::default(),
            sets: Sets::of(header),
            distance_before_m: f64::NAN,
            setting,
            profile: Profile::new(),
            track: Track::new(),
            basis: Basis::Estimate,
            motion: None,
            pending: None,
            events: 0,
            steps: 0,
            engaged_steps: 0,
            steps_back_in_time: 0,
            duration_s: 0.0,
        }
    }

    /// A meter for another run of the same session. Where both runs ask the same of the world, a few
    /// events apart at most, it is worked out once.
    #[must_use]
    pub fn beside(&self, header: &Header) -> Meter {
        let mut meter = Meter::new(header);
        let (own, other) = (&meter.setting, &self.setting);
        let same = own.world == other.world
            && own.footprint == other.footprint
            && own.plant == other.plant;
        if same {
            meter.judge.ask_with(&self.judge);
            meter.collisions = self.collisions.clone();
        }
        meter
    }

    /// Takes in the next event of the run, in the order of the log.
    pub fn observe(&mut self, event: &Stamped<Event>) {
        self.events += 1;
        match &event.value {
            Event::Truth(truth) => self.truth(truth),
            Event::Step(step) => self.step(step),
            Event::Command(command) => self.command(command),
            Event::Sample(Sample::Joystick(joystick)) => self.joystick(joystick),
            Event::Sample(Sample::Sonar(scan)) => self.echoes.scan(scan, self.start),
            Event::Timing(timing) => self.timing(timing),
            Event::Sample(_) | Event::Gap(_) => {}
        }
    }

    /// Says which echo ends D, or the ray of the safety layer, in the step that was observed last: when
    /// its sonar fired, and the range, metres. Only a controller that is asked knows that.
    pub fn ended_by(&mut self, fired: Time, range_m: f64) {
        if let Some(pending) = &mut self.pending {
            let fired_s = fired.seconds_since(self.start);
            pending.switch.ended_by = self.echoes.heard(fired_s, range_m);
        }
    }

    /// Ends the run.
    ///
    /// # Errors
    /// [`CompareError::NoSteps`] when the run held no controller step: such a run says nothing
    /// about a controller, and no number for it would mean anything.
    pub fn finish(mut self) -> Result<Measured, CompareError> {
        if self.steps == 0 {
            return Err(CompareError::NoSteps { events: self.events });
        }
        self.deliver_motion(None);
        let period_s = self.pending.as_ref().map_or(0.0, |pending| pending.period_s);
        self.deliver_decision(period_s.max(0.0));
        self.track.finish();
        let values: Vec<Option<f64>> = self
            .accumulators
            .iter()
            .map(|metric| metric.value().filter(|value| value.is_finite()))
            .collect();
        for (i, value) in values.iter().enumerate() {
            self.profile.scale(i, value.unwrap_or(0.0));
        }
        Ok(Measured {
            metrics: RunMetrics {
                values,
                basis: self.basis,
                steps: self.steps,
                engaged_steps: self.engaged_steps,
                steps_back_in_time: self.steps_back_in_time,
                duration_s: self.duration_s,
            },
            violations: self.monitor.violations(),
            profile: self.profile,
            track: self.track,
        })
    }

    fn joystick(&mut self, joystick: &JoystickSample) {
        let asked = Twist { v_mps: joystick.v_mps, omega_radps: joystick.omega_radps };
        let t_s = joystick.stamp.seconds_since(self.start);
        let request = Request { t_s, twist: self.setting.limits.clipped(asked) };
        self.feed(Feed::Request, t_s, |metric| metric.request(&request));
    }

    fn timing(&mut self, timing: &Timing) {
        let t_s = timing.stamp.seconds_since(self.start);
        self.feed(Feed::Timing, t_s, |metric| metric.timing(timing));
    }

    /// Hands something to the metrics that are fed with it.
    fn feed(&mut self, feed: Feed, t_s: f64, mut give: impl FnMut(&mut dyn Accumulate)) {
        for (i, metric) in self.accumulators.iter_mut().enumerate() {
            if CATALOGUE[i].feed == feed {
                give(metric.as_mut());
                if let Some(total) = metric.total() {
                    self.profile.note(i, t_s, total);
                }
            }
        }
    }

    fn truth(&mut self, truth: &Truth) {
        if self.basis == Basis::Estimate {
            self.start_again_from_truth();
        }
        self.deliver_motion(Some(Motion {
            t_s: truth.stamp.seconds_since(self.start),
            hold_s: 0.0,
            pose: truth.pose,
            twist: Twist { v_mps: truth.v_mps, omega_radps: truth.omega_radps },
            clearance_m: truth.clearance_m,
            clearance_static_m: truth.clearance_static_m,
            discs: truth.discs.clone(),
            ttc_s: f64::NAN,
        }));
    }

    /// What was taken from the estimate so far is forgotten: the run knows better.
    fn start_again_from_truth(&mut self) {
        self.basis = Basis::Truth;
        self.motion = None;
        self.monitor = Monitor::new(self.setting.footprint);
        let fresh = accumulators(&self.setting);
        for (i, fresh) in fresh.into_iter().enumerate() {
            if CATALOGUE[i].feed == Feed::Motion {
                self.accumulators[i] = fresh;
                self.profile.forget(i);
            }
        }
    }

    fn step(&mut self, step: &Step) {
        let t_s = step.stamp.seconds_since(self.start);
        if let Some(pending) = &self.pending {
            let since_s = t_s - pending.decision.t_s;
            if since_s <= 0.0 {
                self.steps_back_in_time += 1;
            }
            self.deliver_decision(since_s.max(0.0));
        }
        self.steps += 1;
        if step.k == 0.0 {
            self.engaged_steps += 1;
        }
        if self.basis == Basis::Estimate {
            let motion = self.estimated(step, t_s);
            self.deliver_motion(Some(motion));
        }
        self.pending = Some(self.pending(step, t_s));
        self.distance_before_m = step.distance_human_m;
    }

    fn command(&mut self, command: &Command) {
        if let Some(pending) = &mut self.pending
            && pending.stamp == command.stamp
        {
            pending.decision.executed = command.twist;
            pending.decision.accelerates = command.accel.is_some();
            pending.point.v_s_mps = command.twist.v_mps;
            pending.point.omega_s_radps = command.twist.omega_radps;
        }
    }

    /// What is known of a step before its command and its end.
    fn pending(&self, step: &Step, t_s: f64) -> Pending {
        let believed = Twist { v_mps: step.v_mps, omega_radps: step.omega_radps };
        let (pose, actual, clearance_m) = match &self.motion {
            Some(motion) => (motion.pose, motion.twist, motion.clearance_m),
            None => (step.pose, believed, f64::NAN),
        };
        let requested = self
            .setting
            .limits
            .clipped(Twist { v_mps: step.v_h_mps, omega_radps: step.omega_h_radps });
        let unknown = Twist { v_mps: f64::NAN, omega_radps: f64::NAN };
        Pending {
            stamp: step.stamp,
            period_s: step.control_period_s,
            decision: Decision {
                t_s,
                hold_s: 0.0,
                k: step.k,
                requested,
                executed: unknown,
                actual,
                passed: step.u_s == step.u_h,
                accelerates: false,
                pose,
                judgement: None,
                law: LawState::of(step),
            },
            point: TrackPoint {
                t_s,
                x_m: pose.x_m,
                y_m: pose.y_m,
                theta_rad: pose.theta_rad,
                k: step.k,
                v_h_mps: requested.v_mps,
                v_s_mps: f64::NAN,
                omega_h_radps: requested.omega_radps,
                omega_s_radps: f64::NAN,
                clearance_m,
                distance_human_m: step.distance_human_m,
                lyapunov: step.lyapunov,
            },
            switch: Switch {
                t_s,
                k: step.k,
                // While the law drives, what the layer alters changes nothing about who drives.
                projected: step.projected && step.k != 0.0,
                reason: step.reason,
                region: step.region,
                distance_human_m: step.distance_human_m,
                distance_before_m: self.distance_before_m,
                v_h_mps: step.v_h_mps,
                nearest_echo: self.echoes.nearest(t_s),
                ended_by: None,
                critical: self.sets.and_then(|sets| sets.crossed(step, requested.v_mps)),
            },
        }
    }

    /// The motion that the controller believed in, in the scenario's world.
    fn estimated(&self, step: &Step, t_s: f64) -> Motion {
        let mut motion = Motion {
            t_s,
            hold_s: 0.0,
            pose: step.pose,
            twist: Twist { v_mps: step.v_mps, omega_radps: step.omega_radps },
            clearance_m: f64::NAN,
            clearance_static_m: f64::NAN,
            discs: Vec::new(),
            ttc_s: f64::NAN,
        };
        if self.setting.has_world() && step.pose.is_finite() {
            let (world, footprint) = (&self.setting.world, &self.setting.footprint);
            motion.clearance_m = world.clearance_m(footprint, &step.pose, t_s);
            motion.clearance_static_m = world.clearance_static_m(footprint, &step.pose);
            motion.discs = world.discs_at(t_s).collect();
        }
        motion
    }

    /// Hands the motion that was held back to the metrics, and holds back the next.
    fn deliver_motion(&mut self, next: Option<Motion>) {
        let until_s = next.as_ref().map(|next| next.t_s);
        if let Some(mut motion) = std::mem::replace(&mut self.motion, next) {
            let until_s = until_s.unwrap_or(motion.t_s);
            motion.hold_s = (until_s - motion.t_s).clamp(0.0, MOTION_HOLD_LIMIT_S);
            motion.ttc_s = self.time_to_collision_s(&motion);
            self.feed(Feed::Motion, motion.t_s, |metric| metric.motion(&motion));
            self.monitor.motion(&motion);
        }
    }

    /// How long the robot could go on like that, at most [`TTC_HORIZON_S`]; NaN where that is not
    /// known.
    fn time_to_collision_s(&self, motion: &Motion) -> f64 {
        let Twist { v_mps, omega_radps } = motion.twist;
        let known = v_mps.is_finite() && omega_radps.is_finite() && motion.pose.is_finite();
        if !known || motion.clearance_m.is_nan() || self.surroundings.is_empty() {
            return f64::NAN;
        }
        let Motion { t_s, pose, .. } = motion;
        let question = [*t_s, pose.x_m, pose.y_m, pose.theta_rad, v_mps, omega_radps];
        self.collisions.of(question, || {
            let course = Course::constant(motion.twist, TTC_HORIZON_S);
            let contact_s = self.surroundings.first_contact_s(pose, *t_s, &course);
            contact_s.unwrap_or(TTC_HORIZON_S)
        })
    }

    /// Hands the decision that was held back to the metrics; the next step came `hold_s` later.
    fn deliver_decision(&mut self, hold_s: f64) {
        let Some(mut pending) = self.pending.take() else { return };
        let limit_s = if pending.period_s > 0.0 {
            DECISION_HOLD_LIMIT_PERIODS * pending.period_s
        } else {
            MOTION_HOLD_LIMIT_S
        };
        let decision = &mut pending.decision;
        decision.hold_s = hold_s.min(limit_s);
        self.duration_s += decision.hold_s;
        let state = State {
            t_s: decision.t_s,
            pose: decision.pose,
            twist: decision.actual,
            accelerates: decision.accelerates,
        };
        decision.judgement = self.judge.judge(&state, decision.requested);
        let decision = &pending.decision;
        self.feed(Feed::Decision, decision.t_s, |metric| metric.decision(decision));
        self.track.point(pending.point);
        if pending.switch.k.is_finite() {
            self.track.switch(pending.switch);
        }
    }
}

fn accumulators(setting: &Setting) -> Vec<Box<dyn Accumulate>> {
    CATALOGUE.iter().map(|metric| (metric.make)(setting)).collect()
}
