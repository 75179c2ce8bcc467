//! From pose, target and rays to the feedback input, noting every quantity on the way in the step.

use std::f64::consts::FRAC_PI_2;

use schemas::{Pose, Reason, Step};

use super::memory::Memory;
use super::reverse::{mirrored_plan, mirrored_scene};
use super::senses::Senses;
use crate::frame::{Aim, Framed, frame};
use crate::mutation::Planted;
use crate::params::Params;
use crate::plan::{Plan, Scene, plan};
use crate::safety::Near;
use crate::spec::Law;
use crate::target::{Target, UNDERFOOT_M, direction_rad};

/// Speed below which a target rests, m/s.
const RESTING_MPS: f64 = 1e-9;

/// The feedback input, and why it is zero where it could not be formed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Feedback {
    pub(super) u: [f64; 2],
    pub(super) trouble: Option<Reason>,
}

/// Everything that law and sharing go by.
pub(super) struct View<'a> {
    pub(super) law: Law,
    pub(super) params: &'a Params,
    pub(super) senses: &'a Senses,
    pub(super) near: &'a Near,
    pub(super) pose: &'a Pose,
    /// Present speeds, [m/s, rad/s].
    pub(super) speeds: [f64; 2],
    pub(super) target: &'a Target,
}

impl View<'_> {
    /// The feedback input.
    pub(super) fn feedback(
        &self,
        memory: &mut Memory,
        planted: &mut Planted,
        step: &mut Step,
    ) -> Feedback {
        let framed = self.frame(memory.psi_rad);
        let mut scene = self.scene(&framed);
        planted.scene(&mut scene);
        let (scene, mut plan) = if memory.mirrored {
            let scene = mirrored_scene(scene);
            (scene, mirrored_plan(&plan(self.law, self.params, &scene, &memory.past)))
        } else {
            (scene, plan(self.law, self.params, &scene, &memory.past))
        };
        plan.u = planted.feedback(plan.u);
        memory.psi_rad = Some(framed.psi_rad);
        memory.past = plan.past();
        note_frame(step, &framed, &scene);
        note_plan(step, &plan);
        Feedback { u: plan.u, trouble: plan.trouble }
    }

    fn frame(&self, previous_rad: Option<f64>) -> Framed {
        let View { params, senses, pose, target, .. } = self;
        let aim = Aim {
            velocity_rad: direction_rad(target.velocity_mps, RESTING_MPS),
            displacement_rad: direction_rad(target.displacement_m(pose), UNDERFOOT_M),
            predicted: target.predicted(),
        };
        let face_rad = senses.face_direction_rad(pose);
        let period_s = params.control_period_s;
        frame(params.frame, previous_rad, &aim, face_rad, pose.theta_rad, period_s)
    }

    fn scene(&self, framed: &Framed) -> Scene {
        let View { params, senses, pose, target, .. } = self;
        let distance_m = |angle_rad| senses.law_m(params.law_body, pose, angle_rad);
        let psi_rad = framed.psi_rad;
        let (sin, cos) = libm::sincos(psi_rad);
        let in_frame = |[x, y]: [f64; 2]| [x * cos + y * sin, y * cos - x * sin];
        Scene {
            d1_m: distance_m(psi_rad),
            d2l_m: distance_m(psi_rad + FRAC_PI_2),
            d2r_m: distance_m(psi_rad - FRAC_PI_2),
            delta_m: in_frame(target.displacement_m(pose)),
            q_mps: in_frame(target.velocity_mps),
            theta_e_rad: pose.theta_rad - psi_rad,
            omega_r_radps: framed.omega_r_radps,
            jumped: framed.jumped,
            v_mps: self.speeds[0],
            omega_radps: self.speeds[1],
        }
    }
}

fn note_frame(step: &mut Step, framed: &Framed, scene: &Scene) {
    step.frame_source = framed.source;
    step.psi_rad = framed.psi_rad;
    step.omega_r_radps = framed.omega_r_radps;
    [step.delta1_m, step.delta2_m] = scene.delta_m;
    [step.q1_mps, step.q2_mps] = scene.q_mps;
    step.theta_e_rad = scene.theta_e_rad;
}

fn note_plan(step: &mut Step, plan: &Plan) {
    let situation = &plan.situation;
    let [ahead, aside] = &plan.wanted;
    [step.d1_m, step.d2l_m, step.d2r_m] = plan.capped_m;
    step.side = if situation.sigma() > 0.0 { 1 } else { -1 };
    (step.d_d1_m, step.d_d2_m) = (ahead.d_d_m, aside.d_d_m);
    (step.d_r1_m, step.d_r2_m) = (situation.ahead.d_r_m, situation.aside.d_r_m);
    step.d_r1_rate_mps = situation.ahead.d_r_rate_mps;
    step.d_r2_rate_mps = situation.aside.d_r_rate_mps;
    step.d_r1_accel_mps2 = situation.ahead.d_r_accel_mps2;
    step.d_r2_accel_mps2 = situation.aside.d_r_accel_mps2;
    step.law_branch = plan.branch;
    step.u_f = plan.u;
    if let Some(outcome) = &plan.outcome {
        (step.z1, step.z2) = (situation.ahead.z(), situation.aside.z());
        step.theta_star_rad = outcome.star.theta_rad;
        step.theta_star_rate_radps = outcome.rates.theta_radps;
        step.v_star_mps = outcome.star.v_mps;
        step.omega_star_radps = outcome.omega_star_radps;
        step.lyapunov = outcome.lyapunov;
    }
}
