//! What a runner is made from, and what of it follows from parameters and plant together.

use schemas::{Plant, Scenario, SensorSuite, Time};

use crate::params::Params;
use crate::safety::{Cone, Projection};
use crate::sharing::Margin;
use crate::spec::{Law, Spec, SpecError};
use crate::travel::DMode;

/// What a runner needs to know before it starts.
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// The version of the controller.
    pub spec: Spec,
    /// World (read with exact rays only), task, robot and limits.
    pub scenario: Scenario,
    /// Which sensors it will hear.
    pub sensors: SensorSuite,
    /// t = 0 of task and world.
    pub start: Time,
}

impl Setup {
    /// Whether law, parameters and plant go together.
    pub(super) fn check(&self) -> Result<(), SpecError> {
        let Setup { spec, scenario, sensors, .. } = self;
        let Spec { law, params, .. } = spec;
        if *law == Law::Dynamic {
            return Err(SpecError::Law { law: law.name() });
        }
        let (period_s, v_max_mps) = (params.control_period_s, scenario.plant.v_max_mps);
        if params.margin_applies(*sensors) || params.projection == Projection::Cone {
            // b1²/(1+b1 v_max) ≥ Ts: a period's travel fits into the critical distance
            // (specification §5).
            let travel_m = period_s * v_max_mps;
            let least_m = 0.5 * (travel_m + libm::sqrt(travel_m * travel_m + 4.0 * period_s));
            let task = scenario.task.is_some();
            let (_, b1_m, _) = params.question(task);
            if b1_m < least_m {
                return Err(SpecError::Together {
                    key: if task { "b1_task_m" } else { "b1_free_m" },
                    value: b1_m,
                    allowed: format!("at least {least_m:.3}"),
                    because: format!(
                        "for `control_period_s` = {period_s} and a plant of {v_max_mps} m/s"
                    ),
                });
            }
        }
        if let Some(cone) = params.cone(&scenario.plant, scenario.plant.omega_max_radps) {
            let omega_max_radps = scenario.plant.omega_max_radps;
            let half_rad = omega_max_radps * cone.turning_s + cone.spread_rad;
            if half_rad >= std::f64::consts::FRAC_PI_2 {
                return Err(SpecError::Together {
                    key: "control_period_s",
                    value: period_s,
                    allowed: "a shorter period".to_owned(),
                    because: format!(
                        "since a plant of {omega_max_radps} rad/s could turn {half_rad:.2} rad \
                         before it is looked at again; the safety layer needs less than π/2"
                    ),
                });
            }
        }
        Ok(())
    }
}

impl Params {
    /// How D is measured, and b1 and b2: with a task given or in free driving.
    pub(super) fn question(&self, task: bool) -> (DMode, f64, f64) {
        if task {
            (self.d_mode_task, self.b1_task_m, self.b2_task_m)
        } else {
            (self.d_mode_free, self.b1_free_m, self.b2_free_m)
        }
    }

    /// Whether the sets see `D_eff`.
    pub(super) fn margin_applies(&self, sensors: SensorSuite) -> bool {
        match self.margin {
            Margin::Never => false,
            Margin::Sonar => sensors == SensorSuite::Sonar,
            Margin::Always => true,
        }
    }

    /// The safety layer S2 for a plant that turns at `omega_now_radps`.
    pub(super) fn cone(&self, plant: &Plant, omega_now_radps: f64) -> Option<Cone> {
        if self.projection == Projection::None {
            return None;
        }
        let brake_mps2 = plant.limits_acceleration.then_some(plant.accel_max_mps2);
        Some(Cone {
            period_s: self.control_period_s,
            guard_m: self.guard_m,
            v_disc_mps: self.v_disc_mps,
            spread_rad: self.cone_rad,
            turning_s: self.control_period_s + brake_mps2.map_or(0.0, |a| plant.v_max_mps / a),
            omega_now_radps: if brake_mps2.is_some() { omega_now_radps } else { 0.0 },
            brake_mps2,
        })
    }
}
