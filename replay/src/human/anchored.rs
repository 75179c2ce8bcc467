//! What every model of the person has in common: on the recorded states they do what was recorded.

use std::sync::Arc;

use simulator::{Human, HumanView, Request};

use crate::recording::{Look, Recording, State};

/// A reaction to a state that differs from the recorded one.
pub(crate) trait Model {
    /// What the person asks for, [m/s, rad/s], at that tick in the state `now`, when in the
    /// recording they were in the state `then` and asked for `asked`.
    ///
    /// Called at every tick, so that a model may remember what it saw; where `now` equals `then` its
    /// answer is not used.
    fn ask(&mut self, tick: usize, now: &State, then: &State, asked: [f64; 2]) -> [f64; 2];
}

/// A person by a model, anchored in a recording: where the state is the recorded one, to the last
/// bit, so is the joystick. Where the recording has no sample, there is none here either.
pub(crate) struct Anchored<M> {
    recording: Arc<Recording>,
    look: Look,
    model: M,
}

impl<M> Anchored<M> {
    pub(crate) fn new(recording: Arc<Recording>, model: M) -> Anchored<M> {
        Anchored { look: recording.look(), recording, model }
    }
}

impl<M: Model> Human for Anchored<M> {
    fn joystick(&mut self, view: &HumanView) -> Option<Request> {
        let tick = usize::try_from(view.index).ok()?;
        let moment = self.look.at(tick)?;
        let now = State { pose: view.pose, v_mps: view.v_mps, omega_radps: view.omega_radps };
        let recorded = moment.request?;
        let Some(then) = moment.state else { return Some(recorded) };
        let asked = [recorded.v_mps, recorded.omega_radps];
        let [v_mps, omega_radps] = self.model.ask(tick, &now, &then, asked);
        let usable = v_mps.is_finite() && omega_radps.is_finite();
        // A hand that was off the stick, or off its button, is not put there.
        if now == then || !usable || !recorded.dead_man {
            return Some(recorded);
        }
        let plant = &self.recording.header().scenario.plant;
        let clip = |value: f64, limit: f64| value.clamp(-limit, limit);
        Some(Request {
            v_mps: clip(v_mps, plant.v_max_mps),
            omega_radps: clip(omega_radps, plant.omega_max_radps),
            dead_man: true,
        })
    }
}
