//! What the sonars heard last, to say what a switch came from.

use std::collections::VecDeque;

use schemas::{SONARS, SonarScan, Time};

/// An echo older than this says nothing any more, seconds (specification §10).
const FRESH_S: f64 = 0.5;

/// Most echoes that are remembered: 40 a second for longer than a map remembers most of them.
const MOST: usize = 4096;

/// The newest reading of each sonar, and what was heard before.
#[derive(Clone, Debug, Default)]
pub(super) struct Echoes {
    /// When it fired, seconds from the start, and its range; `None` where nothing came back.
    last: [Option<(f64, f64)>; SONARS.len()],
    /// The same with the sonar, the newest last.
    before: VecDeque<(f64, f64, u8)>,
}

impl Echoes {
    pub(super) fn scan(&mut self, scan: &SonarScan, start: Time) {
        for echo in &scan.echoes {
            if let Some(last) = self.last.get_mut(usize::from(echo.id)) {
                let heard = echo.echo && echo.range_m.is_finite();
                let fired_s = echo.fired.seconds_since(start);
                *last = heard.then_some((fired_s, echo.range_m));
                if heard {
                    self.before.push_back((fired_s, echo.range_m, echo.id));
                }
                if self.before.len() > MOST {
                    self.before.pop_front();
                }
            }
        }
    }

    /// The sonar that heard the nearest echo of late, and its range, metres.
    pub(super) fn nearest(&self, t_s: f64) -> Option<(u8, f64)> {
        let fresh = self.last.iter().zip(0_u8..).filter_map(|(last, id)| {
            let (fired_s, range_m) = (*last)?;
            (t_s - fired_s <= FRESH_S).then_some((id, range_m))
        });
        fresh.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The sonar that fired then and heard something at that range, with the range: two fire at once,
    /// and the range tells them apart. A range of 0 is contact, which says nothing of what was heard.
    pub(super) fn heard(&self, fired_s: f64, range_m: f64) -> Option<(u8, f64)> {
        let is_it =
            |heard: &&(f64, f64, u8)| heard.0 == fired_s && (heard.1 == range_m || range_m == 0.0);
        self.before.iter().rev().find(is_it).map(|(_, range_m, id)| (*id, *range_m))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::at;
    use schemas::{SIMULATION_EPOCH, SonarEcho};

    #[test]
    fn the_nearest_fresh_echo_is_named() {
        let mut echoes = Echoes::default();
        let mut heard = |t_s: f64, id: u8, range_m: f64, echo: bool| {
            let echoes_now = vec![SonarEcho { id, range_m, echo, fired: at(t_s) }];
            let scan = SonarScan { stamp: at(t_s), echoes: echoes_now };
            echoes.scan(&scan, SIMULATION_EPOCH);
        };
        heard(0.0, 3, 0.3, true);
        heard(0.2, 4, 0.5, true);
        heard(0.2, 200, 0.1, true);
        heard(0.3, 5, 5.0, false);
        assert_eq!(echoes.nearest(0.4), Some((3, 0.3)));
        // Sonar 3 has not been heard for more than half a second.
        assert_eq!(echoes.nearest(0.6), Some((4, 0.5)));
        assert_eq!(echoes.nearest(2.0), None);
        assert_eq!(echoes.heard(0.0, 0.3), Some((3, 0.3)));
        assert_eq!(echoes.heard(0.0, 0.5), None);
        // Silence and nonsense are no echoes, and are not remembered as such.
        assert_eq!(echoes.heard(0.3, 5.0), None);
        let nonsense = SonarEcho { id: 3, range_m: f64::NAN, echo: true, fired: at(0.4) };
        let scan = SonarScan { stamp: at(0.4), echoes: vec![nonsense] };
        echoes.scan(&scan, SIMULATION_EPOCH);
        assert_eq!(echoes.heard(0.4, 0.0), None);
        assert_eq!(echoes.before.len(), 2);
    }

    #[test]
    fn only_so_many_are_remembered() {
        let mut echoes = Echoes::default();
        for i in 0..=MOST {
            let echo = SonarEcho { id: 0, range_m: 1.0, echo: true, fired: at(i as f64) };
            echoes.scan(&SonarScan { stamp: echo.fired, echoes: vec![echo] }, SIMULATION_EPOCH);
            assert_eq!(echoes.before.len(), (i + 1).min(MOST));
        }
        assert_eq!((echoes.heard(0.0, 1.0), echoes.heard(1.0, 1.0)), (None, Some((0, 1.0))));
    }
}
