//! The wheel encoders: travel in whole ticks and speed, of wheels that slip.

use schemas::{EncoderNoise, EncoderSample, Time};

use crate::noise::{Purpose, Stream};
use crate::plant::Plant;

/// The encoders and what they have counted.
pub(crate) struct Encoders {
    noise: Option<EncoderNoise>,
    stream: Stream,
    half_track_m: f64,
    before: Option<Count>,
}

/// What was counted up to the previous sample; left, then right.
struct Count {
    t_s: f64,
    /// What the wheels really rolled, metres.
    rolled_m: [f64; 2],
    /// What the encoders make of it, before it is cut into ticks, metres.
    counted_m: [f64; 2],
}

impl Encoders {
    pub(crate) fn new(noise: Option<EncoderNoise>, track_m: f64, seed: u64) -> Encoders {
        Encoders {
            noise,
            stream: Stream::new(seed, Purpose::Encoders),
            half_track_m: 0.5 * track_m,
            before: None,
        }
    }

    /// Sample number `index`, `t_s` after the start. The speeds are means since the previous
    /// sample, and as wrong as the travel; the first sample shows the speeds of that moment.
    pub(crate) fn sample(
        &mut self,
        index: u64,
        stamp: Time,
        t_s: f64,
        plant: &Plant,
    ) -> EncoderSample {
        let (travelled_m, turned_rad) = plant.wheel_travel();
        let apart_m = turned_rad * self.half_track_m;
        let rolled_m = [travelled_m - apart_m, travelled_m + apart_m];
        let gains = match &self.noise {
            None => [1.0, 1.0],
            Some(noise) => {
                let normals = self.stream.reading(index).normals(0);
                // Of all that a spinning wheel turns, the share 1 − slip takes the robot along.
                let spin = noise
                    .slip_burst
                    .filter(|burst| (burst.from_s..burst.until_s).contains(&t_s))
                    .map_or(1.0, |burst| 1.0 / (1.0 - burst.slip));
                let dead_from_s = [noise.left_dead_from_s, noise.right_dead_from_s];
                [0, 1].map(|side| {
                    let dead = dead_from_s[side].is_some_and(|from_s| t_s >= from_s);
                    if dead { 0.0 } else { spin * (1.0 + noise.speed_fraction * normals[side]) }
                })
            }
        };
        let (counted_m, speeds_mps) = match &self.before {
            Some(before) if t_s > before.t_s => {
                let fresh_m =
                    [0, 1].map(|side| gains[side] * (rolled_m[side] - before.rolled_m[side]));
                (
                    [before.counted_m[0] + fresh_m[0], before.counted_m[1] + fresh_m[1]],
                    fresh_m.map(|metres| metres / (t_s - before.t_s)),
                )
            }
            _ => {
                let wheels = plant.wheel_twist();
                let apart_mps = wheels.omega_radps * self.half_track_m;
                (
                    rolled_m,
                    [gains[0] * (wheels.v_mps - apart_mps), gains[1] * (wheels.v_mps + apart_mps)],
                )
            }
        };
        self.before = Some(Count { t_s, rolled_m, counted_m });
        let [left_m, right_m] = counted_m.map(|metres| self.ticks(metres));
        let [left_mps, right_mps] = speeds_mps;
        EncoderSample { stamp, left_m, right_m, left_mps, right_mps }
    }

    /// The travel that whole ticks tell of.
    fn ticks(&self, metres: f64) -> f64 {
        match &self.noise {
            Some(noise) if noise.tick_m > 0.0 => libm::floor(metres / noise.tick_m) * noise.tick_m,
            _ => metres,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use schemas::{Plant as Limits, SIMULATION_EPOCH, SlipBurst, Start};

    fn turning(slip: f64) -> Plant {
        let start = Start { v_mps: 0.4, omega_radps: 0.5, ..Start::default() };
        Plant::new(Limits { slip, ..Limits::default() }, &start)
    }

    /// Differential drive: `v_l` = v - ω l/2, `v_r` = v + ω l/2; wheels that slip turn by 1/(1 - slip) more.
    #[test]
    fn perfect_wheels() {
        for slip in [0.0, 0.2] {
            let mut plant = turning(slip);
            let mut encoders = Encoders::new(None, 0.5, 0);
            let first = encoders.sample(0, SIMULATION_EPOCH, 0.0, &plant);
            plant.advance_to(2_000_000_000);
            let second = encoders.sample(1, SIMULATION_EPOCH, 2.0, &plant);
            let close = |a: f64, b: f64| (a - b / (1.0 - slip)).abs() < 1e-12;
            assert_eq!((first.left_m, first.right_m), (0.0, 0.0));
            assert!(close(first.left_mps, 0.275) && close(first.right_mps, 0.525));
            assert!(close(second.left_m, 0.55) && close(second.right_m, 1.05));
            assert!(close(second.left_mps, 0.275) && close(second.right_mps, 0.525));
        }
    }

    /// Of 2 s at 0.4 m/s and 0.5 rad/s, which turn the wheels by 0.55 and 1.05 m, the second half is
    /// spun (half of the travel lost: twice the turns) or not counted at all on one side.
    #[test]
    fn wheels_may_spin_and_counters_die() {
        let faultless =
            EncoderNoise { speed_fraction: 0.0, tick_m: 0.0, ..EncoderNoise::default() };
        let burst = SlipBurst { from_s: 1.01, until_s: 2.01, slip: 0.5 };
        for (noise, left_m, right_m) in [
            (faultless, 0.55, 1.05),
            (EncoderNoise { slip_burst: Some(burst), ..faultless }, 0.825, 1.575),
            (EncoderNoise { left_dead_from_s: Some(1.01), ..faultless }, 0.275, 1.05),
            (EncoderNoise { right_dead_from_s: Some(1.01), ..faultless }, 0.55, 0.525),
        ] {
            let mut plant = turning(0.0);
            let mut encoders = Encoders::new(Some(noise), 0.5, 3);
            let mut newest = EncoderSample::default();
            for i in 0..=100_u64 {
                plant.advance_to(i * 20_000_000);
                newest = encoders.sample(i, SIMULATION_EPOCH, i as f64 * 0.02, &plant);
            }
            assert!((newest.left_m - left_m).abs() < 1e-9, "{noise:?}: {newest:?}");
            assert!((newest.right_m - right_m).abs() < 1e-9, "{noise:?}: {newest:?}");
        }
    }

    /// Travel comes in whole ticks and never runs away from the speeds' sum by more than one.
    #[test]
    fn counts_whole_ticks_of_noisy_travel() {
        let noise = EncoderNoise { speed_fraction: 0.05, ..EncoderNoise::default() };
        let mut plant = turning(0.0);
        let mut encoders = Encoders::new(Some(noise), 0.5, 3);
        let mut summed_m = 0.0;
        let mut errors = 0.0;
        for i in 0..1000_u64 {
            plant.advance_to(i * 20_000_000);
            let sample = encoders.sample(i, SIMULATION_EPOCH, i as f64 * 0.02, &plant);
            if i > 0 {
                summed_m += sample.right_mps * 0.02;
                let error = sample.right_mps / 0.525 - 1.0;
                errors += error * error;
            }
            let ticks = sample.right_m / noise.tick_m;
            assert!((ticks - libm::round(ticks)).abs() < 1e-6);
            assert!(-1e-9 < summed_m - sample.right_m && summed_m - sample.right_m < 0.001 + 1e-9);
        }
        // Five standard errors of a variance over 1000 draws: 22 %.
        assert!((errors / 999.0 / 0.0025 - 1.0).abs() < 0.22);
    }
}
