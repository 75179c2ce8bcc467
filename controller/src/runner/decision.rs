//! Reference, law, sharing and command of one step.

use schemas::{Pose, Reason, Region, Step};

use super::Runner;
use super::feedback::{Feedback, View};
use super::request::Request;
use super::senses::Senses;
use super::setup::Setup;
use super::sharing::Question;
use crate::safety::{Limits, Near, Saturation, Shield, clip, scale, scale_velocities};
use crate::sharing::select;
use crate::spec::Law;
use crate::target::Target;
use crate::travel::direction_of_travel_rad;

/// With something this near to the turning circle, metres, the feedback law turns no faster than sonars look
/// around: what stands beside the body, between the cones, comes into one within a sweep of 0.32 s. At
/// 1 rad/s that is 18°, the width of a cone. Chosen.
pub(super) const CLOSE_BESIDE_M: f64 = 0.1;
const LOOKING_RADPS: f64 = 1.0;

/// What a decision goes by, beside what the runner remembers.
pub(super) struct Facts<'a> {
    pub(super) request: &'a Request,
    /// Where the command will take effect.
    pub(super) pose: &'a Pose,
    /// Present speeds, [m/s, rad/s].
    pub(super) speeds: [f64; 2],
    pub(super) t_s: f64,
    /// Why the robot must stand still whatever anyone asks for.
    pub(super) blocked: Option<Reason>,
    /// The safety layer, where there is one.
    pub(super) shield: Option<Shield>,
}

impl Runner {
    /// Decides, and notes everything in the step.
    pub(super) fn decide(&mut self, facts: &Facts<'_>, step: &mut Step) {
        let Runner { setup, senses, memory, near, planted, .. } = self;
        let setup: &Setup = setup;
        let Setup { spec, scenario, sensors, .. } = setup;
        let Facts { request, pose, speeds, t_s, blocked, shield } = *facts;
        let (law, params) = (spec.law, &spec.params);
        let limits = setup.limits();
        let requested = clip(request.u, &Limits::of_velocity(&scenario.plant));
        let u_h = setup.human_input(requested, request.trouble.is_some(), speeds);
        step.u_h = u_h;

        let mut target = match &scenario.task {
            _ if request.trouble.is_some() => Target::hold(pose),
            Some(task) => Target::of_task(task, t_s, params.intent_s),
            None => Target::of_joystick(pose, requested[0], requested[1], params.prediction_s),
        };
        memory.keep_target(params, requested, &scenario.plant, &mut target);
        memory.face(params.reverse_law, requested[0]);
        planted.target(&mut target);
        step.reference_source = target.source;
        [step.target_x_m, step.target_y_m] = target.position_m;
        [step.target_vx_mps, step.target_vy_mps] = target.velocity_mps;

        let view = View { law, params, senses, near, pose, speeds, target: &target };
        let mut feedback = Feedback { u: [0.0; 2], trouble: None };
        // Without a pose D is not a number, and what is not a number is dangerous.
        let mut reason = Reason::PoseInvalid;
        (step.region, step.danger) = (Region::Danger, 1.0);
        if pose.is_finite() {
            feedback = view.feedback(memory, planted, step);
            let (mode, b1_m, b2_m) = params.question(scenario.task.is_some());
            let free_plant = scenario.task.is_none().then_some(&scenario.plant);
            let question = Question {
                request: requested,
                u_h,
                mode,
                b1_m,
                b2_m,
                patience: params.patience(*sensors),
                sensors: *sensors,
                shield,
                free_plant,
            };
            reason = view.share(&question, memory, planted, step);
        }

        if law == Law::Human {
            step.k = 1.0;
            step.reason = request.trouble.unwrap_or(Reason::Human);
            step.u_s_before_projection = u_h;
            step.u_s = u_h;
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
        let stopped = blocked.is_some() || request.released || feedback.trouble.is_some();
        let u_f = if stopped {
            setup.stop(speeds)
        } else {
            match params.saturation {
                Saturation::Scale if law == Law::Dynamic => scale(feedback.u, &limits),
                Saturation::Scale => scale_velocities(feedback.u, &limits),
                Saturation::Clip => clip(feedback.u, &limits),
            }
        };
        let chosen = select(human, u_f, u_h);
        step.saturated = !stopped && !human && u_f != feedback.u;
        step.u_s_before_projection = chosen;
        step.u_s = view.made_safe(chosen, human, shield, step.distance_human_m);
        step.projected = step.u_s != chosen;
    }
}

/// The safety layer as the feedback law meets it: close beside something that is looked at one
/// direction after the other it turns no faster than that.
pub(super) fn of_feedback(shield: Shield, senses: &Senses, near: &Near) -> Shield {
    if senses.swept_in_turn() && near.circle_clear_m() < CLOSE_BESIDE_M {
        shield.turning_at_most(LOOKING_RADPS)
    } else {
        shield
    }
}

impl View<'_> {
    /// The input that may really be applied.
    fn made_safe(&self, u: [f64; 2], human: bool, shield: Option<Shield>, d_m: f64) -> [f64; 2] {
        let View { law, senses, pose, speeds, .. } = self;
        let blind = *law == Law::Dynamic && !speeds.iter().all(|speed| speed.is_finite());
        if human || blind || !pose.is_finite() {
            // The person has control only where the safety layer leaves their input as it is; and
            // where the state is not known the input is a stop.
            return u;
        }
        let Some(shield) = shield else {
            // Contact: the feedback law does not push on (specification §10).
            let along_rad = direction_of_travel_rad(pose.theta_rad, u[0]);
            let pushing =
                *law == Law::Kinematic && d_m <= 0.0 && senses.law_ray_m(pose, along_rad) <= 0.0;
            return if pushing { [0.0, u[1]] } else { u };
        };
        let ray_m = self.safety_rays(u, &shield);
        let shield = of_feedback(shield, senses, self.near);
        shield.project(u, pose.theta_rad, ray_m, self.near)
    }

    /// The safety layer's rays, as far as they bear on the input `u`: where everything is so far away that
    /// none of them does, they need not be traced.
    fn safety_rays(&self, u: [f64; 2], shield: &Shield) -> impl Fn(f64) -> f64 {
        let View { senses, pose, .. } = *self;
        let far = shield.passes_rays(u, pose.theta_rad, || senses.safety_least_m(pose));
        move |angle_rad| if far { f64::INFINITY } else { senses.safety_ray_m(pose, angle_rad) }
    }

    /// Whether the safety layer leaves an input as it is.
    pub(super) fn harmless(&self, u: [f64; 2], shield: &Shield) -> bool {
        let ray_m = self.safety_rays(u, shield);
        let View { pose, .. } = self;
        shield.allows(u, pose.theta_rad, ray_m, self.near)
    }
}
