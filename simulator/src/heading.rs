//! Sine and cosine of a heading, as the plant, the sonars and the compass take them.

/// Sine and cosine of an angle.
#[cfg(not(feature = "canary"))]
pub(crate) fn sincos(angle_rad: f64) -> (f64, f64) {
    libm::sincos(angle_rad)
}

/// The planted fault: the standard library's sine differs between machines in about one angle of 1,500,
/// and there by one unit in the last place. A step of the plant mostly rounds that away; the compass, which
/// shows it a hundred times a second, does not. The determinism check has to notice.
#[cfg(feature = "canary")]
#[expect(clippy::disallowed_methods, reason = "the fault that the determinism check must find")]
pub(crate) fn sincos(angle_rad: f64) -> (f64, f64) {
    (angle_rad.sin(), libm::cos(angle_rad))
}
