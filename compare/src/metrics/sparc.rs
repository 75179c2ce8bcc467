//! How smooth the speed is: `sparc`.

use super::accumulate::{Accumulate, Mean};
use super::sample::Motion;

/// Speeds are averaged over this long, seconds: their spectrum then reaches 10 Hz.
const SAMPLE_S: f64 = 0.05;

/// Samples of a window: ten seconds. The measure is one of single movements.
const WINDOW: usize = 200;

/// A shorter rest of a run counts from this many samples on: five seconds.
const SHORTEST: usize = 100;

/// Step of the spectrum, hertz; small against the width of a window's main lobe.
const STEP_HZ: f64 = 0.01;

/// Frequencies that are worked out side by side: a processor multiplies several numbers at once.
const AT_ONCE: usize = 8;

/// Highest frequency, hertz, and the share of the spectrum's start below which the rest is left out
/// (Balasubramanian and others, 2015).
const HIGHEST_HZ: f64 = 10.0;
const LEAST_SHARE: f64 = 0.05;

/// `sparc` = mean over windows of ten seconds of the spectral arc length of |v|,
/// −∫₀^ωc √((1/ωc)² + (dV̂/dω)²) dω with V̂ the spectrum divided by its start and ωc the frequency
/// beyond which V̂ stays below 0.05, at most 10 Hz. Nearer to 0 is smoother (Balasubramanian,
/// Melendez-Calderon, Roby-Brami and Burdet, "On the analysis of movement smoothness", Journal of
/// `NeuroEngineering` and Rehabilitation 12, 2015).
#[derive(Clone, Debug, Default)]
pub(super) struct Sparc {
    /// ∫|v| dt and the time of the sample that is being filled.
    filling: Mean,
    window: Vec<f64>,
    windows: Mean,
}

impl Sparc {
    fn sample(&mut self, speed_mps: f64) {
        self.window.push(speed_mps);
        if self.window.len() == WINDOW {
            if let Some(arc) = arc_length(&self.window) {
                self.windows.add(arc, 1.0);
            }
            self.window.clear();
        }
    }
}

impl Accumulate for Sparc {
    fn motion(&mut self, motion: &Motion) {
        let speed_mps = libm::fabs(motion.twist.v_mps);
        if !speed_mps.is_finite() {
            return;
        }
        let mut left_s = motion.hold_s;
        while left_s > 0.0 {
            let room_s = SAMPLE_S - self.filling.weight;
            let part_s = left_s.min(room_s);
            self.filling.add(speed_mps, part_s);
            left_s -= part_s;
            if self.filling.weight >= SAMPLE_S - 1e-9 {
                let sample = self.filling.value().unwrap_or(0.0);
                self.filling = Mean::default();
                self.sample(sample);
            }
        }
    }

    fn value(&self) -> Option<f64> {
        let mut windows = self.windows;
        if self.window.len() >= SHORTEST
            && let Some(arc) = arc_length(&self.window)
        {
            windows.add(arc, self.window.len() as f64 / WINDOW as f64);
        }
        windows.value()
    }
}

/// The spectral arc length of equally spaced speeds; `None` for a robot at rest.
fn arc_length(speeds_mps: &[f64]) -> Option<f64> {
    let start: f64 = speeds_mps.iter().sum();
    // A robot that creeps through less than a millimetre does not move smoothly or otherwise.
    if start * SAMPLE_S < 1e-3 {
        return None;
    }
    let count = libm::round(HIGHEST_HZ / STEP_HZ) as u32;
    let mut spectrum = Vec::new();
    for first in (0..=count).step_by(AT_ONCE) {
        let frequencies_hz = core::array::from_fn(|i| f64::from(first + i as u32) * STEP_HZ);
        spectrum.extend(magnitudes(speeds_mps, frequencies_hz).map(|magnitude| magnitude / start));
    }
    spectrum.truncate(count as usize + 1);
    let cut = spectrum.iter().rposition(|share| *share >= LEAST_SHARE)?.max(1);
    let across = 1.0 / cut as f64;
    let arc: f64 =
        spectrum[..=cut].windows(2).map(|pair| libm::hypot(across, pair[1] - pair[0])).sum();
    Some(-arc)
}

/// |Σ x exp(−iωt)| at some frequencies, each by itself; the exponentials by repeated multiplication.
fn magnitudes(speeds_mps: &[f64], frequencies_hz: [f64; AT_ONCE]) -> [f64; AT_ONCE] {
    let turns = frequencies_hz.map(|hz| libm::sincos(core::f64::consts::TAU * hz * SAMPLE_S));
    let (sin, cos) = (turns.map(|turn| turn.0), turns.map(|turn| turn.1));
    let (mut re, mut im) = ([0.0; AT_ONCE], [0.0; AT_ONCE]);
    let (mut c, mut s) = ([1.0; AT_ONCE], [0.0; AT_ONCE]);
    for x in speeds_mps {
        for i in 0..AT_ONCE {
            re[i] += x * c[i];
            im[i] += x * s[i];
            (c[i], s[i]) = (c[i] * cos[i] - s[i] * sin[i], s[i] * cos[i] + c[i] * sin[i]);
        }
    }
    core::array::from_fn(|i| libm::hypot(re[i], im[i]))
}

#[cfg(test)]
mod tests {
    use schemas::{Pose, Twist};

    use super::*;

    /// A bell-shaped speed has the spectrum exp(−ω²σ²/2) whatever its height and width, as long as
    /// it fits: with x = ω/ωc, exp(−x² ln 20), the arc is ∫₀¹ √(1 + (2 ln 20 x exp(−x² ln 20))²) dx.
    #[test]
    fn a_bell_has_the_arc_of_its_spectrum() {
        let ln20 = 20f64.ln();
        let n = 100_000;
        let want: f64 = (0..n)
            .map(|i| {
                let x = (f64::from(i) + 0.5) / f64::from(n);
                1f64.hypot(2.0 * ln20 * x * (-x * x * ln20).exp()) / f64::from(n)
            })
            .sum();
        for (height, sigma_s) in [(0.7, 1.0), (0.1, 0.5)] {
            let bell: Vec<f64> = (0..WINDOW)
                .map(|i| {
                    let t = (i as f64 * SAMPLE_S - 5.0) / sigma_s;
                    height * (-0.5 * t * t).exp()
                })
                .collect();
            let got = arc_length(&bell).expect("moves");
            // The cut lies on a grid of frequencies.
            assert!((got + want).abs() < 0.02, "{got} instead of {}", -want);
        }
    }

    /// The authors' definition, written anew in Python with `cmath`: the same samples and the same
    /// frequencies.
    #[test]
    fn it_agrees_with_an_independent_program() {
        let speeds: Vec<f64> = (0..WINDOW)
            .map(|i| {
                let t = i as f64 * SAMPLE_S;
                0.4 + 0.2 * (1.3 * t).sin() + if (60..80).contains(&i) { -0.3 } else { 0.0 }
            })
            .collect();
        let (got, want) = (arc_length(&speeds).expect("moves"), -2.550_059_961_006_279);
        assert!((got - want).abs() < 1e-9, "{got} instead of {want}");
    }

    fn motion(v_mps: f64, hold_s: f64) -> Motion {
        Motion {
            t_s: 0.0,
            hold_s,
            pose: Pose::default(),
            twist: Twist { v_mps, omega_radps: 0.0 },
            clearance_m: f64::NAN,
            clearance_static_m: f64::NAN,
            discs: Vec::new(),
            ttc_s: f64::NAN,
        }
    }

    /// Motion that holds for 20, 70, 130 and 30 ms in turn; written out in slots of 10 ms, of which five make
    /// a sample. The rest of 120 samples beside a window of 200 counts for 0.6 of one, a rest of 40 for
    /// nothing. What is not a number is passed over.
    #[test]
    fn samples_are_means_over_fifty_milliseconds() {
        let parts = [(0.1, 2), (-0.4, 7), (0.3, 13), (0.2, 3)];
        for (total, rest_counts) in [(1_200, false), (1_600, true)] {
            let (mut sparc, mut slots) = (Sparc::default(), Vec::new());
            for (v_mps, tens) in parts.into_iter().cycle() {
                // So that no two windows are the same.
                let v_mps = v_mps * (1.0 + 1e-3 * slots.len() as f64);
                sparc.motion(&motion(v_mps, 0.01 * f64::from(tens)));
                sparc.motion(&motion(f64::NAN, 0.02));
                slots.extend((0..tens).map(|_| v_mps.abs()));
                if slots.len() >= total {
                    break;
                }
            }
            assert_eq!(slots.len(), total, "whole turns of the four");
            let samples: Vec<f64> =
                slots.chunks_exact(5).map(|five| five.iter().sum::<f64>() / 5.0).collect();
            let (window, rest) = samples.split_at(WINDOW);
            let near = |a: &f64, b: &f64| (a - b).abs() < 1e-12;
            assert!(sparc.window.iter().zip(rest).all(|(got, want)| near(got, want)));
            assert_eq!(sparc.window.len(), rest.len());
            let first = arc_length(window).expect("moves");
            let want = if rest_counts {
                (first + 0.6 * arc_length(rest).expect("moves")) / 1.6
            } else {
                first
            };
            let got = sparc.value().expect("moves");
            assert!((got - want).abs() < 1e-9, "{got} instead of {want}");
        }
    }

    /// Every second sample at 1 m/s: |sin 100φ / (100 sin φ)| with φ = 2π · 0.05 s · f, 1 again at 10 Hz and mirrored
    /// beyond. The arc ends at 10 Hz.
    #[test]
    fn nothing_is_faster_than_ten_hertz() {
        let speeds: Vec<f64> = (0..WINDOW).map(|i| if i % 2 == 0 { 1.0 } else { 0.0 }).collect();
        let share = |hundredths: u32| {
            let phi = std::f64::consts::PI * f64::from(hundredths) / 1_000.0;
            if matches!(hundredths, 0 | 1_000) {
                1.0
            } else {
                ((100.0 * phi).sin() / (100.0 * phi.sin())).abs()
            }
        };
        let want: f64 = (0..1_000).map(|i| 1e-3_f64.hypot(share(i + 1) - share(i))).sum();
        let got = arc_length(&speeds).expect("moves");
        assert!((got + want).abs() < 1e-9, "{got} instead of {}", -want);
    }

    /// In ten seconds 1.2 mm are a movement, 0.8 mm are none.
    #[test]
    fn creeping_is_no_movement() {
        assert!(arc_length(&[1.2e-4; WINDOW]).is_some());
        assert_eq!(arc_length(&[0.8e-4; WINDOW]), None);
        // A millimetre, in a twentieth of a second.
        assert!(arc_length(&[0.02]).is_some());
    }

    /// Side by side, each frequency is what it is alone, to the bit.
    #[test]
    fn frequencies_do_not_mix() {
        let speeds: Vec<f64> = (0..WINDOW).map(|i| (0.1 * i as f64).sin().abs()).collect();
        let frequencies_hz = core::array::from_fn(|i| 0.37 * i as f64);
        let together = magnitudes(&speeds, frequencies_hz);
        for (frequency_hz, got) in frequencies_hz.into_iter().zip(together) {
            let (sin, cos) = libm::sincos(core::f64::consts::TAU * frequency_hz * SAMPLE_S);
            let (mut sum, mut turn) = ([0.0; 2], [1.0, 0.0]);
            for x in &speeds {
                sum = [sum[0] + x * turn[0], sum[1] + x * turn[1]];
                turn = [turn[0] * cos - turn[1] * sin, turn[1] * cos + turn[0] * sin];
            }
            assert_eq!(got, libm::hypot(sum[0], sum[1]));
        }
    }

    #[test]
    fn jerks_make_it_longer_and_rest_has_none() {
        let smooth: Vec<f64> = vec![0.5; WINDOW];
        let stops: Vec<f64> =
            (0..WINDOW).map(|i| if i / 10 % 2 == 0 { 1.0 } else { 0.0 }).collect();
        let arc = |speeds: &[f64]| arc_length(speeds).expect("moves");
        assert!(arc(&stops) < arc(&smooth) - 0.5);
        assert_eq!(arc_length(&[0.0; WINDOW]), None);
    }
}
