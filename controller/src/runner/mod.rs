//! The controller in action: latches what it is shown, and steps.
//!
//! In: samples, as they come, and the instants at which to step. Out: for each step a command and
//! the step that explains it. The order within a step is that of the data flow: input, estimate,
//! distances, reference, law, sharing, command (specification §9).

mod decision;
mod feedback;
mod hashing;
mod look;
mod memory;
mod prediction;
mod request;
mod reverse;
mod senses;
mod setup;
mod sharing;

use schemas::{
    Command, JoystickSample, Pose, Reason, Sample, SensorSuite, Span, Step, Time, Twist,
};

use crate::digest::Digest;
use crate::estimation::Estimate;
use crate::mutation::{Mutation, Planted};
use crate::safety::{Drive, Moving, Near, Shield};
use crate::spec::{Law, SpecError};
use decision::Facts;
pub use look::{Look, Ray, Shielded};
use memory::Memory;
use prediction::Underway;
use request::{Request, stale};
pub(crate) use reverse::ReverseLaw;
use senses::Senses;
pub use setup::Setup;

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
    senses: Senses,
    joystick: Option<JoystickSample>,
    memory: Memory,
    /// Where the last step measured from; for explanations, never read by a step.
    looked_from: Option<Pose>,
    /// How fast it foresaw itself there, [m/s, rad/s]; likewise.
    foreseen: [f64; 2],
    underway: Underway,
    /// What stands near, as of the step in hand.
    near: Near,
    /// What was observed since the previous step.
    heard: Digest,
    index: u64,
    planted: Planted,
}

impl Runner {
    /// A runner that has heard nothing yet.
    ///
    /// # Errors
    /// Parameters do not go together with the plant's limits.
    pub fn new(setup: &Setup) -> Result<Runner, SpecError> {
        setup.check()?;
        Ok(Runner {
            senses: Senses::new(&setup.scenario, setup.sensors, &setup.spec.params),
            setup: setup.clone(),
            joystick: None,
            memory: Memory::default(),
            looked_from: None,
            foreseen: [0.0; 2],
            underway: Underway::new(setup.scenario.plant, setup.spec.params.control_period_s),
            near: Senses::room_for_near(&setup.scenario, setup.sensors),
            heard: Digest::default(),
            index: 0,
            planted: Planted::default(),
        })
    }

    /// A runner that is wrong on purpose: never for driving, only to see whether a comparison notices.
    ///
    /// # Errors
    /// As [`Runner::new`].
    pub fn mutant(setup: &Setup, mutation: Mutation) -> Result<Runner, SpecError> {
        Ok(Runner { planted: Planted::new(mutation), ..Runner::new(setup)? })
    }

    /// Takes note of a sample. The last one of each kind counts, in the order in which they come;
    /// how old it is follows from its own stamp.
    pub fn observe(&mut self, sample: &Sample) {
        hashing::fold_sample(&mut self.heard, sample, self.setup.start);
        match sample {
            Sample::Joystick(joystick) => self.joystick = Some(*joystick),
            other => self.senses.observe(self.planted.sample(other).as_ref().unwrap_or(other)),
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
        let estimate = self.planted.estimate(self.senses.estimate());
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
        if let Some(report) = self.senses.report(now) {
            [step.roll_rad, step.pitch_rad, step.yaw_rad] = report.attitude_rad;
            [step.sigma_x_m, step.sigma_y_m, step.sigma_theta_rad] = report.sigma;
            step.gyro_bias_radps = report.gyro_bias_radps;
            step.encoder_innovation = report.encoder_innovation;
            step.gyro_innovation = report.gyro_innovation;
            step.encoders_rejected = report.encoders_rejected;
            step.gyro_rejected = report.gyro_rejected;
            step.estimator_status = report.status;
        }
        step.input_hash = self.input_hash(now, request.age_s, odometry_age_s);

        let t_s = now.seconds_since(self.setup.start);
        // The command will take effect later and, where the estimate is of an earlier instant,
        // elsewhere.
        let estimated =
            Moving { pose: estimate.pose, speeds: [estimate.v_mps, estimate.omega_radps] };
        let Moving { pose, mut speeds } =
            self.underway.foresee(&estimated, estimate.reached.unwrap_or(now), now);
        // An exact speed has no noise.
        if self.setup.spec.law == Law::Dynamic && self.setup.sensors == SensorSuite::Sonar {
            speeds[0] = self.underway.settled_mps(speeds[0], now);
        }
        self.senses.advance(now, t_s, &pose);
        step.sonars_unknown = self.senses.sonars_unknown();
        self.looked_from = Some(pose);
        self.foreseen = speeds;
        let shield = self.setup.shield(speeds);
        if let Some(sweep) = shield.as_ref().and_then(Shield::sweep) {
            let keep_circle_m = self.setup.keep_circle_m();
            let (reach_m, horizon_s) = sweep.reach();
            // What is close beside is asked for whether the body can get there or not.
            let reach_m = reach_m.max(decision::CLOSE_BESIDE_M);
            self.near.clear(&pose, (reach_m, horizon_s), keep_circle_m);
            self.senses.gather(&mut self.near, self.setup.spec.params.v_disc_mps);
            step.safety_clear_m = Some(self.near.circle_clear_m());
        }
        let blocked = self.blocked(&estimate, odometry_age_s, t_s);
        let facts = Facts { request: &request, pose: &pose, speeds, t_s, blocked, shield };
        self.decide(&facts, &mut step);
        self.planted.command(&mut step);
        let command = self.command(now, &step, speeds);
        self.underway.give(
            now,
            match command.accel {
                None => Drive::Velocities(step.u_s),
                Some(accel) => Drive::Accelerations(accel),
            },
        );
        step.state_hash = self.state_hash();
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
        self.underway.fold(&mut digest, self.setup.start);
        digest.value()
    }

    /// Why the robot must stand still whatever anyone asks for.
    fn blocked(&self, estimate: &Estimate, odometry_age_s: f64, t_s: f64) -> Option<Reason> {
        let params = &self.setup.spec.params;
        let sonar = self.setup.sensors == SensorSuite::Sonar;
        if estimate.stamp.is_some() && !estimate.pose.is_finite() {
            Some(Reason::PoseInvalid)
        } else if self.setup.spec.law == Law::Dynamic
            && !(estimate.v_mps.is_finite() && estimate.omega_radps.is_finite())
        {
            // The speeds are part of the dynamic model's state.
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

    /// The command of a step: velocities, or accelerations with the velocities that they lead to.
    fn command(&self, stamp: Time, step: &Step, speeds: [f64; 2]) -> Command {
        let accel = (self.setup.spec.law == Law::Dynamic).then_some(step.u_s);
        let [v_mps, omega_radps] = match accel {
            None => step.u_s,
            Some(accel) => self.setup.reached(speeds, accel),
        };
        Command { stamp, twist: Twist { v_mps, omega_radps }, accel }
    }
}
