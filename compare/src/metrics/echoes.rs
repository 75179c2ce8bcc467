//! What the sonars heard last, to say what a switch came from.

use schemas::{SONARS, SonarScan, Time};

/// An echo older than this says nothing any more, seconds (specification §10).
const FRESH_S: f64 = 0.5;

/// The newest reading of each sonar.
#[derive(Clone, Debug, Default)]
pub(super) struct Echoes {
    /// When it fired, seconds from the start, and its range; `None` where nothing came back.
    last: [Option<(f64, f64)>; SONARS.len()],
}

impl Echoes {
    pub(super) fn scan(&mut self, scan: &SonarScan, start: Time) {
        for echo in &scan.echoes {
            if let Some(last) = self.last.get_mut(usize::from(echo.id)) {
                let heard = echo.echo && echo.range_m.is_finite();
                *last = heard.then(|| (echo.fired.seconds_since(start), echo.range_m));
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
    }
}
