//! The controller in action: latches what it is shown, and steps.
//!
//! In: samples, as they come, and the instants at which to step. Out: for each step a command and
//! the step that explains it. The order within a step is that of the data flow: input, estimate,
//! distances, reference, law, sharing, command (specification §9).

mod feedback;
mod hashing;
mod memory;
mod prediction;
mod request;
mod senses;
mod setup;
mod sharing;

use schemas::{
    Command, JoystickSample, Pose, Reason, Sample, SensorSuite, Span, Step, Time, Twist,
};

use crate::digest::Digest;
use crate::estimation::Estimate;
use crate::safety::{Cone, Limits, Saturation, clip, project, scale};
use crate::sharing::select;
use crate::spec::{Law, SpecError};
use crate::target::Target;
use crate::travel::direction_of_travel_rad;
use feedback::{Feedback, View};
use memory::Memory;
use prediction::predict;
use request::{Request, stale};
use senses::Senses;
pub use setup::Setup;
use sharing::Question;

/// What one step gives.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The step, for the log.
    pub step: Step,
    /// The command, for the actuators.
    pub command: Command,
}

/// A controller in action.
#[derive(Clone, Debug)]
pub struct Runner {
    setup: Setup,
    limits: Limits,
    senses: Senses,
    joystick: Option<JoystickSample>,
    memory: Memory,
    /// What was observed since the previous step.
    heard: Digest,
    index: u64,
}

impl Runner {
    /// A runner that has heard nothing yet.
    ///
    /// # Errors
    /// The law is not built, or parameters do not go together with the plant's limits.
    pub fn new(setup: &Setup) -> Result<Runner, SpecError> {
        setup.check()?;
        Ok(Runner {
            limits: Limits::from(&setup.scenario.plant),
            senses: Senses::new(&setup.scenario, setup.sensors, &setup.spec.params),
            setup: setup.clone(),
            joystick: None,
            memory: Memory::default(),
            heard: Digest::default(),
            index: 0,
        })
    }

    /// Takes note of a sample. The last one of each kind counts, in the order in which they come;
    /// how old it is follows from its own stamp.
    pub fn observe(&mut self, sample: &Sample) {
        hashing::fold_sample(&mut self.heard, sample, self.setup.start);
        match sample {
            Sample::Joystick(joystick) => self.joystick = Some(*joystick),
            other => self.senses.observe(other),
        }
    }

    /// The period at which [`Runner::step`] is to be called.
    pub fn control_period(&self) -> Span {
        Span::from_seconds(self.setup.spec.params.control_period_s)
    }

    /// Steps the controller at the instant `now`.
    ///
    /// Never fails and never commands anything but finite numbers: bad input gives a safe command
    /// and a reason (specification §10).
    pub fn step(&mut self, now: Time) -> Outcome {
        let params = &self.setup.spec.params;
        let mut step = Step::unknown(now, self.index);
        self.index += 1;

        let request = Request::new(self.joystick.as_ref(), now, params.joystick_lease_s);
        let estimate = self.senses.estimate();
        let odometry_age_s = estimate.stamp.map_or(f64::NAN, |stamp| now.seconds_since(stamp));
        step.control_period_s = params.control_period_s;
        if let Some(joystick) = &self.joystick {
            step.v_h_mps = joystick.v_mps;
            step.omega_h_radps = joystick.omega_radps;
        }
        step.joystick_age_s = request.age_s;
        step.pose = estimate.pose;
        step.v_mps = estimate.v_mps;
        step.omega_radps = estimate.omega_radps;
        step.odometry_age_s = odometry_age_s;
        step.input_hash = self.input_hash(now, request.age_s, odometry_age_s);

        let t_s = now.seconds_since(self.setup.start);
        // The command will take effect later and, where the newest odometry is older than now,
        // elsewhere.
        let speeds = [estimate.v_mps, estimate.omega_radps];
        let pose = predict(&estimate.pose, speeds, odometry_age_s);
        let delay_s = self.setup.scenario.plant.actuator_delay_s;
        let pose = predict(&pose, self.memory.commanded, delay_s);
        self.senses.advance(now, t_s, &pose);
        let blocked = self.blocked(&estimate, odometry_age_s, t_s);
        self.decide(&request, &pose, estimate.omega_radps, t_s, blocked, &mut step);
        step.state_hash = self.state_hash();

        let [v_mps, omega_radps] = step.u_s;
        let command = Command { stamp: now, twist: Twist { v_mps, omega_radps }, accel: None };
        Outcome { step, command }
    }
}

impl Runner {
    /// The hash over what was heard since the previous step and how old the latched samples are.
    fn input_hash(&mut self, now: Time, joystick_age_s: f64, odometry_age_s: f64) -> u64 {
        let mut digest = std::mem::take(&mut self.heard);
        digest.time(now, self.setup.start);
        digest.numbers(&[joystick_age_s, odometry_age_s]);
        digest.value()
    }

    /// The hash over all that the controller carries on to its next step.
    fn state_hash(&self) -> u64 {
        let mut digest = Digest::default();
        self.memory.fold(&mut digest);
        if let Some(joystick) = self.joystick {
            hashing::fold_sample(&mut digest, &Sample::Joystick(joystick), self.setup.start);
        }
        self.senses.fold(&mut digest, self.setup.start);
        digest.value()
    }

    /// Why the robot must stand still whatever anyone asks for.
    fn blocked(&self, estimate: &Estimate, odometry_age_s: f64, t_s: f64) -> Option<Reason> {
        let params = &self.setup.spec.params;
        let sonar = self.setup.sensors == SensorSuite::Sonar;
        if estimate.stamp.is_some() && !estimate.pose.is_finite() {
            Some(Reason::PoseInvalid)
        } else if stale(odometry_age_s, params.odometry_lease_s) {
            Some(Reason::OdometryStale)
        } else if sonar && t_s < params.start_still_s {
            Some(Reason::Starting)
        } else if self.senses.dead() {
            Some(Reason::SensorsDead)
        } else {
            None
        }
    }

    /// Reference, law, sharing and command.
    fn decide(
        &mut self,
        request: &Request,
        pose: &Pose,
        omega_now_radps: f64,
        t_s: f64,
        blocked: Option<Reason>,
        step: &mut Step,
    ) {
        let Runner { setup, limits, senses, memory, .. } = self;
        let Setup { spec, scenario, sensors, .. } = setup;
        let params = &spec.params;
        let u_h = clip(request.u, limits);
        step.u_h = u_h;

        let target = match &scenario.task {
            _ if request.trouble.is_some() => Target::hold(pose),
            Some(task) => Target::of_task(task, t_s, params.intent_s),
            None => Target::of_joystick(pose, u_h[0], u_h[1], params.prediction_s),
        };
        step.reference_source = target.source;
        [step.target_x_m, step.target_y_m] = target.position_m;
        [step.target_vx_mps, step.target_vy_mps] = target.velocity_mps;

        let cone = params.cone(&scenario.plant, omega_now_radps);
        let view = View { params, senses, pose, target: &target };
        let mut feedback = Feedback { u: [0.0; 2], trouble: None };
        let mut reason = Reason::PoseInvalid;
        if pose.is_finite() {
            feedback = view.feedback(memory, step);
            let (mode, b1_m, b2_m) = params.question(scenario.task.is_some());
            let margin = params.margin_applies(*sensors);
            let question = Question { u_h, mode, b1_m, b2_m, margin, cone };
            reason = view.share(&question, memory, step);
        }

        if spec.law == Law::Human {
            step.k = 1.0;
            step.reason = request.trouble.unwrap_or(Reason::Human);
            step.u_s_before_projection = u_h;
            step.u_s = u_h;
            memory.commanded = u_h;
            return;
        }

        let trouble = blocked.or(request.trouble);
        if trouble.is_some() {
            memory.switch.human = false;
        }
        let human = memory.switch.human;
        step.k = memory.switch.k();
        step.reason = match (trouble, feedback.trouble) {
            (Some(trouble), _) => trouble,
            (None, Some(trouble)) if !human => trouble,
            _ => reason,
        };
        let u_f = match params.saturation {
            Saturation::Scale => scale(feedback.u, limits),
            Saturation::Clip => clip(feedback.u, limits),
        };
        let stopped = blocked.is_some() || request.released;
        let chosen = if stopped { [0.0; 2] } else { select(human, u_f, u_h) };
        step.saturated = !stopped && !human && u_f != feedback.u;
        step.u_s_before_projection = chosen;
        step.u_s = view.made_safe(chosen, human, cone, step.distance_human_m);
        step.projected = step.u_s != chosen;
        memory.commanded = step.u_s;
    }
}

impl View<'_> {
    /// The input that may really be applied.
    fn made_safe(&self, u: [f64; 2], human: bool, cone: Option<Cone>, d_m: f64) -> [f64; 2] {
        let View { senses, pose, .. } = self;
        let Some(cone) = cone else {
            // Contact: the feedback law does not push on (specification §10).
            let along_rad = direction_of_travel_rad(pose.theta_rad, u[0]);
            let pushing = !human && d_m <= 0.0 && senses.law_ray_m(pose, along_rad) <= 0.0;
            return if pushing { [0.0, u[1]] } else { u };
        };
        if human {
            // Granted only because the projection leaves it as it is.
            return u;
        }
        project(&cone, u, pose.theta_rad, |angle_rad| senses.safety_ray_m(pose, angle_rad))
    }
}
