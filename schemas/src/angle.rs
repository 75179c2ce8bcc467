//! Angles on the circle.

use core::f64::consts::{PI, TAU};

/// The same angle in [-π, π), radians; NaN for what is not finite.
pub fn wrap(angle_rad: f64) -> f64 {
    let turned_rad = angle_rad + PI;
    // Within a turn of the interval the remainder is plain, and the same to the bit; it is costly.
    let remainder_rad = if (0.0..TAU).contains(&turned_rad) {
        turned_rad
    } else if (TAU..2.0 * TAU).contains(&turned_rad) {
        turned_rad - TAU
    } else if (-TAU..0.0).contains(&turned_rad) {
        turned_rad + TAU
    } else {
        turned_rad.rem_euclid(TAU)
    };
    remainder_rad - PI
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The plain ways are the remainder, to the bit.
        #[test]
        fn wrapping_is_the_remainder(
            angle_rad in prop_oneof![-8.0..8.0f64, -10.0..10.0f64, -1e6..1e6f64, any::<f64>()],
            turns in -4..4_i32,
            ulps in -2..3_i64,
        ) {
            let edge_rad = f64::from(turns) * PI;
            let edge_rad = f64::from_bits(edge_rad.to_bits().wrapping_add_signed(ulps));
            for angle_rad in [angle_rad, edge_rad] {
                let want = (angle_rad + PI).rem_euclid(TAU) - PI;
                prop_assert_eq!(wrap(angle_rad).to_bits(), want.to_bits(), "{}", angle_rad);
            }
        }
    }
}
