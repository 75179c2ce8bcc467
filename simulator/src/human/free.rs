//! The person who drives about freely: specification §6, "Free joystick".

use super::{Human, HumanView, Request};
use crate::noise::{Purpose, Stream};

/// Random strokes for as long as the session lasts: each 0.5 to 1 s long, three quarters of them
/// forwards at 0.1 to 0.7 m/s, the rest backwards at up to 0.5 m/s; 40 % straight, the rest turning
/// at up to 1.5 rad/s either way.
pub(super) struct FreeRide {
    noise: Stream,
    strokes: u64,
    end_s: f64,
    asking: Request,
}

impl FreeRide {
    pub(super) fn new(seed: u64) -> FreeRide {
        FreeRide {
            noise: Stream::new(seed, Purpose::FreeRide),
            strokes: 0,
            end_s: 0.0,
            asking: Request::REST,
        }
    }

    fn next_stroke(&mut self) {
        let draw = self.noise.reading(self.strokes);
        self.strokes += 1;
        self.end_s += draw.between(0, 0.5, 1.0);
        self.asking.v_mps = if draw.happens(1, 0.75) {
            draw.between(2, 0.1, 0.7)
        } else {
            draw.between(2, -0.5, 0.0)
        };
        self.asking.omega_radps =
            if draw.happens(3, 0.4) { 0.0 } else { draw.between(4, -1.5, 1.5) };
    }
}

impl Human for FreeRide {
    fn joystick(&mut self, view: &HumanView) -> Option<Request> {
        while self.end_s <= view.t_s {
            self.next_stroke();
        }
        Some(self.asking)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::human::view;
    use schemas::Pose;

    fn ride(seed: u64, seconds: u32) -> Vec<Request> {
        let mut ride = FreeRide::new(seed);
        (0..50 * seconds)
            .map(|i| ride.joystick(&view(f64::from(i) * 0.02, Pose::default())).expect("rides on"))
            .collect()
    }

    /// Ranges, shares and stroke lengths are those of the specification; the bounds on the shares
    /// are five standard deviations of a binomial over the strokes of one hour.
    #[test]
    fn keeps_the_rule_of_the_specification() {
        let requests = ride(1, 3600);
        let mut lengths = Vec::new();
        let mut since = 0;
        let mut strokes = vec![requests[0]];
        for (i, pair) in requests.windows(2).enumerate() {
            if pair[0] != pair[1] {
                lengths.push(i + 1 - since);
                since = i + 1;
                strokes.push(pair[1]);
            }
        }
        // 0.5 s to 1 s on a grid of 0.02 s.
        assert!(lengths.iter().all(|samples| (25..=50).contains(samples)));
        let count = strokes.len() as f64;
        assert!((count - 4800.0).abs() < 100.0, "{count} strokes of 0.75 s on average");
        let share = |of: &dyn Fn(&Request) -> bool| {
            strokes.iter().filter(|stroke| of(stroke)).count() as f64 / count
        };
        let bound = |p: f64| 5.0 * libm::sqrt(p * (1.0 - p) / count);
        assert!((share(&|s| s.v_mps >= 0.1) - 0.75).abs() < bound(0.75));
        assert!((share(&|s| s.omega_radps == 0.0) - 0.4).abs() < bound(0.4));
        assert!(
            strokes
                .iter()
                .all(|s| (0.1..=0.7).contains(&s.v_mps) || (-0.5..=0.0).contains(&s.v_mps))
        );
        assert!(strokes.iter().all(|s| s.omega_radps.abs() <= 1.5));
    }

    #[test]
    fn is_the_same_ride_for_the_same_seed() {
        assert_eq!(ride(5, 20), ride(5, 20));
        assert_ne!(ride(5, 20), ride(6, 20));
    }
}
