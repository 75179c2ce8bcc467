//! What the last step saw, for explanations: the same questions that it asked, asked again.
//!
//! In: a runner that has just stepped and has heard nothing since. Out: rays with the echoes that
//! end them, and what the safety layer would leave of an input. Nothing here changes anything.

use std::cell::RefCell;

use schemas::{Pose, Step};

use super::Runner;
use super::decision::of_feedback;
use crate::perception::echo_map::LimitingEcho;
use crate::travel::{DMode, Travel};

/// The surroundings as the last step saw them.
#[derive(Clone, Copy, Debug)]
pub struct Look<'a> {
    runner: &'a Runner,
    from: Pose,
}

/// One ray, and what ends it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// World angle, radians.
    pub angle_rad: f64,
    /// Free travel of what is asked about (`law_body`, `d_body`; for the safety layer the body's circle), metres:
    /// +∞ where nothing is met, NaN where nothing is known (0 for the safety layer).
    pub free_m: f64,
    /// The echo that ends it; `None` with exact rays, and where nothing is met or known.
    pub echo: Option<LimitingEcho>,
}

/// What the safety layer leaves of an input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shielded {
    /// The input that is left.
    pub u: [f64; 2],
    /// The shortest ray that it looked along; `None` where it did not have to look.
    pub ray: Option<Ray>,
}

impl Runner {
    /// What the last step saw; `None` before the first. To be asked before anything else is
    /// observed.
    pub fn look(&self) -> Option<Look<'_>> {
        self.looked_from.map(|from| Look { runner: self, from })
    }
}

impl Look<'_> {
    /// Where rays start: the pose at which the command takes effect.
    pub fn from(&self) -> &Pose {
        &self.from
    }

    /// The law's ray along a world angle.
    pub fn law_ray(&self, angle_rad: f64) -> Ray {
        let (senses, body) = (&self.runner.senses, self.runner.setup.spec.params.law_body);
        Ray {
            angle_rad,
            free_m: senses.law_m(body, &self.from, angle_rad),
            echo: senses.law_end(body, &self.from, angle_rad),
        }
    }

    /// The safety layer's ray along a world angle.
    pub fn safety_ray(&self, angle_rad: f64) -> Ray {
        let senses = &self.runner.senses;
        Ray {
            angle_rad,
            free_m: senses.safety_ray_m(&self.from, angle_rad),
            echo: senses.safety_limit(&self.from, angle_rad),
        }
    }

    /// The ray that D comes from when asked about (v, ω), with `step` the step that was made: the
    /// shortest of those that `mode` looks along, an unknown one before any.
    pub fn travel_ray(&self, step: &Step, mode: DMode, [v_mps, omega_radps]: [f64; 2]) -> Ray {
        let setup = &self.runner.setup;
        let t_s = step.stamp.seconds_since(setup.start);
        let intent_m = match (step.reference_source, &setup.scenario.task) {
            (schemas::ReferenceSource::Task, Some(task)) => {
                task.target(t_s + setup.spec.params.intent_s).0
            }
            // A target that follows from the joystick, or holds, is where the person wants to be.
            _ => [step.target_x_m, step.target_y_m],
        };
        let sweep_s = setup.spec.params.sweep_s;
        let travel = Travel { pose: self.from, v_mps, omega_radps, intent_m, sweep_s };
        let (senses, body) = (&self.runner.senses, setup.spec.params.d_body);
        let asked = RefCell::new(Shortest::default());
        travel.distance_m(mode, |angle_rad| {
            let free_m = senses.travel_m(body, &self.from, angle_rad);
            asked.borrow_mut().take(angle_rad, free_m);
            free_m
        });
        // Every mode looks along one direction at least.
        let angle_rad = asked.into_inner().angle_rad.unwrap_or(self.from.theta_rad);
        Ray {
            angle_rad,
            free_m: senses.travel_m(body, &self.from, angle_rad),
            echo: senses.travel_limit(body, &self.from, angle_rad),
        }
    }

    /// What the safety layer leaves of the input `u`, the feedback law's or the person's; `None`
    /// without one.
    pub fn shielded(&self, u: [f64; 2], of_law: bool) -> Option<Shielded> {
        let shield = self.runner.setup.shield(self.runner.foreseen)?;
        let (senses, near) = (&self.runner.senses, &self.runner.near);
        let shield = if of_law { of_feedback(shield, senses, near) } else { shield };
        let asked = RefCell::new(Shortest::default());
        let left = shield.project(
            u,
            self.from.theta_rad,
            |angle_rad| {
                let free_m = senses.safety_ray_m(&self.from, angle_rad);
                asked.borrow_mut().take(angle_rad, free_m);
                free_m
            },
            near,
        );
        let angle_rad = asked.into_inner().angle_rad;
        Some(Shielded { u: left, ray: angle_rad.map(|angle_rad| self.safety_ray(angle_rad)) })
    }
}

/// The shortest of some rays; an unknown one before any.
#[derive(Clone, Copy, Debug, Default)]
struct Shortest {
    angle_rad: Option<f64>,
    free_m: f64,
}

impl Shortest {
    fn take(&mut self, angle_rad: f64, free_m: f64) {
        let shorter = self.angle_rad.is_none()
            || free_m < self.free_m
            || (free_m.is_nan() && !self.free_m.is_nan());
        if shorter {
            *self = Shortest { angle_rad: Some(angle_rad), free_m };
        }
    }
}
