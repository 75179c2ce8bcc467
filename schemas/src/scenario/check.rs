//! Whether a scenario's numbers make sense: each table's keys with what they may be.

use super::{
    Driver, EncoderNoise, GoalDriver, GyroBiasStep, ImuNoise, JoystickNoise, Noise, Person, Plant,
    Robot, Scenario, ScenarioError, SlipBurst, SonarNoise, Start, Stroke, Task,
};
use crate::{Footprint, Pose};

/// What a number may be.
struct Allowed {
    text: &'static str,
    holds: fn(f64) -> bool,
}

const FINITE: Allowed = Allowed { text: "a finite number", holds: f64::is_finite };
const POSITIVE: Allowed =
    Allowed { text: "more than 0, and finite", holds: |x| x > 0.0 && x.is_finite() };
const NOT_NEGATIVE: Allowed =
    Allowed { text: "0 or more, and finite", holds: |x| x >= 0.0 && x.is_finite() };
/// A limit may be infinite: then there is none.
const LIMIT: Allowed = Allowed { text: "more than 0", holds: |x| x > 0.0 };
const PROBABILITY: Allowed = Allowed { text: "0 to 1", holds: |x| (0.0..=1.0).contains(&x) };
const BELOW_ONE: Allowed =
    Allowed { text: "0 or more, and less than 1", holds: |x| (0.0..1.0).contains(&x) };
const QUARTER_TURN_DEG: Allowed = Allowed { text: "0 to 90", holds: |x| (0.0..=90.0).contains(&x) };

impl Allowed {
    fn check(&self, table: &str, key: &str, value: f64) -> Result<(), ScenarioError> {
        if (self.holds)(value) {
            return Ok(());
        }
        let dot = if table.is_empty() { "" } else { "." };
        Err(ScenarioError::Value(format!("{table}{dot}{key} = {value}: expected {}", self.text)))
    }
}

/// Checks a table whose keys all hold numbers. A key that is missing here does not compile.
macro_rules! check {
    ($at:expr, $table:expr, $type:ident { $($key:ident: $allowed:ident),* $(,)? }) => {{
        let $type { $($key),* } = $table;
        $($allowed.check($at, stringify!($key), *$key)?;)*
    }};
}

impl Scenario {
    /// Checks that the scenario's numbers make sense; [`Scenario::from_toml`] has done so.
    ///
    /// # Errors
    /// A value is out of range, or the driver lacks what it needs.
    pub fn check(&self) -> Result<(), ScenarioError> {
        POSITIVE.check("", "duration_s", self.duration_s)?;
        self.start.check()?;
        if let Some(task) = &self.task {
            task.check()?;
        }
        self.robot.check()?;
        self.plant.check()?;
        self.noise.check()?;
        self.person.check()?;
        self.world.check().map_err(ScenarioError::Value)?;
        if let Some(explored) = &self.explored {
            explored.check().map_err(ScenarioError::Value)?;
        }
        let lacks = |what: &str| Err(ScenarioError::Value(what.to_owned()));
        if self.driver == Driver::Goal && self.task.is_none() {
            return lacks("driver = \"goal\" needs a [task] to pursue");
        }
        if self.driver == Driver::Script && self.person.script.is_empty() {
            return lacks("driver = \"script\" needs [[person.script]] strokes");
        }
        Ok(())
    }
}

impl Start {
    fn check(&self) -> Result<(), ScenarioError> {
        let Start { pose, v_mps, omega_radps } = self;
        check!("start.pose", pose, Pose { x_m: FINITE, y_m: FINITE, theta_rad: FINITE });
        FINITE.check("start", "v_mps", *v_mps)?;
        FINITE.check("start", "omega_radps", *omega_radps)
    }
}

impl Task {
    fn check(&self) -> Result<(), ScenarioError> {
        let Task { from_m, velocity_mps, until_s } = self;
        FINITE.check("task", "from_m[0]", from_m[0])?;
        FINITE.check("task", "from_m[1]", from_m[1])?;
        FINITE.check("task", "velocity_mps[0]", velocity_mps[0])?;
        FINITE.check("task", "velocity_mps[1]", velocity_mps[1])?;
        NOT_NEGATIVE.check("task", "until_s", *until_s)
    }
}

impl Robot {
    fn check(&self) -> Result<(), ScenarioError> {
        let Robot { footprint, track_m } = self;
        check!(
            "robot.footprint",
            footprint,
            Footprint { length_m: NOT_NEGATIVE, width_m: NOT_NEGATIVE }
        );
        POSITIVE.check("robot", "track_m", *track_m)
    }
}

impl Plant {
    fn check(&self) -> Result<(), ScenarioError> {
        let Plant {
            v_max_mps,
            omega_max_radps,
            accel_max_mps2,
            alpha_max_radps2,
            limits_acceleration: _,
            actuator_delay_s,
            slip,
        } = self;
        LIMIT.check("plant", "v_max_mps", *v_max_mps)?;
        LIMIT.check("plant", "omega_max_radps", *omega_max_radps)?;
        LIMIT.check("plant", "accel_max_mps2", *accel_max_mps2)?;
        LIMIT.check("plant", "alpha_max_radps2", *alpha_max_radps2)?;
        NOT_NEGATIVE.check("plant", "actuator_delay_s", *actuator_delay_s)?;
        BELOW_ONE.check("plant", "slip", *slip)
    }
}

impl Noise {
    fn check(&self) -> Result<(), ScenarioError> {
        let Noise { sonar, imu, encoders, joystick } = self;
        if let Some(sonar) = sonar {
            check!(
                "noise.sonar",
                sonar,
                SonarNoise {
                    range_fraction: NOT_NEGATIVE,
                    dropout: PROBABILITY,
                    cross_talk: PROBABILITY,
                    half_cone_deg: QUARTER_TURN_DEG,
                    incidence_limit_deg: QUARTER_TURN_DEG,
                    corner_echo: PROBABILITY,
                    long_echo: PROBABILITY,
                }
            );
        }
        if let Some(imu) = imu {
            imu.check()?;
        }
        if let Some(encoders) = encoders {
            encoders.check()?;
        }
        if let Some(joystick) = joystick {
            check!(
                "noise.joystick",
                joystick,
                JoystickNoise { v_sigma_mps: NOT_NEGATIVE, omega_sigma_radps: NOT_NEGATIVE }
            );
        }
        Ok(())
    }
}

impl ImuNoise {
    fn check(&self) -> Result<(), ScenarioError> {
        let ImuNoise {
            gyro_sigma_radps,
            gyro_bias_radps,
            accel_sigma_mps2,
            mag_sigma_ut,
            gyro_bias_step,
        } = self;
        NOT_NEGATIVE.check("noise.imu", "gyro_sigma_radps", *gyro_sigma_radps)?;
        FINITE.check("noise.imu", "gyro_bias_radps", *gyro_bias_radps)?;
        NOT_NEGATIVE.check("noise.imu", "accel_sigma_mps2", *accel_sigma_mps2)?;
        NOT_NEGATIVE.check("noise.imu", "mag_sigma_ut", *mag_sigma_ut)?;
        if let Some(step) = gyro_bias_step {
            check!(
                "noise.imu.gyro_bias_step",
                step,
                GyroBiasStep { at_s: NOT_NEGATIVE, by_radps: FINITE }
            );
        }
        Ok(())
    }
}

impl EncoderNoise {
    fn check(&self) -> Result<(), ScenarioError> {
        let EncoderNoise {
            speed_fraction,
            tick_m,
            slip_burst,
            left_dead_from_s,
            right_dead_from_s,
        } = self;
        NOT_NEGATIVE.check("noise.encoders", "speed_fraction", *speed_fraction)?;
        NOT_NEGATIVE.check("noise.encoders", "tick_m", *tick_m)?;
        if let Some(burst) = slip_burst {
            check!(
                "noise.encoders.slip_burst",
                burst,
                SlipBurst { from_s: NOT_NEGATIVE, until_s: NOT_NEGATIVE, slip: BELOW_ONE }
            );
        }
        for (key, from_s) in
            [("left_dead_from_s", left_dead_from_s), ("right_dead_from_s", right_dead_from_s)]
        {
            if let Some(from_s) = from_s {
                NOT_NEGATIVE.check("noise.encoders", key, *from_s)?;
            }
        }
        Ok(())
    }
}

impl Person {
    fn check(&self) -> Result<(), ScenarioError> {
        let Person { goal, script, joystick_seed: _ } = self;
        check!(
            "person.goal",
            goal,
            GoalDriver { look_ahead_s: POSITIVE, v_cap_mps: NOT_NEGATIVE, k_theta: NOT_NEGATIVE }
        );
        for (i, stroke) in script.iter().enumerate() {
            check!(
                &format!("person.script[{i}]"),
                stroke,
                Stroke { v_mps: FINITE, omega_radps: FINITE, duration_s: POSITIVE }
            );
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A scenario that says no more than it must.
    const MINIMAL: &str = r#"
        name = "minimal"
        duration_s = 1.0
        sensors = "sonar"
        driver = "goal"

        [start]
        pose = { x_m = 0.25, y_m = 0.35, theta_rad = 0.3562 }

        [task]
        from_m = [0.25, 0.35]
        velocity_mps = [0.43, 0.16]
        until_s = 0.0

        [noise.sonar]
        [noise.imu]
        gyro_bias_step = { at_s = 10.0, by_radps = -0.05 }
        [noise.encoders]
        slip_burst = { from_s = 3.0, until_s = 3.5, slip = 0.3 }
        left_dead_from_s = 20.0
        right_dead_from_s = 30.0
        [noise.joystick]

        [[person.script]]
        v_mps = 0.4
        omega_radps = -0.1
        duration_s = 2.0
    "#;

    /// The scenario with one number in another's place, and what is said to it.
    fn answer(key: &str, value: f64) -> Option<String> {
        let scenario = Scenario::from_toml(MINIMAL).expect("a scenario");
        let mut whole = toml::Value::try_from(scenario).expect("every field has a TOML form");
        let mut place = &mut whole;
        for part in key.split(['.', '[', ']']).filter(|part| !part.is_empty()) {
            place = match part.parse::<usize>() {
                Ok(index) => &mut place[index],
                Err(_) => &mut place[part],
            };
        }
        assert!(place.is_float(), "{key} is no number");
        *place = toml::Value::Float(value);
        let text = toml::to_string(&whole).expect("a table");
        Scenario::from_toml(&text).err().map(|error| error.to_string())
    }

    #[test]
    fn a_minimal_scenario_passes() {
        assert!(Scenario::from_toml(MINIMAL).is_ok());
    }

    // The contract: each number has a range; outside of it the scenario is refused, and the error
    // names key, value and range; the ends that belong to the range are taken.
    #[test]
    fn every_number_out_of_range_is_refused_by_name() {
        let (nan, infinite) = (f64::NAN, f64::INFINITY);
        let finite = ("a finite number", vec![nan, infinite, -infinite], vec![-1.0, 0.0]);
        let positive =
            ("more than 0, and finite", vec![nan, infinite, 0.0, -1.0], vec![f64::MIN_POSITIVE]);
        let not_negative = ("0 or more, and finite", vec![nan, infinite, -0.1], vec![0.0, 1.5]);
        let limit = ("more than 0", vec![nan, 0.0, -1.0], vec![0.1, infinite]);
        let probability = ("0 to 1", vec![nan, infinite, -0.1, 1.1], vec![0.0, 1.0]);
        let below_one = ("0 or more, and less than 1", vec![nan, -0.1, 1.0], vec![0.0, 0.99]);
        let angle = ("0 to 90", vec![nan, infinite, -0.1, 90.1], vec![0.0, 90.0]);
        for (key, (range, refused, taken)) in [
            ("duration_s", &positive),
            ("start.pose.x_m", &finite),
            ("start.pose.y_m", &finite),
            ("start.pose.theta_rad", &finite),
            ("start.v_mps", &finite),
            ("start.omega_radps", &finite),
            ("task.from_m[0]", &finite),
            ("task.from_m[1]", &finite),
            ("task.velocity_mps[0]", &finite),
            ("task.velocity_mps[1]", &finite),
            ("task.until_s", &not_negative),
            ("robot.footprint.length_m", &not_negative),
            ("robot.footprint.width_m", &not_negative),
            ("robot.track_m", &positive),
            ("plant.v_max_mps", &limit),
            ("plant.omega_max_radps", &limit),
            ("plant.accel_max_mps2", &limit),
            ("plant.alpha_max_radps2", &limit),
            ("plant.actuator_delay_s", &not_negative),
            ("plant.slip", &below_one),
            ("noise.sonar.range_fraction", &not_negative),
            ("noise.sonar.dropout", &probability),
            ("noise.sonar.cross_talk", &probability),
            ("noise.sonar.half_cone_deg", &angle),
            ("noise.sonar.incidence_limit_deg", &angle),
            ("noise.sonar.corner_echo", &probability),
            ("noise.sonar.long_echo", &probability),
            ("noise.imu.gyro_sigma_radps", &not_negative),
            ("noise.imu.gyro_bias_radps", &finite),
            ("noise.imu.accel_sigma_mps2", &not_negative),
            ("noise.imu.mag_sigma_ut", &not_negative),
            ("noise.imu.gyro_bias_step.at_s", &not_negative),
            ("noise.imu.gyro_bias_step.by_radps", &finite),
            ("noise.encoders.speed_fraction", &not_negative),
            ("noise.encoders.tick_m", &not_negative),
            ("noise.encoders.slip_burst.from_s", &not_negative),
            ("noise.encoders.slip_burst.until_s", &not_negative),
            ("noise.encoders.slip_burst.slip", &below_one),
            ("noise.encoders.left_dead_from_s", &not_negative),
            ("noise.encoders.right_dead_from_s", &not_negative),
            ("noise.joystick.v_sigma_mps", &not_negative),
            ("noise.joystick.omega_sigma_radps", &not_negative),
            ("person.goal.look_ahead_s", &positive),
            ("person.goal.v_cap_mps", &not_negative),
            ("person.goal.k_theta", &not_negative),
            ("person.script[0].v_mps", &finite),
            ("person.script[0].omega_radps", &finite),
            ("person.script[0].duration_s", &positive),
        ] {
            for value in refused {
                assert_eq!(answer(key, *value), Some(format!("{key} = {value}: expected {range}")));
            }
            for value in taken {
                assert_eq!(answer(key, *value), None, "{key} = {value}");
            }
        }
    }
}
