//! When the person drives again after the feedback law has: not at every flicker of a distance.
//!
//! Beside the sets (12), and only ever in favour of k = 0, so that nothing that holds for the sets is
//! lost.

use schemas::Plant;

use super::Switch;
use crate::digest::Digest;

/// A request that differs by more than this share of full speed, in either component, from the one that
/// the feedback law took over from is another request. Chosen: well above a tremor.
const ANOTHER_SHARE: f64 = 0.25;

/// Whether a request, [m/s, rad/s], is another one than `before`.
pub fn another_request(request: [f64; 2], before: [f64; 2], plant: &Plant) -> bool {
    let full = [plant.v_max_mps, plant.omega_max_radps];
    (0..2).any(|i| libm::fabs(request[i] - before[i]) > ANOTHER_SHARE * full[i])
}

/// What must have passed before k = 1 comes back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patience {
    /// How long it must have been possible without a break, seconds.
    pub grant_s: f64,
    /// How long k = 0 lasts at least, seconds.
    pub dwell_s: f64,
    /// The control period, seconds.
    pub period_s: f64,
}

/// What has passed since k fell to 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wait {
    /// Steps at k = 0.
    engaged: u32,
    /// Steps at which k = 1 has been possible without a break.
    possible: u32,
}

impl Wait {
    /// Whether k stays 0 although the sets would have made 1 of it: `before` and `after` are the switch
    /// as it was and as the sets leave it. The first time of all, and for another request, nothing is
    /// waited for.
    pub fn holds(
        &mut self,
        before: Switch,
        after: Switch,
        another: bool,
        patience: &Patience,
    ) -> bool {
        if before.human || !before.seen_safe {
            *self = Wait::default();
            return false;
        }
        let passed = |steps: u32, least_s: f64| {
            // Times that are multiples of the period compare up to their rounding.
            f64::from(steps) * patience.period_s >= least_s - 1e-9
        };
        self.engaged = self.engaged.saturating_add(1);
        if !after.human {
            self.possible = 0;
            return false;
        }
        let ripe =
            passed(self.possible, patience.grant_s) && passed(self.engaged, patience.dwell_s);
        let waits = !(another || ripe);
        self.possible = self.possible.saturating_add(1);
        waits
    }

    pub(crate) fn fold(self, digest: &mut Digest) {
        digest.word(u64::from(self.engaged) << 32 | u64::from(self.possible));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: Switch = Switch { human: false, seen_safe: true };
    const PERSON: Switch = Switch { human: true, seen_safe: true };

    /// Steps of 0.1 s from k = 0 until k = 1, which is possible at every step but those listed.
    fn steps(patience: &Patience, not_at: &[usize], another: bool) -> usize {
        let mut wait = Wait::default();
        (0..1000)
            .find(|step| {
                let possible = !not_at.contains(step);
                let after = if possible { PERSON } else { LAW };
                !wait.holds(LAW, after, another, patience) && possible
            })
            .unwrap_or(1000)
    }

    fn patience(grant_s: f64, dwell_s: f64) -> Patience {
        Patience { grant_s, dwell_s, period_s: 0.1 }
    }

    #[test]
    fn k_comes_back_when_it_could_have_for_a_while() {
        assert_eq!(steps(&patience(0.0, 0.0), &[], false), 0);
        assert_eq!(steps(&patience(0.2, 0.0), &[], false), 2);
        assert_eq!(steps(&patience(0.2, 0.0), &[1], false), 4, "a break starts it again");
        // k fell to 0 one step before the first of these.
        assert_eq!(steps(&patience(0.0, 0.5), &[], false), 4);
        assert_eq!(steps(&patience(0.0, 0.5), &[0, 1, 2], false), 4);
        assert_eq!(steps(&patience(0.3, 0.5), &[3], false), 7);
    }

    #[test]
    fn another_request_does_not_wait() {
        assert_eq!(steps(&patience(5.0, 5.0), &[0, 1], true), 2);
        let plant = Plant::default();
        let (v, omega) = (plant.v_max_mps, plant.omega_max_radps);
        assert!(!another_request([0.3 * v, 0.2 * omega], [0.1 * v, 0.0], &plant));
        assert!(another_request([-0.2 * v, 0.0], [0.1 * v, 0.0], &plant));
        assert!(another_request([0.0, 0.3 * omega], [0.0, 0.0], &plant));
    }

    #[test]
    fn the_first_time_nothing_is_waited_for() {
        let unseen = Switch::default();
        let mut wait = Wait::default();
        assert!(!wait.holds(unseen, PERSON, false, &patience(5.0, 5.0)));
        assert!(!wait.holds(PERSON, PERSON, false, &patience(5.0, 5.0)));
    }
}
