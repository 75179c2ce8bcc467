//! People who steer: what they see, what they ask for, and the scripted ones.
//!
//! A person is asked for their joystick fifty times a second. The scripted people stand here; a
//! recorded person brought back in closed loop implements the same trait elsewhere.

mod explorer;
mod flowing;
mod free;
mod goal;
mod hesitant;
mod mood;
#[cfg(test)]
mod reactive_tests;
mod script;
mod tracker;
mod tremor;

use schemas::{Driver, Pose, Scenario, Time, wrap};

use crate::SimulatorError;

/// Someone with a joystick.
pub trait Human {
    /// What they ask for now; `None` where the joystick sends nothing.
    fn joystick(&mut self, view: &HumanView) -> Option<Request>;
}

/// What a person sees: the truth, since they look at the robot themselves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HumanView {
    /// Seconds since the start of the session.
    pub t_s: f64,
    /// The instant, as the joystick sample will carry it.
    pub stamp: Time,
    /// Number of the joystick sample, from 0.
    pub index: u64,
    /// True pose of the robot, world frame.
    pub pose: Pose,
    /// True forward speed, m/s.
    pub v_mps: f64,
    /// True turn rate, rad/s.
    pub omega_radps: f64,
}

/// What a person asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Request {
    /// Forward speed, m/s.
    pub v_mps: f64,
    /// Turn rate, rad/s.
    pub omega_radps: f64,
    /// Whether the dead-man button is held.
    pub dead_man: bool,
}

impl Request {
    /// Hands off the stick, the button held.
    pub(crate) const REST: Request = Request { v_mps: 0.0, omega_radps: 0.0, dead_man: true };
}

/// The scripted person of a scenario, with the tremor that the scenario's noise gives them; `seed`
/// is the noise seed.
///
/// # Errors
/// The scenario does not describe such a driver: no task to pursue, no script to play.
pub fn driver(
    scenario: &Scenario,
    driver: Driver,
    seed: u64,
) -> Result<Box<dyn Human>, SimulatorError> {
    let person = &scenario.person;
    let lacks = |driver, missing| SimulatorError::Driver {
        scenario: scenario.name.clone(),
        driver,
        missing,
    };
    let steady: Box<dyn Human> = match driver {
        Driver::Goal => {
            let task = scenario.task.ok_or_else(|| lacks("goal", "[task]"))?;
            Box::new(goal::Pursuit::new(task, person.goal))
        }
        Driver::Script => {
            if person.script.is_empty() {
                return Err(lacks("script", "[[person.script]]"));
            }
            Box::new(script::Script::new(&person.script))
        }
        Driver::Joystick => Box::new(free::FreeRide::new(person.joystick_seed)),
        Driver::Hesitant => Box::new(hesitant::Hesitant::new(scenario)),
        Driver::Flowing => Box::new(flowing::Flowing::new(scenario)),
        Driver::Explorer => Box::new(explorer::Explorer::new(scenario)),
        Driver::Tracker => Box::new(tracker::Tracker::new(scenario)),
    };
    Ok(match scenario.noise.joystick {
        None => steady,
        Some(noise) => Box::new(tremor::Tremor::new(steady, noise, seed)),
    })
}

#[cfg(test)]
pub(crate) fn view(t_s: f64, pose: Pose) -> HumanView {
    HumanView {
        t_s,
        stamp: schemas::SIMULATION_EPOCH + schemas::Span::from_seconds(t_s),
        index: (t_s / 0.02) as u64,
        pose,
        v_mps: 0.0,
        omega_radps: 0.0,
    }
}
