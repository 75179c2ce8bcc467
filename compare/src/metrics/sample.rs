//! What the metrics see of a run: how the robot moved, and what the controller decided.

use schemas::{Disc, Footprint, Plant, Pose, Scenario, Task, Twist, World};

/// The longest that one motion sample stands for what follows it, seconds: the age at which a
/// distance counts as unknown (specification §10). A hole in the record is not filled any further.
pub(super) const MOTION_HOLD_LIMIT_S: f64 = 0.5;

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
