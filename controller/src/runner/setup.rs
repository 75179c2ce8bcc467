//! What a runner is made from, and what of it follows from parameters and plant together.

use schemas::{Scenario, SensorSuite, Time};

use crate::params::Params;
use crate::safety::{Braking, Cone, Limits, Projection, Shield, Sweep, clip};
use crate::sharing::Patience;
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
    /// Whether parameters and plant go together.
    pub(super) fn check(&self) -> Result<(), SpecError> {
        let Setup { spec, scenario, sensors, .. } = self;
        let params = &spec.params;
        let (period_s, plant) = (params.control_period_s, &scenario.plant);
        let v_max_mps = plant.v_max_mps;
        if params.margin_applies(*sensors) || params.projection == Projection::Cone {
            // The critical distance of the fastest speed must hold what is travelled in a period
            // (b1²/(1+b1 v) ≥ Ts), and with accelerations for inputs the way to stop too
            // (specification §5).
            let stopping_s = match spec.law {
                Law::Dynamic => period_s + v_max_mps / (2.0 * plant.accel_max_mps2),
                Law::Kinematic | Law::Human => period_s,
            };
            let travel_m = stopping_s * v_max_mps;
            let least_m = 0.5 * (travel_m + libm::sqrt(travel_m * travel_m + 4.0 * stopping_s));
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
        if let Some(Shield::Velocity(cone)) = self.shield([0.0; 2]) {
            let omega_max_radps = plant.omega_max_radps;
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

    /// The limits of an input.
    pub(super) fn limits(&self) -> Limits {
        match self.spec.law {
            Law::Kinematic | Law::Human => Limits::of_velocity(&self.scenario.plant),
            Law::Dynamic => Limits::of_acceleration(&self.scenario.plant),
        }
    }

    /// The person's input: the velocities asked for, or the accelerations that they become, within
    /// the limits (specification §7); zero where nothing is asked for.
    pub(super) fn human_input(
        &self,
        requested: [f64; 2],
        silent: bool,
        speeds: [f64; 2],
    ) -> [f64; 2] {
        let params = &self.spec.params;
        if self.spec.law != Law::Dynamic || silent || !speeds.iter().all(|x| x.is_finite()) {
            return if silent { [0.0; 2] } else { requested };
        }
        let accel = [
            params.human_gain_v * (requested[0] - speeds[0]),
            params.human_gain_omega * (requested[1] - speeds[1]),
        ];
        clip(accel, &self.limits())
    }

    /// The input that stops (specification §10).
    pub(super) fn stop(&self, speeds: [f64; 2]) -> [f64; 2] {
        if self.spec.law != Law::Dynamic {
            return [0.0; 2];
        }
        let period_s = self.spec.params.control_period_s;
        // What is not a number cannot be braked by how much it is.
        let braked = |speed: f64| if speed.is_finite() { -speed / period_s } else { 0.0 };
        clip(speeds.map(braked), &self.limits())
    }

    /// The velocities at the end of a period of constant acceleration.
    pub(super) fn reached(&self, speeds: [f64; 2], accel: [f64; 2]) -> [f64; 2] {
        let period_s = self.spec.params.control_period_s;
        let reached = |speed: f64, accel: f64| {
            if speed.is_finite() { speed + accel * period_s } else { 0.0 }
        };
        clip(
            [reached(speeds[0], accel[0]), reached(speeds[1], accel[1])],
            &Limits::of_velocity(&self.scenario.plant),
        )
    }

    /// How clear the turning circle is to stay of what it is that clear of, metres, if at all.
    pub(super) fn keep_circle_m(&self) -> Option<f64> {
        let params = &self.spec.params;
        let swept_circle = match params.projection {
            Projection::Circle => true,
            Projection::Both => self.turns_out_of_cones(),
            Projection::None | Projection::Cone | Projection::Rectangle => false,
        };
        swept_circle.then_some(params.body_guard_m)
    }

    /// The safety layer of a step that finds the robot at `speeds`.
    pub(super) fn shield(&self, [v_mps, omega_radps]: [f64; 2]) -> Option<Shield> {
        let (params, plant) = (&self.spec.params, &self.scenario.plant);
        if params.projection == Projection::None {
            return None;
        }
        let (period_s, guard_m, v_disc_mps, spread_rad) =
            (params.control_period_s, params.guard_m, params.v_disc_mps, params.cone_rad);
        let sweep = Sweep {
            plant: *plant,
            accelerations: self.spec.law == Law::Dynamic,
            period_s,
            guard_m: params.body_guard_m,
            later_s: plant.actuator_delay_s,
            speeds: [v_mps, omega_radps],
            turn_most_radps: f64::INFINITY,
        };
        match params.projection {
            Projection::Rectangle | Projection::Circle => return Some(Shield::Swept(sweep)),
            Projection::Both if self.turns_out_of_cones() => return Some(Shield::Swept(sweep)),
            Projection::None | Projection::Cone | Projection::Both => {}
        }
        let swept = params.projection == Projection::Both;
        if self.spec.law == Law::Dynamic {
            let braking = Braking {
                period_s,
                guard_m,
                v_disc_mps,
                spread_rad,
                accel_mps2: plant.accel_max_mps2,
                alpha_radps2: plant.alpha_max_radps2,
                v_mps,
                omega_radps,
            };
            return Some(if swept {
                Shield::AccelerationSwept(braking, sweep)
            } else {
                Shield::Acceleration(braking)
            });
        }
        let brake_mps2 = plant.limits_acceleration.then_some(plant.accel_max_mps2);
        let cone = Cone {
            period_s,
            guard_m,
            v_disc_mps,
            spread_rad,
            turning_s: period_s + self.braking_s(),
            omega_now_radps: if brake_mps2.is_some() { omega_radps } else { 0.0 },
            brake_mps2,
        };
        Some(if swept { Shield::VelocitySwept(cone, sweep) } else { Shield::Velocity(cone) })
    }

    /// How long it takes to brake from full speed, seconds; 0 where commands take effect at once.
    fn braking_s(&self) -> f64 {
        let plant = &self.scenario.plant;
        if self.spec.law == Law::Dynamic || plant.limits_acceleration {
            plant.v_max_mps / plant.accel_max_mps2
        } else {
            0.0
        }
    }

    /// Whether the plant can turn by a right angle or more before it is looked at again and has
    /// stopped: then a cone of headings says nothing.
    fn turns_out_of_cones(&self) -> bool {
        let params = &self.spec.params;
        let turning_s = params.control_period_s + self.braking_s();
        let turn_rad = self.scenario.plant.omega_max_radps * turning_s + params.cone_rad;
        turn_rad >= std::f64::consts::FRAC_PI_2
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

    /// How long the person waits for k = 1; `None` if not at all.
    pub(super) fn patience(&self, sensors: SensorSuite) -> Option<Patience> {
        self.wait.applies(sensors).then_some(Patience {
            grant_s: self.grant_s,
            dwell_s: self.dwell_s,
            period_s: self.control_period_s,
        })
    }

    /// `D_eff`, metres: D as the sets see it when asked about a speed (specification §5).
    pub fn effective_m(&self, d_m: f64, v_mps: f64, sensors: SensorSuite) -> f64 {
        let shortfall_m = match sensors {
            SensorSuite::Exact => 0.0,
            SensorSuite::Sonar => self.sonar_shortfall_m,
        };
        let margin_m = if self.margin_applies(sensors) {
            self.guard_m + libm::fabs(v_mps) * self.control_period_s
        } else {
            0.0
        };
        d_m + shortfall_m - margin_m
    }

    /// Whether the sets see D less guard and travel.
    pub(super) fn margin_applies(&self, sensors: SensorSuite) -> bool {
        self.margin.applies(sensors)
    }
}
