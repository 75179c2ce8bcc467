//! The IMU: gyro, accelerometer and magnetometer of a robot on a level floor.

use schemas::{ImuNoise, ImuSample, Time};

use crate::heading::sincos;
use crate::noise::{Purpose, Stream};
use crate::plant::Plant;

/// Standard gravity, as the accelerometer of a robot at rest shows it, m/s².
pub const GRAVITY_MPS2: f64 = 9.81;

/// The earth's magnetic field in the world frame (x towards magnetic north, z up), microtesla: the
/// horizontal and vertical strength in London, where the paper's robot drove, rounded.
pub const EARTH_FIELD_UT: [f64; 3] = [19.5, 0.0, -45.0];

/// The IMU and what it remembers between samples.
pub(crate) struct Imu {
    noise: Option<ImuNoise>,
    stream: Stream,
    /// Forward speed at the previous sample and when that was, m/s and s.
    before: Option<(f64, f64)>,
}

impl Imu {
    pub(crate) fn new(noise: Option<ImuNoise>, seed: u64) -> Imu {
        Imu { noise, stream: Stream::new(seed, Purpose::Imu), before: None }
    }

    /// Sample number `index`, `t_s` after the start. The forward acceleration is the mean since the
    /// previous sample: what an accelerometer feels of a speed that jumps.
    pub(crate) fn sample(&mut self, index: u64, stamp: Time, t_s: f64, plant: &Plant) -> ImuSample {
        let twist = plant.twist();
        let forward_mps2 = match self.before {
            Some((v_mps, before_s)) if t_s > before_s => (twist.v_mps - v_mps) / (t_s - before_s),
            _ => 0.0,
        };
        self.before = Some((twist.v_mps, t_s));
        let (sin, cos) = sincos(plant.pose().theta_rad);
        let [north, west, up] = EARTH_FIELD_UT;
        let mut sample = ImuSample {
            stamp,
            accel_mps2: [forward_mps2, twist.v_mps * twist.omega_radps, GRAVITY_MPS2],
            gyro_radps: [0.0, 0.0, twist.omega_radps],
            mag_ut: [north * cos + west * sin, west * cos - north * sin, up],
        };
        if let Some(noise) = &self.noise {
            let reading = self.stream.reading(index);
            let mut normals = [0.0; 10];
            for (pair, slots) in normals.chunks_exact_mut(2).enumerate() {
                slots.copy_from_slice(&reading.normals(2 * pair as u64));
            }
            for axis in 0..3 {
                sample.gyro_radps[axis] += noise.gyro_sigma_radps * normals[axis];
                sample.accel_mps2[axis] += noise.accel_sigma_mps2 * normals[3 + axis];
                sample.mag_ut[axis] += noise.mag_sigma_ut * normals[6 + axis];
            }
            sample.gyro_radps[2] += noise.gyro_bias_radps;
            if let Some(step) = &noise.gyro_bias_step
                && t_s >= step.at_s
            {
                sample.gyro_radps[2] += step.by_radps;
            }
        }
        sample
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use schemas::{Command, GyroBiasStep, Plant as Limits, Pose, SIMULATION_EPOCH, Start, Twist};

    fn turning() -> Plant {
        let start = Start {
            pose: Pose { x_m: 0.0, y_m: 0.0, theta_rad: 0.5 },
            v_mps: 0.4,
            omega_radps: 0.5,
        };
        Plant::new(Limits::default(), &start)
    }

    /// A steady turn to the left: centripetal force to the left, v ω; gravity; the field turned by
    /// minus the heading, from which the heading comes back.
    #[test]
    fn perfect_sample_of_a_steady_turn() {
        let mut imu = Imu::new(None, 0);
        let sample = imu.sample(0, SIMULATION_EPOCH, 0.0, &turning());
        assert_eq!(sample.gyro_radps, [0.0, 0.0, 0.5]);
        assert_eq!(sample.accel_mps2, [0.0, 0.2, 9.81]);
        let heading_rad = libm::atan2(-sample.mag_ut[1], sample.mag_ut[0]);
        assert!((heading_rad - 0.5).abs() < 1e-12);
        assert_eq!(sample.mag_ut[2], -45.0);
    }

    /// The mean acceleration over a sample, for a plant that ramps at 2 m/s².
    #[test]
    fn feels_the_forward_acceleration() {
        let limits = Limits { limits_acceleration: true, ..Limits::default() };
        let mut plant = Plant::new(limits, &Start::default());
        let mut imu = Imu::new(None, 0);
        imu.sample(0, SIMULATION_EPOCH, 0.0, &plant);
        plant.command(&Command {
            twist: Twist { v_mps: 0.5, omega_radps: 0.0 },
            ..Command::default()
        });
        plant.advance_to(10_000_000);
        let sample = imu.sample(1, SIMULATION_EPOCH, 0.01, &plant);
        assert!((sample.accel_mps2[0] - 2.0).abs() < 1e-9);
    }

    /// From its moment on, and about z alone.
    #[test]
    fn the_bias_may_step() {
        let step = Some(GyroBiasStep { at_s: 2.0, by_radps: 0.05 });
        let plant = turning();
        let sample = |gyro_bias_step, t_s| {
            let noise = ImuNoise { gyro_bias_step, ..ImuNoise::default() };
            Imu::new(Some(noise), 11).sample(7, SIMULATION_EPOCH, t_s, &plant)
        };
        assert_eq!(sample(step, 1.99), sample(None, 1.99));
        let (with, without) = (sample(step, 2.0), sample(None, 2.0));
        assert!((with.gyro_radps[2] - without.gyro_radps[2] - 0.05).abs() < 1e-15);
        assert_eq!(with.gyro_radps[..2], without.gyro_radps[..2]);
        assert_eq!((with.accel_mps2, with.mag_ut), (without.accel_mps2, without.mag_ut));
    }

    /// Bias and deviations of all nine axes as configured, and no two axes correlated, within five
    /// standard errors over 10,000 samples.
    #[test]
    fn noise_has_the_size_asked_for() {
        let noise = ImuNoise::default();
        let plant = turning();
        let perfect = Imu::new(None, 0).sample(0, SIMULATION_EPOCH, 0.0, &plant);
        let axes = |sample: &ImuSample| -> Vec<f64> {
            [sample.gyro_radps, sample.accel_mps2, sample.mag_ut].concat()
        };
        let mut bias = [0.0; 9];
        bias[2] = noise.gyro_bias_radps;
        let sigmas =
            [[noise.gyro_sigma_radps; 3], [noise.accel_sigma_mps2; 3], [noise.mag_sigma_ut; 3]]
                .concat();
        let mut imu = Imu::new(Some(noise), 11);
        let count = 10_000;
        let mut sums = [0.0; 9];
        let mut products = [[0.0; 9]; 9];
        for i in 0..count {
            let sample = imu.sample(i, SIMULATION_EPOCH, i as f64, &plant);
            let errors: Vec<f64> = (0..9)
                .map(|k| (axes(&sample)[k] - axes(&perfect)[k] - bias[k]) / sigmas[k])
                .collect();
            for ((sum, row), error) in sums.iter_mut().zip(&mut products).zip(&errors) {
                *sum += error;
                row.iter_mut().zip(&errors).for_each(|(product, other)| *product += error * other);
            }
        }
        let n = count as f64;
        assert!(sums.iter().all(|sum| (sum / n).abs() < 5.0 / libm::sqrt(n)), "{sums:?}");
        for (k, row) in products.iter().enumerate() {
            for (l, product) in row.iter().enumerate() {
                let wanted = if k == l { 1.0 } else { 0.0 };
                let bound = 5.0 * libm::sqrt((1.0 + wanted) / n);
                assert!((product / n - wanted).abs() < bound, "axes {k} and {l}");
            }
        }
    }
}
