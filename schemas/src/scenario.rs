//! A scenario: world, task, person, robot and sensors of a session, as data.
//!
//! Scenarios are TOML files; the one in force is attached to every log, so that a log can be
//! replayed without anything but itself.

mod check;

use serde::{Deserialize, Serialize};

use crate::{Footprint, Pose, World};

/// Which sensors a simulated session has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SensorSuite {
    /// Exact rays from the true pose: `/exact`.
    Exact,
    /// Sixteen sonars, IMU and encoders: `/sonar`, `/imu`, `/encoders`.
    Sonar,
}

impl SensorSuite {
    /// The name in scenarios and logs.
    pub fn name(self) -> &'static str {
        match self {
            SensorSuite::Exact => "exact",
            SensorSuite::Sonar => "sonar",
        }
    }
}

/// Who steers while a session is recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Driver {
    /// Pursues the task's target.
    Goal,
    /// Plays the scenario's joystick script.
    Script,
    /// Moves the joystick freely and at random.
    Joystick,
    /// Wants to be at places of their own: acts and waits, makes mistakes, backs off when blocked.
    Hesitant,
    /// Wants to be at places of their own: steers as walkers do, around what stands in the way.
    Flowing,
    /// Wants to be nowhere in particular: drives on until something is ahead, then turns away.
    Explorer,
    /// Follows the task's target, or places of their own, with a sluggish hand and lapses.
    Tracker,
}

impl Driver {
    /// The name in scenarios and logs.
    pub fn name(self) -> &'static str {
        match self {
            Driver::Goal => "goal",
            Driver::Script => "script",
            Driver::Joystick => "joystick",
            Driver::Hesitant => "hesitant",
            Driver::Flowing => "flowing",
            Driver::Explorer => "explorer",
            Driver::Tracker => "tracker",
        }
    }
}

/// How a session starts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Start {
    /// Pose in the world frame.
    pub pose: Pose,
    /// Forward speed, m/s.
    #[serde(default)]
    pub v_mps: f64,
    /// Turn rate, rad/s.
    #[serde(default)]
    pub omega_radps: f64,
}

/// The task: a target that moves on a straight line and stops.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Task {
    /// Where the target starts, metres.
    pub from_m: [f64; 2],
    /// Its velocity, m/s.
    pub velocity_mps: [f64; 2],
    /// When it stops, seconds from the start of the session.
    pub until_s: f64,
}

impl Task {
    /// Position (metres) and velocity (m/s) of the target, `t_s` seconds after the start.
    pub fn target(&self, t_s: f64) -> ([f64; 2], [f64; 2]) {
        let moving = t_s < self.until_s;
        let elapsed_s = if moving { t_s } else { self.until_s };
        let position = [
            self.from_m[0] + self.velocity_mps[0] * elapsed_s,
            self.from_m[1] + self.velocity_mps[1] * elapsed_s,
        ];
        (position, if moving { self.velocity_mps } else { [0.0, 0.0] })
    }
}

/// The goal-pursuing person: steers for the point where the target will be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct GoalDriver {
    /// How far ahead in time they look, seconds.
    pub look_ahead_s: f64,
    /// Fastest forward speed they ask for, m/s.
    pub v_cap_mps: f64,
    /// Turn rate asked for per radian of bearing error, 1/s.
    pub k_theta: f64,
}

impl Default for GoalDriver {
    fn default() -> Self {
        GoalDriver { look_ahead_s: 2.0, v_cap_mps: 0.7, k_theta: 1.0 }
    }
}

/// A stretch of constant joystick.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stroke {
    /// Requested forward speed, m/s.
    pub v_mps: f64,
    /// Requested turn rate, rad/s.
    pub omega_radps: f64,
    /// For how long, seconds.
    pub duration_s: f64,
}

/// The person: what each kind of [`Driver`] needs to know.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Person {
    /// For [`Driver::Goal`].
    pub goal: GoalDriver,
    /// For [`Driver::Script`].
    pub script: Vec<Stroke>,
    /// For [`Driver::Joystick`]: which free ride it is.
    pub joystick_seed: u64,
}

/// The robot's body.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Robot {
    /// Its outline.
    pub footprint: Footprint,
    /// Effective distance between left and right wheels, metres.
    pub track_m: f64,
}

impl Default for Robot {
    fn default() -> Self {
        // The paper's footprint and wheel distance (section V).
        Robot { footprint: Footprint { length_m: 0.5, width_m: 0.5 }, track_m: 0.5 }
    }
}

/// What the plant can do, and what it does wrong.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Plant {
    /// Largest forward speed, m/s.
    pub v_max_mps: f64,
    /// Largest turn rate, rad/s.
    pub omega_max_radps: f64,
    /// Largest acceleration, m/s².
    pub accel_max_mps2: f64,
    /// Largest angular acceleration, rad/s².
    pub alpha_max_radps2: f64,
    /// Whether velocity commands too are reached at no more than those accelerations. Without it
    /// a velocity command takes effect at once: the kinematic model (1).
    pub limits_acceleration: bool,
    /// From a command to its first effect, seconds.
    pub actuator_delay_s: f64,
    /// Share of wheel travel lost to slip: the robot moves this much less than its wheels turn.
    pub slip: f64,
}

impl Default for Plant {
    fn default() -> Self {
        Plant {
            v_max_mps: 0.7,
            omega_max_radps: 2.0,
            accel_max_mps2: 2.0,
            alpha_max_radps2: 6.0,
            limits_acceleration: false,
            actuator_delay_s: 0.0,
            slip: 0.0,
        }
    }
}

/// Faults of the sonars.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SonarNoise {
    /// Standard deviation of the range, as a share of it.
    pub range_fraction: f64,
    /// Probability that an echo is not heard.
    pub dropout: f64,
    /// Probability that a reading is some other sonar's echo, at a random shorter range.
    pub cross_talk: f64,
    /// Half the opening of the cone in which a sonar hears, degrees. Its nominal 10° leave a strip of
    /// 5 cm straight ahead unheard, between the inner edges of the two foremost cones; real transducers
    /// hear through their side lobes too.
    pub half_cone_deg: f64,
    /// Faces met at more than this angle from their normal send nothing back, degrees.
    pub incidence_limit_deg: f64,
    /// Probability that a convex corner within 1.2 m echoes although its faces do not.
    pub corner_echo: f64,
    /// Probability that, where only faces beyond the incidence limit are within reach, a false echo
    /// comes back from farther away by a detour.
    pub long_echo: f64,
}

impl Default for SonarNoise {
    fn default() -> Self {
        SonarNoise {
            range_fraction: 0.01,
            dropout: 0.05,
            cross_talk: 0.03,
            half_cone_deg: 12.5,
            incidence_limit_deg: 35.0,
            corner_echo: 0.7,
            long_echo: 0.3,
        }
    }
}

/// Faults of the IMU.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ImuNoise {
    /// Standard deviation of a turn rate, rad/s.
    pub gyro_sigma_radps: f64,
    /// Constant error of the turn rate about z, rad/s.
    pub gyro_bias_radps: f64,
    /// Standard deviation of an acceleration, m/s².
    pub accel_sigma_mps2: f64,
    /// Standard deviation of a magnetic field component, microtesla.
    pub mag_sigma_ut: f64,
    /// From a certain moment on the gyro is wrong by more; absent: it is not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gyro_bias_step: Option<GyroBiasStep>,
}

/// A sudden change of the gyro's constant error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GyroBiasStep {
    /// When, seconds from the start of the session.
    pub at_s: f64,
    /// What is added to the turn rate about z from then on, rad/s.
    pub by_radps: f64,
}

impl Default for ImuNoise {
    fn default() -> Self {
        ImuNoise {
            gyro_sigma_radps: 0.005,
            gyro_bias_radps: 0.01,
            accel_sigma_mps2: 0.05,
            mag_sigma_ut: 0.5,
            gyro_bias_step: None,
        }
    }
}

/// Faults of the encoders.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct EncoderNoise {
    /// Standard deviation of a wheel's speed as a share of it, redrawn at every sample.
    pub speed_fraction: f64,
    /// Length of one encoder tick, metres; 0 for none.
    pub tick_m: f64,
    /// A while in which the wheels spin; absent: they do not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slip_burst: Option<SlipBurst>,
    /// From when on the left counter stands still, seconds from the start; absent: it does not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left_dead_from_s: Option<f64>,
    /// The same of the right counter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub right_dead_from_s: Option<f64>,
}

/// A while in which the wheels turn more than the robot moves, as on a wet spot.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SlipBurst {
    /// When it begins, seconds from the start of the session.
    pub from_s: f64,
    /// When it ends.
    pub until_s: f64,
    /// Share of the wheels' travel that is lost, on top of the plant's slip.
    pub slip: f64,
}

impl Default for EncoderNoise {
    fn default() -> Self {
        EncoderNoise {
            speed_fraction: 0.01,
            tick_m: 0.001,
            slip_burst: None,
            left_dead_from_s: None,
            right_dead_from_s: None,
        }
    }
}

/// The tremor of the hand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct JoystickNoise {
    /// Standard deviation of the requested speed, m/s.
    pub v_sigma_mps: f64,
    /// Standard deviation of the requested turn rate, rad/s.
    pub omega_sigma_radps: f64,
}

/// What is wrong with each sensor; an absent table is a perfect sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Noise {
    /// Sonars; absent: exact nearest hit across the cone, echo at every angle.
    pub sonar: Option<SonarNoise>,
    /// IMU.
    pub imu: Option<ImuNoise>,
    /// Encoders.
    pub encoders: Option<EncoderNoise>,
    /// Joystick.
    pub joystick: Option<JoystickNoise>,
}

/// Controller parameters that belong to the scenario; they apply to every controller alike.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Overrides {
    /// For kinematic laws.
    pub kinematic: toml::Table,
    /// For dynamic laws.
    pub dynamic: toml::Table,
}

/// World, task, person, robot and sensors of a session.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// Short name, as given on the command line.
    pub name: String,
    /// One sentence for a list.
    #[serde(default)]
    pub summary: String,
    /// How long a session lasts unless told otherwise, seconds.
    pub duration_s: f64,
    /// Sensor suite unless told otherwise.
    pub sensors: SensorSuite,
    /// Who drives unless told otherwise.
    pub driver: Driver,
    /// Where and how the robot starts.
    pub start: Start,
    /// The task, where there is one; without it the target is predicted from the joystick.
    #[serde(default)]
    pub task: Option<Task>,
    /// The body.
    #[serde(default)]
    pub robot: Robot,
    /// The plant.
    #[serde(default)]
    pub plant: Plant,
    /// The sensors' faults.
    #[serde(default)]
    pub noise: Noise,
    /// The person.
    #[serde(default)]
    pub person: Person,
    /// Controller parameters that go with the scenario.
    #[serde(default)]
    pub controller: Overrides,
    /// The room.
    #[serde(default)]
    pub world: World,
    /// How much of the room is known, where it was mapped from a log; absent: all of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub explored: Option<crate::Explored>,
}

impl Scenario {
    /// Reads a scenario and checks that its numbers make sense.
    ///
    /// # Errors
    /// The TOML does not parse, has an unknown key, or a value is out of range.
    pub fn from_toml(text: &str) -> Result<Scenario, ScenarioError> {
        let scenario: Scenario = toml::from_str(text)?;
        scenario.check()?;
        Ok(scenario)
    }

    /// The scenario as TOML, such that [`Scenario::from_toml`] gives back an equal one.
    ///
    /// # Panics
    /// Never: every field of a scenario has a TOML form.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).expect("every field of a scenario has a TOML form")
    }
}

/// Why a scenario cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ScenarioError {
    /// Not TOML, or not a scenario's keys.
    #[error(transparent)]
    Toml(#[from] toml::de::Error),
    /// A value out of range.
    #[error("{0}")]
    Value(String),
}
