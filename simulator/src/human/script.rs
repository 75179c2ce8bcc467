//! The person who plays a joystick script.

use schemas::Stroke;

use super::{Human, HumanView, Request};

/// Strokes one after the other, then hands off.
pub(super) struct Script {
    /// Each stroke with the time at which it ends, seconds from the start.
    strokes: Vec<(f64, Stroke)>,
}

impl Script {
    pub(super) fn new(strokes: &[Stroke]) -> Script {
        let mut end_s = 0.0;
        let strokes = strokes
            .iter()
            .map(|stroke| {
                end_s += stroke.duration_s;
                (end_s, *stroke)
            })
            .collect();
        Script { strokes }
    }
}

impl Human for Script {
    fn joystick(&mut self, view: &HumanView) -> Option<Request> {
        let playing = self.strokes.iter().find(|(end_s, _)| view.t_s < *end_s);
        Some(playing.map_or(Request::REST, |(_, stroke)| Request {
            v_mps: stroke.v_mps,
            omega_radps: stroke.omega_radps,
            dead_man: true,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::human::view;
    use schemas::Pose;

    /// A stroke holds from its start, and no longer than until its end.
    #[test]
    fn strokes_follow_each_other() {
        let stroke = |v_mps, duration_s| Stroke { v_mps, omega_radps: -v_mps, duration_s };
        let mut script = Script::new(&[stroke(0.1, 2.0), stroke(0.2, 1.0)]);
        let mut v_mps = |t_s| {
            let request = script.joystick(&view(t_s, Pose::default())).expect("a script plays on");
            assert_eq!(request.omega_radps, -request.v_mps);
            request.v_mps
        };
        assert_eq!(
            [0.0, 1.98, 2.0, 2.98, 3.0, 50.0].map(&mut v_mps),
            [0.1, 0.1, 0.2, 0.2, 0.0, 0.0]
        );
    }
}
