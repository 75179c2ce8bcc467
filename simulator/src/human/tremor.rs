//! The tremor of a hand that holds a stick.

use schemas::JoystickNoise;

use super::{Human, HumanView, Request};
use crate::noise::{Purpose, Stream};

/// Another person, with a tremor. A stick at rest does not tremble: nobody holds it.
pub(super) struct Tremor {
    steady: Box<dyn Human>,
    noise: JoystickNoise,
    stream: Stream,
}

impl Tremor {
    pub(super) fn new(steady: Box<dyn Human>, noise: JoystickNoise, seed: u64) -> Tremor {
        Tremor { steady, noise, stream: Stream::new(seed, Purpose::Tremor) }
    }
}

impl Human for Tremor {
    fn joystick(&mut self, view: &HumanView) -> Option<Request> {
        let mut request = self.steady.joystick(view)?;
        if request.v_mps != 0.0 || request.omega_radps != 0.0 {
            let [v, omega] = self.stream.reading(view.index).normals(0);
            request.v_mps += self.noise.v_sigma_mps * v;
            request.omega_radps += self.noise.omega_sigma_radps * omega;
        }
        Some(request)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::human::{script::Script, view};
    use schemas::{Pose, Stroke};

    /// Adds noise of the given size while the stick is held, and none when it is not.
    #[test]
    fn trembles_only_while_the_stick_is_held() {
        let stroke = Stroke { v_mps: 0.3, omega_radps: 0.0, duration_s: 100.0 };
        let noise = JoystickNoise { v_sigma_mps: 0.01, omega_sigma_radps: 0.02 };
        let mut hand = Tremor::new(Box::new(Script::new(&[stroke])), noise, 3);
        let mut ask = |i: u32| {
            hand.joystick(&view(f64::from(i) * 0.02, Pose::default())).expect("a script plays on")
        };
        let squares = (0..5000).map(&mut ask).fold([0.0; 2], |sum, request| {
            let v = request.v_mps - 0.3;
            [sum[0] + v * v, sum[1] + request.omega_radps * request.omega_radps]
        });
        // Five standard errors of a variance over 5000 draws: 10 %.
        assert!((squares[0] / 5000.0 / 1e-4 - 1.0).abs() < 0.1);
        assert!((squares[1] / 5000.0 / 4e-4 - 1.0).abs() < 0.1);
        assert_eq!(ask(6000), Request::REST);
    }
}
