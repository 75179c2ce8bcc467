//! The numbers behind the drawings of one arm, for the page's script: what stands where at a time.
//!
//! Rows of integers, so that a page with a hundred logs stays small: time in ms, x and y in mm,
//! heading in mrad, k, requested and commanded speed in mm/s and turn rate in mrad/s, clearance and D
//! in mm; the Lyapunov function in three digits. What is not known is left empty.

use std::fmt::Write;

use crate::metrics::{Track, TrackPoint};

/// The columns of a row, in order, as the page's script knows them.
const COLUMNS: [fn(&TrackPoint) -> f64; 11] = [
    |p| p.t_s,
    |p| p.x_m,
    |p| p.y_m,
    |p| p.theta_rad,
    |p| p.k / 1000.0,
    |p| p.v_h_mps,
    |p| p.v_s_mps,
    |p| p.omega_h_radps,
    |p| p.omega_s_radps,
    |p| p.clearance_m,
    |p| p.distance_human_m,
];

/// Rows separated by semicolons, cells by commas; at most `points` rows, and the last point.
pub(super) fn samples(track: &Track, points: usize) -> String {
    let mut text = String::new();
    for (i, point) in track.thinned(points).into_iter().enumerate() {
        if i > 0 {
            text.push(';');
        }
        for of in COLUMNS {
            let thousandths = libm::round(of(point) * 1000.0);
            if thousandths.is_finite() {
                // Adding zero takes −0 to 0; writing to a String cannot fail.
                let _ = write!(text, "{}", thousandths + 0.0);
            }
            text.push(',');
        }
        if point.lyapunov.is_finite() {
            let _ = write!(text, "{:.2e}", point.lyapunov);
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::Run;

    #[test]
    fn a_row_says_what_a_point_says() {
        let mut run = Run::new();
        run.step(0.0, |step| {
            step.pose = schemas::Pose { x_m: 1.2344, y_m: -0.5, theta_rad: -0.0 };
            step.distance_human_m = f64::INFINITY;
            step.lyapunov = 0.012_345;
        });
        run.command(0.0, 0.25, -1.5);
        run.step(0.1, |step| step.k = 0.0).command(0.1, 0.0, 0.0);
        let rows = samples(&run.measured().track, 100);
        let rows: Vec<&str> = rows.split(';').collect();
        // Clearance is that of the world, since the run has no truth: 0.25 m from the wall y = 0
        // would be inside it, so the point (1.234, −0.5) is 0.75 m beyond.
        assert_eq!(rows[0], "0,1234,-500,0,1,500,250,0,-1500,-750,,1.23e-2");
        assert_eq!(rows[1].split(',').collect::<Vec<_>>()[..5], ["100", "2000", "1000", "0", "0"]);
        assert!(rows[1].ends_with(",,"), "{}", rows[1]);
    }
}
