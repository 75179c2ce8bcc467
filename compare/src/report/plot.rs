//! Quantities of both arms over time.

use std::fmt::Write;

use serde::Serialize;

use super::map::{MOST_POINTS, unit};
use super::{number, seconds};
use crate::comparison::Scene;
use crate::metrics::{Track, TrackPoint};

/// Width of the drawing area, SVG units; the page leaves room for the numbers at its left.
const WIDTH: f64 = 620.0;

/// Height of one plot.
const HEIGHT: f64 = 90.0;

/// Everything that is drawn over time for one log.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Timeline {
    width: String,
    height: String,
    /// Who drives, one ribbon for each arm.
    ribbons: Vec<Ribbon>,
    plots: Vec<Plot>,
    /// Marks of the time axis: where, and what it says.
    ticks: Vec<(String, String)>,
}

/// One arm's k over time.
#[derive(Clone, Debug, Serialize)]
struct Ribbon {
    arm: &'static str,
    /// Stretches with k = 0: where, how wide, and since when until when.
    feedback: Vec<(String, String, String)>,
    /// Stretches in which the safety layer alters the person's input.
    projected: Vec<(String, String, String)>,
}

/// One quantity.
#[derive(Clone, Debug, Serialize)]
struct Plot {
    title: &'static str,
    unit: &'static str,
    /// Lowest and highest number of the axis.
    low: String,
    high: String,
    /// Where 0 is, if it is on the axis.
    zero: Option<String>,
    a: String,
    b: String,
    /// What the person asked for (in A), for velocities.
    requested: String,
}

/// A quantity that is drawn, and the request to draw behind it.
struct Quantity {
    title: &'static str,
    unit: &'static str,
    of: fn(&TrackPoint) -> f64,
    requested: Option<fn(&TrackPoint) -> f64>,
}

const QUANTITIES: [Quantity; 5] = [
    Quantity {
        title: "forward speed",
        unit: "m/s",
        of: |p| p.v_s_mps,
        requested: Some(|p| p.v_h_mps),
    },
    Quantity {
        title: "turn rate",
        unit: "rad/s",
        of: |p| p.omega_s_radps,
        requested: Some(|p| p.omega_h_radps),
    },
    Quantity { title: "clearance d", unit: "m", of: |p| p.clearance_m, requested: None },
    Quantity {
        title: "distance D along the travel",
        unit: "m",
        of: |p| p.distance_human_m,
        requested: None,
    },
    Quantity { title: "Lyapunov function", unit: "", of: |p| p.lyapunov, requested: None },
];

/// The timeline of a scene; `None` where neither arm lasted any time.
pub(super) fn timeline(scene: &Scene) -> Option<Timeline> {
    let tracks: Vec<&Track> = scene.a.iter().chain(&scene.b).collect();
    let times = tracks.iter().flat_map(|track| &track.points).map(|point| point.t_s);
    let end_s = times.filter(|t_s| t_s.is_finite()).fold(0.0, f64::max);
    if end_s <= 0.0 {
        return None;
    }
    let axis = Axis { end_s };
    let arms = [("A", &scene.a), ("B", &scene.b)];
    let ribbons =
        arms.iter().filter_map(|(arm, track)| Some(axis.ribbon(arm, track.as_ref()?))).collect();
    let plots = QUANTITIES
        .iter()
        .filter_map(|quantity| axis.plot(quantity, scene.a.as_ref(), scene.b.as_ref()))
        .collect();
    Some(Timeline { width: unit(WIDTH), height: unit(HEIGHT), ribbons, plots, ticks: axis.ticks() })
}

/// The time axis.
#[derive(Clone, Copy, Debug)]
struct Axis {
    end_s: f64,
}

impl Axis {
    fn x(self, t_s: f64) -> f64 {
        WIDTH * (t_s / self.end_s).clamp(0.0, 1.0)
    }

    /// Five or so round times.
    fn ticks(self) -> Vec<(String, String)> {
        let rough = self.end_s / 6.0;
        let decade = libm::pow(10.0, libm::floor(libm::log10(rough)));
        let step = [1.0, 2.0, 5.0, 10.0]
            .iter()
            .map(|factor| factor * decade)
            .find(|step| *step >= rough)
            .unwrap_or(10.0 * decade);
        let count = libm::floor(self.end_s / step) as usize;
        (0..=count)
            .map(|i| i as f64 * step)
            // A multiple of a round step, printed without the rounding of the product.
            .map(|t_s| (unit(self.x(t_s)), format!("{}", libm::round(t_s * 1e6) / 1e6)))
            .collect()
    }

    fn ribbon(self, arm: &'static str, track: &Track) -> Ribbon {
        let mut ribbon = Ribbon { arm, feedback: Vec::new(), projected: Vec::new() };
        let ends = track.switches.iter().skip(1).map(|switch| switch.t_s).chain([self.end_s]);
        for (switch, end_s) in track.switches.iter().zip(ends) {
            let (from, to) = (self.x(switch.t_s), self.x(end_s));
            let stretch = || {
                let words = format!("{} to {}", seconds(switch.t_s), seconds(end_s));
                (unit(from), unit((to - from).max(0.5)), words)
            };
            if switch.k == 0.0 {
                ribbon.feedback.push(stretch());
            } else if switch.projected {
                ribbon.projected.push(stretch());
            }
        }
        ribbon
    }

    fn plot(self, quantity: &Quantity, a: Option<&Track>, b: Option<&Track>) -> Option<Plot> {
        let mut range = (f64::INFINITY, f64::NEG_INFINITY);
        let mut take = |of: fn(&TrackPoint) -> f64, track: Option<&Track>| {
            for x in track.iter().flat_map(|track| &track.points).map(of) {
                if x.is_finite() {
                    range = (range.0.min(x), range.1.max(x));
                }
            }
        };
        take(quantity.of, a);
        take(quantity.of, b);
        if let Some(requested) = quantity.requested {
            take(requested, a);
        }
        let (low, high) = range;
        if low > high {
            return None;
        }
        // A constant still needs an axis with a length.
        let (low, high) = if low == high { (low - 0.5, high + 0.5) } else { (low, high) };
        let y = |x: f64| HEIGHT * (high - x) / (high - low);
        let line = |of: fn(&TrackPoint) -> f64, track: Option<&Track>| {
            track.map_or_else(String::new, |track| self.line(track, of, y))
        };
        Some(Plot {
            title: quantity.title,
            unit: quantity.unit,
            low: number(Some(low)),
            high: number(Some(high)),
            zero: (low < 0.0 && high > 0.0).then(|| unit(y(0.0))),
            a: line(quantity.of, a),
            b: line(quantity.of, b),
            requested: quantity.requested.map_or_else(String::new, |of| line(of, a)),
        })
    }

    /// An SVG path with a break where the value is unknown or infinite.
    fn line(self, track: &Track, of: fn(&TrackPoint) -> f64, y: impl Fn(f64) -> f64) -> String {
        let every = track.points.len().div_ceil(MOST_POINTS).max(1);
        let mut line = String::new();
        let mut pen_down = false;
        for point in track.points.iter().step_by(every) {
            let value = of(point);
            if !value.is_finite() {
                pen_down = false;
                continue;
            }
            let command = if pen_down { 'L' } else { 'M' };
            // Writing to a String cannot fail.
            let _ = write!(line, "{command}{} {}", unit(self.x(point.t_s)), unit(y(value)));
            pen_down = true;
        }
        line
    }
}
