//! The critical distances of the sets (12), to say which one a switch crossed.

use schemas::{Header, Reason, Step};

use super::track::Critical;

/// b1 and b2 of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sets {
    b1_m: f64,
    b2_m: f64,
}

impl Sets {
    /// Those of the parameters that the run says it had; `None` where they cannot be read.
    pub(super) fn of(header: &Header) -> Option<Sets> {
        let params: toml::Table = header.params_toml.parse().ok()?;
        let of = |key: &str| params.get(key).and_then(toml::Value::as_float);
        let task = header.scenario.task.is_some();
        let (b1, b2) = if task { ("b1_task_m", "b2_task_m") } else { ("b1_free_m", "b2_free_m") };
        Some(Sets { b1_m: of(b1)?, b2_m: of(b2)? })
    }

    /// The critical distance that D has fallen to or below where the step calls that the reason, or has
    /// risen to or above where the person drives: of the requested speed, else of the present one.
    pub(super) fn crossed(self, step: &Step, requested_mps: f64) -> Option<Critical> {
        let d_m = step.distance_effective_m;
        let speeds = [requested_mps, step.v_mps];
        let of = |b_m: f64| speeds.map(|v| Critical { distance_m: critical_m(v, b_m), v_mps: v });
        match step.reason {
            Reason::Danger => of(self.b1_m).into_iter().find(|c| d_m <= c.distance_m),
            Reason::Human => of(self.b2_m).into_iter().find(|c| d_m >= c.distance_m),
            _ => None,
        }
    }
}

/// Dc(v, b) = b² |v| / (1 + b |v|), metres (specification §5).
fn critical_m(v_mps: f64, b_m: f64) -> f64 {
    let speed = libm::fabs(v_mps);
    b_m * b_m * speed / (1.0 + b_m * speed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::{Run, at};

    /// b1 = 1 m and 0.5 m/s: Dc = 0.5/1.5 = 1/3 m; b2 = 2 m: Dc = 2/2 = 1 m.
    #[test]
    fn the_distance_that_was_crossed_is_named() {
        let mut run = Run::new();
        run.header.params_toml = "b1_free_m = 1.0\nb2_free_m = 2.0\n".to_owned();
        let sets = Sets::of(&run.header).expect("has both");
        let crossed = |reason, d_m: f64, v_mps: f64| {
            let mut step = Step::unknown(at(0.0), 0);
            (step.reason, step.distance_effective_m, step.v_mps) = (reason, d_m, v_mps);
            sets.crossed(&step, 0.5)
        };
        let third = Critical { distance_m: 0.5 / 1.5, v_mps: 0.5 };
        assert_eq!(crossed(Reason::Danger, 0.3, 0.0), Some(third));
        assert_eq!(crossed(Reason::Danger, 0.4, 0.0), None);
        // At 1 m/s Dc is 1/2 m.
        let half = Critical { distance_m: 0.5, v_mps: 1.0 };
        assert_eq!(crossed(Reason::Danger, 0.4, 1.0), Some(half));
        let one = Critical { distance_m: 1.0, v_mps: 0.5 };
        assert_eq!(crossed(Reason::Human, 1.5, 0.0), Some(one));
        assert_eq!(crossed(Reason::WouldBeProjected, 0.1, 0.0), None);
        assert_eq!(crossed(Reason::Danger, f64::NAN, 0.0), None);
        run.header.params_toml.clear();
        assert_eq!(Sets::of(&run.header), None);
    }
}
