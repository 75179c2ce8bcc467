//! Where the robot will be when its next command takes effect.

use schemas::Pose;

/// Times longer than this are not predicted over, seconds: what is that old no longer counts.
const HORIZON_S: f64 = 0.5;

/// `pose` after driving (v, ω) for `seconds`, along the exact arc; `pose` itself, bit for bit, for
/// no time at all, or where anything is not a number.
pub(super) fn predict(pose: &Pose, [v_mps, omega_radps]: [f64; 2], seconds: f64) -> Pose {
    let seconds = seconds.clamp(0.0, HORIZON_S);
    let turn_rad = omega_radps * seconds;
    if seconds == 0.0 || !(v_mps.is_finite() && turn_rad.is_finite()) {
        return *pose;
    }
    // The chord of an arc: length v t sinc(turn/2), at the mean heading.
    let half_rad = 0.5 * turn_rad;
    let sinc = if half_rad == 0.0 { 1.0 } else { libm::sin(half_rad) / half_rad };
    let chord_m = v_mps * seconds * sinc;
    let (sin, cos) = libm::sincos(pose.theta_rad + half_rad);
    Pose {
        x_m: pose.x_m + chord_m * cos,
        y_m: pose.y_m + chord_m * sin,
        theta_rad: pose.theta_rad + turn_rad,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_time_changes_no_bit() {
        let pose = Pose { x_m: 0.1, y_m: -0.0, theta_rad: 7.3 };
        assert_eq!(predict(&pose, [0.5, 1.0], 0.0), pose);
        assert_eq!(predict(&pose, [f64::NAN, 1.0], 0.1), pose);
        assert_eq!(predict(&pose, [0.5, 1.0], f64::NAN), pose);
    }

    #[test]
    fn a_quarter_circle_ends_where_geometry_says() {
        // Radius v/ω = 0.5 m, a quarter turn to the left in 0.4 s.
        let omega = std::f64::consts::FRAC_PI_2 / 0.4;
        let end = predict(&Pose::default(), [0.5 * omega, omega], 0.4);
        assert!((end.x_m - 0.5).abs() < 1e-12 && (end.y_m - 0.5).abs() < 1e-12, "{end:?}");
    }
}
