//! Remedies for free driving where the feedback law would chase its own heading: the mirrored robot, and
//! a predicted target that stays (specification §13, open point e).

use std::f64::consts::PI;

use schemas::Plant;

use super::memory::Memory;
use crate::params::{Params, choice};
use crate::plan::{Plan, Scene};
use crate::sharing::{Patience, another_request};
use crate::target::{PredictedTarget, Target};

choice! {
    /// Which robot the feedback law drives where the person asks to go backwards. The law knows no way
    /// back: its speed is v* ≥ 0.
    ReverseLaw {
        /// The same: it turns round to where the person wants to be.
        Same = "same",
        /// The mirrored one, whose front is this one's rear: (θ + π, −v).
        Mirrored = "mirrored",
    }
}

impl Params {
    /// Whether it matters what the person asked for when the feedback law took over.
    pub(super) fn remembers_the_fall(&self, patience: Option<&Patience>) -> bool {
        patience.is_some() || self.predicted_target == PredictedTarget::Stays
    }
}

impl Memory {
    /// Decides which robot the law drives; it stays the same one at a request of v = 0.
    pub(super) fn face(&mut self, rule: ReverseLaw, v_mps: f64) {
        let mirrored = match rule {
            ReverseLaw::Same => false,
            ReverseLaw::Mirrored if v_mps == 0.0 => self.mirrored,
            ReverseLaw::Mirrored => v_mps < 0.0,
        };
        if mirrored != self.mirrored {
            // θ* was that of the other robot.
            self.past.theta_star_rad = None;
        }
        self.mirrored = mirrored;
    }

    /// Puts a predicted target back where it was when the feedback law took over.
    pub(super) fn keep_target(
        &self,
        params: &Params,
        request: [f64; 2],
        plant: &Plant,
        target: &mut Target,
    ) {
        if params.predicted_target == PredictedTarget::Stays
            && target.predicted()
            && let Some((before, position_m)) = self.fell
            && !another_request(request, before, plant)
        {
            target.position_m = position_m;
        }
    }
}

/// The scene as the mirrored robot sees it: its heading is the other way round and so is its speed; the
/// world is the same, and so is the way it turns.
pub(super) fn mirrored_scene(scene: Scene) -> Scene {
    Scene { theta_e_rad: scene.theta_e_rad + PI, v_mps: -scene.v_mps, ..scene }
}

/// What the robot does when the mirrored one follows a plan.
pub(super) fn mirrored_plan(plan: &Plan) -> Plan {
    Plan { u: [-plan.u[0], plan.u[1]], ..*plan }
}
