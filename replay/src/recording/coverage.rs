//! Where the recorded sonars have seen, as a grid about the start.

use schemas::{Pose, SONARS, SonarEcho, SonarScan};

/// Edge of a cell, metres.
const CELL_M: f64 = 0.1;

/// Cells from the middle of the grid to its edge: 25.6 m. What lies beyond counts as never seen.
const HALF: i32 = 256;

const SIDE: usize = 2 * HALF as usize;

/// How far to either side of its axis a sonar is taken to see, degrees: half of the narrow core of
/// its cone, since an echo does not say where in the cone it came from.
const CORE_DEG: f64 = 7.5;

/// The cells in which some recorded beam passed or ended.
#[derive(Clone, Debug)]
pub(crate) struct Coverage {
    /// One bit a cell, row by row.
    seen: Vec<u64>,
    /// The middle of the grid, metres: where the first beam came from.
    middle_m: Option<[f64; 2]>,
}

impl Default for Coverage {
    fn default() -> Self {
        Coverage { seen: vec![0; SIDE * SIDE / 64], middle_m: None }
    }
}

impl Coverage {
    /// Notes what a scan from that pose has seen. A sonar that heard nothing has seen nothing: faces
    /// at a slant are silent however near.
    pub(super) fn see(&mut self, pose: &Pose, scan: &SonarScan) {
        let middle_m = *self.middle_m.get_or_insert(pose.position_m());
        for echo in scan.echoes.iter().filter(|echo| echo.echo && echo.range_m.is_finite()) {
            for aside_deg in [-CORE_DEG, 0.0, CORE_DEG] {
                let Some((from_m, along)) = beam(pose, echo, aside_deg) else { continue };
                // Half a cell at a time, so that no cell on the way is jumped over by much; one cell
                // more for the thickness of what echoed.
                let steps = libm::ceil((echo.range_m.min(10.0) + CELL_M) / (0.5 * CELL_M)) as u32;
                for step in 0..=steps {
                    let way_m = f64::from(step) * 0.5 * CELL_M;
                    let at_m = [from_m[0] + way_m * along[0], from_m[1] + way_m * along[1]];
                    if let Some(cell) = cell(middle_m, at_m) {
                        self.seen[cell / 64] |= 1 << (cell % 64);
                    }
                }
            }
        }
    }

    /// Whether an echo heard from that pose came from where a recorded beam has been; `None` for a
    /// sonar that heard nothing.
    pub(crate) fn knows(&self, pose: &Pose, echo: &SonarEcho) -> Option<bool> {
        if !echo.echo || !echo.range_m.is_finite() {
            return None;
        }
        let (from_m, along) = beam(pose, echo, 0.0)?;
        let at_m = [from_m[0] + echo.range_m * along[0], from_m[1] + echo.range_m * along[1]];
        Some(self.middle_m.and_then(|middle_m| cell(middle_m, at_m)).is_some_and(|cell| {
            // One cell of tolerance: a range is about 1 % uncertain.
            let (row, column) = (cell / SIDE, cell % SIDE);
            let near = |i: usize| i.saturating_sub(1)..=(i + 1).min(SIDE - 1);
            near(row).any(|row| near(column).any(|column| self.has(row * SIDE + column)))
        }))
    }

    fn has(&self, cell: usize) -> bool {
        self.seen[cell / 64] >> (cell % 64) & 1 == 1
    }
}

/// Where a sonar's beam starts and which way it goes; `None` for a sonar that the robot lacks.
fn beam(pose: &Pose, echo: &SonarEcho, aside_deg: f64) -> Option<([f64; 2], [f64; 2])> {
    let mount = SONARS.get(usize::from(echo.id))?;
    let angle_rad = pose.theta_rad + (mount.bearing_deg + aside_deg).to_radians();
    let (sin, cos) = libm::sincos(angle_rad);
    Some((pose.transform(mount.x_m, mount.y_m), [cos, sin]))
}

fn cell(middle_m: [f64; 2], at_m: [f64; 2]) -> Option<usize> {
    const EDGE: f64 = HALF as f64;
    let index = |axis: usize| {
        let cells = (at_m[axis] - middle_m[axis]) / CELL_M;
        if !(-EDGE..EDGE).contains(&cells) {
            return None;
        }
        // Rounded down: a cast goes towards zero.
        let whole = cells as i32;
        Some((whole - i32::from(f64::from(whole) > cells) + HALF) as usize)
    };
    Some(index(1)? * SIDE + index(0)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use schemas::Time;

    fn echo(id: u8, range_m: f64) -> SonarEcho {
        SonarEcho { id, range_m, echo: range_m.is_finite(), fired: Time(0) }
    }

    /// A cell holds its lower edge and not its upper, on both sides of the middle; beyond the grid, and
    /// nowhere, there are none.
    #[test]
    fn cells_are_rounded_down() {
        let column = |x_m: f64| cell([0.0; 2], [x_m, 0.0]).map(|cell| cell % SIDE);
        for (x_m, want) in [
            (0.0, Some(256)),
            (-0.0, Some(256)),
            (0.099, Some(256)),
            (0.1, Some(257)),
            (-0.001, Some(255)),
            (-0.1, Some(255)),
            (-0.101, Some(254)),
            (-1e-300, Some(255)),
            (25.599, Some(511)),
            (25.6, None),
            (-25.6, Some(0)),
            (-25.601, None),
            (f64::NAN, None),
            (f64::INFINITY, None),
            (-1e300, None),
        ] {
            assert_eq!(column(x_m), want, "{x_m}");
        }
    }

    /// Sonar 3 looks ahead, 10 degrees to the left: what it saw is known from elsewhere too, what
    /// lies beyond, aside or behind is not, and silence says nothing.
    #[test]
    fn a_place_is_known_once_a_beam_has_been_there() {
        let mut coverage = Coverage::default();
        let home = Pose::default();
        coverage.see(&home, &SonarScan { stamp: Time(0), echoes: vec![echo(3, 2.0)] });
        assert_eq!(coverage.knows(&home, &echo(3, 2.0)), Some(true));
        assert_eq!(coverage.knows(&home, &echo(3, 1.0)), Some(true));
        assert_eq!(coverage.knows(&home, &echo(3, 3.0)), Some(false));
        assert_eq!(coverage.knows(&home, &echo(7, 1.0)), Some(false));
        assert_eq!(coverage.knows(&home, &echo(3, f64::NAN)), None);
        assert_eq!(coverage.knows(&home, &echo(16, 1.0)), None);
        // One metre further on the same wall is one metre nearer.
        let on = Pose {
            x_m: libm::cos(10_f64.to_radians()),
            y_m: libm::sin(10_f64.to_radians()),
            theta_rad: 0.0,
        };
        assert_eq!(coverage.knows(&on, &echo(3, 1.0)), Some(true));
        assert_eq!(coverage.knows(&Pose { x_m: 99.0, ..home }, &echo(3, 1.0)), Some(false));
    }
}
