//! What a sample adds to the input hash.

use schemas::{Sample, Time};

use crate::digest::Digest;

/// Takes in all that `sample` says, its kind first.
pub(super) fn fold_sample(digest: &mut Digest, sample: &Sample, start: Time) {
    digest.time(sample.stamp(), start);
    match sample {
        Sample::Sonar(scan) => {
            digest.word(1);
            digest.word(scan.echoes.len() as u64);
            for echo in &scan.echoes {
                digest.word(u64::from(echo.id) << 1 | u64::from(echo.echo));
                digest.number(echo.range_m);
                digest.time(echo.fired, start);
            }
        }
        Sample::Imu(imu) => {
            digest.word(2);
            digest.numbers(&imu.accel_mps2);
            digest.numbers(&imu.gyro_radps);
            digest.numbers(&imu.mag_ut);
        }
        Sample::Encoders(encoders) => {
            digest.word(3);
            digest.numbers(&[
                encoders.left_m,
                encoders.right_m,
                encoders.left_mps,
                encoders.right_mps,
            ]);
        }
        Sample::Joystick(joystick) => {
            digest.word(4);
            digest.numbers(&[joystick.v_mps, joystick.omega_radps]);
            digest.word(u64::from(joystick.dead_man));
        }
        Sample::Exact(exact) => {
            digest.word(5);
            digest.pose(&exact.pose);
            digest.numbers(&[exact.v_mps, exact.omega_radps]);
        }
    }
}
