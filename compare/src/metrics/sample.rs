//! What the metrics see of a run: how the robot moved, and what the controller decided.

use schemas::{Disc, Footprint, Plant, Pose, Scenario, Step, Task, Twist, World};

use super::judge::Judgement;

/// The longest that one motion sample stands for what follows it, seconds: the age at which a
/// distance counts as unknown (specification §10). A hole in the record is not filled any further.
pub(super) const MOTION_HOLD_LIMIT_S: f64 = 0.5;

/// How far ahead a collision is looked for, seconds.
pub(super) const TTC_HORIZON_S: f64 = 3.0;

/// How many control periods a decision stands at most. After twice the period real actuators time
/// out by themselves (specification §10; the simulated ones hold the last command).
pub(super) const DECISION_HOLD_LIMIT_PERIODS: f64 = 2.0;

/// Where the robot was and how near to things, until the next sample.
#[derive(Clone, Debug)]
pub(super) struct Motion {
    /// Seconds from the start of the run.
    pub(super) t_s: f64,
    /// How long this sample stands, seconds; 0 for the last one.
    pub(super) hold_s: f64,
    pub(super) pose: Pose,
    pub(super) twist: Twist,
    /// Signed clearance of the footprint from everything, metres; NaN where nothing tells.
    pub(super) clearance_m: f64,
    /// The same from what does not move.
    pub(super) clearance_static_m: f64,
    pub(super) discs: Vec<Disc>,
    /// Time to collision at these speeds, seconds, [`TTC_HORIZON_S`] where nothing is hit until
    /// then; NaN where nothing tells.
    pub(super) ttc_s: f64,
}

/// What the person asked for, what the controller did, until the next step.
#[derive(Clone, Debug)]
pub(super) struct Decision {
    /// Seconds from the start of the run.
    pub(super) t_s: f64,
    /// How long it stands, seconds.
    pub(super) hold_s: f64,
    /// Sharing function, 1 the person, 0 the feedback law; NaN where unknown.
    pub(super) k: f64,
    /// Requested velocities, clipped to the plant's limits; NaN where nobody asks.
    pub(super) requested: Twist,
    /// Commanded velocities; NaN where no command followed the step.
    pub(super) executed: Twist,
    /// How the robot really moved at that moment.
    pub(super) actual: Twist,
    /// Whether the person's input went to the actuators bit for bit.
    pub(super) passed: bool,
    /// Whether the law commands accelerations.
    pub(super) accelerates: bool,
    /// Where the robot really was.
    pub(super) pose: Pose,
    /// Whether the request was safe; `None` where that cannot be told.
    pub(super) judgement: Option<Judgement>,
    /// What the law said of itself.
    pub(super) law: LawState,
}

/// What of a step tells whether the theorem covers it.
#[derive(Clone, Copy, Debug)]
pub(super) struct LawState {
    pub(super) lyapunov: f64,
    pub(super) branch: schemas::LawBranch,
    pub(super) reference: schemas::ReferenceSource,
    /// Whether anything but the law itself shaped the input.
    pub(super) altered: bool,
    pub(super) psi_rad: f64,
    pub(super) target_velocity_mps: [f64; 2],
    /// Ahead, left, right.
    pub(super) distances_m: [f64; 3],
}

impl LawState {
    pub(super) fn of(step: &Step) -> LawState {
        LawState {
            lyapunov: step.lyapunov,
            branch: step.law_branch,
            reference: step.reference_source,
            altered: step.saturated || step.projected,
            psi_rad: step.psi_rad,
            target_velocity_mps: [step.target_vx_mps, step.target_vy_mps],
            distances_m: [step.d1_m, step.d2l_m, step.d2r_m],
        }
    }
}

/// What the joystick said, at its own rate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Request {
    /// Seconds from the start of the run.
    pub(super) t_s: f64,
    /// Clipped to the plant's limits; NaN where it said nothing that is a number.
    pub(super) twist: Twist,
}

/// The plant's top speeds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    v_max_mps: f64,
    omega_max_radps: f64,
}

impl Limits {
    pub(super) fn new(plant: &Plant) -> Limits {
        Limits { v_max_mps: plant.v_max_mps, omega_max_radps: plant.omega_max_radps }
    }

    /// ‖S u‖ with S = diag(1/`v_max`, 1/`ω_max`): 1 is full speed. NaN where a part is unknown.
    pub(super) fn scaled(self, twist: Twist) -> f64 {
        if twist.v_mps.is_nan() || twist.omega_radps.is_nan() {
            return f64::NAN;
        }
        libm::hypot(twist.v_mps / self.v_max_mps, twist.omega_radps / self.omega_max_radps)
    }

    /// The input that lies `by`, in shares of full speed, away from another.
    pub(super) fn moved(self, twist: Twist, by: [f64; 2]) -> Twist {
        Twist {
            v_mps: twist.v_mps + by[0] * self.v_max_mps,
            omega_radps: twist.omega_radps + by[1] * self.omega_max_radps,
        }
    }

    /// Whether the plant can do that.
    pub(super) fn allow(self, twist: Twist) -> bool {
        libm::fabs(twist.v_mps) <= self.v_max_mps
            && libm::fabs(twist.omega_radps) <= self.omega_max_radps
    }

    /// S u as a pair: shares of full speed and full turn rate.
    pub(super) fn shares(self, twist: Twist) -> [f64; 2] {
        [twist.v_mps / self.v_max_mps, twist.omega_radps / self.omega_max_radps]
    }

    /// Top speed, m/s.
    pub(super) fn v_max_mps(self) -> f64 {
        self.v_max_mps
    }

    /// What of a request the plant can do at all; NaN stays NaN.
    pub(super) fn clipped(self, twist: Twist) -> Twist {
        let within = |x: f64, limit: f64| if limit > 0.0 { x.clamp(-limit, limit) } else { x };
        Twist {
            v_mps: within(twist.v_mps, self.v_max_mps),
            omega_radps: within(twist.omega_radps, self.omega_max_radps),
        }
    }
}

/// What of a scenario the metrics need.
#[derive(Clone, Debug)]
pub(super) struct Setting {
    pub(super) footprint: Footprint,
    pub(super) limits: Limits,
    pub(super) plant: Plant,
    pub(super) task: Option<Task>,
    /// Where the task ends, where the body fits there.
    pub(super) goal_m: Option<[f64; 2]>,
    pub(super) world: World,
}

impl Setting {
    pub(super) fn new(scenario: &Scenario) -> Setting {
        let mut setting = Setting {
            footprint: scenario.robot.footprint,
            limits: Limits::new(&scenario.plant),
            plant: scenario.plant,
            task: scenario.task,
            goal_m: None,
            world: scenario.world.clone(),
        };
        setting.goal_m = setting.reachable_goal();
        setting
    }

    /// The task's end point, unless the body cannot stand there: then nobody can be late for it.
    fn reachable_goal(&self) -> Option<[f64; 2]> {
        let task = self.task?;
        let goal = task.target(task.until_s).0;
        let pose = Pose { x_m: goal[0], y_m: goal[1], theta_rad: 0.0 };
        let inscribed_m = 0.5 * self.footprint.length_m.min(self.footprint.width_m);
        let fits = !self.has_world()
            || self.world.clearance_static_m(&Footprint::POINT, &pose) >= inscribed_m;
        (pose.is_finite() && fits).then_some(goal)
    }

    /// Whether there is anything to keep clear of.
    pub(super) fn has_world(&self) -> bool {
        let world = &self.world;
        !(world.room.is_empty() && world.obstacles.is_empty() && world.discs.is_empty())
    }
}

/// Executed less requested velocities.
pub(super) fn deviation(decision: &Decision) -> Twist {
    Twist {
        v_mps: decision.executed.v_mps - decision.requested.v_mps,
        omega_radps: decision.executed.omega_radps - decision.requested.omega_radps,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: Limits = Limits { v_max_mps: 0.5, omega_max_radps: 2.0 };

    fn twist(v_mps: f64, omega_radps: f64) -> Twist {
        Twist { v_mps, omega_radps }
    }

    /// 0.3 m/s of 0.5 and 1.6 rad/s of 2: shares of 0.6 and 0.8, together 1.
    #[test]
    fn full_speed_is_one() {
        assert_eq!(LIMITS.shares(twist(-0.3, 1.6)), [-0.6, 0.8]);
        assert!((LIMITS.scaled(twist(-0.3, 1.6)) - 1.0).abs() < 1e-15);
        for unknown in [twist(f64::NAN, 1.0), twist(f64::INFINITY, f64::NAN)] {
            assert!(LIMITS.scaled(unknown).is_nan());
        }
    }

    #[test]
    fn an_input_is_moved_by_shares_of_full_speed() {
        assert_eq!(LIMITS.moved(twist(0.125, 1.0), [0.5, -0.25]), twist(0.375, 0.5));
    }

    #[test]
    fn the_plant_can_do_what_neither_limit_forbids() {
        for (input, can) in [
            (twist(0.5, -2.0), true),
            (twist(-0.5, 2.0), true),
            (twist(0.501, 0.0), false),
            (twist(0.0, -2.001), false),
            (twist(f64::NAN, 0.0), false),
        ] {
            assert_eq!(LIMITS.allow(input), can, "{input:?}");
        }
        assert_eq!(LIMITS.clipped(twist(0.75, -3.0)), twist(0.5, -2.0));
        // A limit of 0 is none.
        let unlimited = Limits { v_max_mps: 0.0, omega_max_radps: 0.0 };
        assert_eq!(unlimited.clipped(twist(0.75, -3.0)), twist(0.75, -3.0));
    }
}
