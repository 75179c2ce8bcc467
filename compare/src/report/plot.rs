//! Quantities of both arms over time.

use std::fmt::Write;

use serde::Serialize;

use super::{number, seconds};
use crate::comparison::Scene;
use crate::drawing::{Axis, path, unit};
use crate::metrics::{Switch, Track, TrackPoint};

/// Width of the drawing area, SVG units; the page stretches it to what there is.
const WIDTH: f64 = 620.0;

/// Height of one plot.
const HEIGHT: f64 = 90.0;

/// Height of a ribbon, and the least width of a stretch on it.
const RIBBON: f64 = 14.0;
const LEAST_WIDTH: f64 = 0.5;

/// Decades that a logarithmic plot shows at most, below its greatest value.
const DECADES: i32 = 6;

/// Everything that is drawn over time for one log.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Timeline {
    width: String,
    height: String,
    /// When the longer arm ends, seconds.
    end_s: String,
    /// Who drives, one ribbon for each arm.
    ribbons: Vec<Ribbon>,
    plots: Vec<Plot>,
    /// Marks of the time axis: where, in percent, and what it says.
    ticks: Vec<(String, String)>,
}

/// One arm's k over time.
#[derive(Clone, Debug, Serialize)]
struct Ribbon {
    arm: &'static str,
    /// Stretches with k = 0, as a filled path.
    feedback: String,
    /// Stretches in which the safety layer alters the person's input, likewise.
    projected: String,
    /// How many of the first there are, and how long they are together.
    words: String,
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
    /// What the person asked for in A, for velocities; and in B, where that is something else.
    asked_a: String,
    asked_b: String,
}

/// A quantity that is drawn, and the request to draw behind it.
struct Quantity {
    title: &'static str,
    unit: &'static str,
    of: fn(&TrackPoint) -> f64,
    asked: Option<fn(&TrackPoint) -> f64>,
    logarithmic: bool,
}

const QUANTITIES: [Quantity; 5] = [
    Quantity {
        title: "forward speed",
        unit: "m/s",
        of: |p| p.v_s_mps,
        asked: Some(|p| p.v_h_mps),
        logarithmic: false,
    },
    Quantity {
        title: "turn rate",
        unit: "rad/s",
        of: |p| p.omega_s_radps,
        asked: Some(|p| p.omega_h_radps),
        logarithmic: false,
    },
    Quantity {
        title: "clearance d",
        unit: "m",
        of: |p| p.clearance_m,
        asked: None,
        logarithmic: false,
    },
    Quantity {
        title: "distance D along the travel",
        unit: "m",
        of: |p| p.distance_human_m,
        asked: None,
        logarithmic: false,
    },
    Quantity {
        title: "Lyapunov function",
        unit: "",
        of: |p| p.lyapunov,
        asked: None,
        logarithmic: true,
    },
];

/// The timeline of a scene; `None` where neither arm lasted any time. Lines go through at most
/// `points` points.
pub(super) fn timeline(scene: &Scene, points: usize) -> Option<Timeline> {
    let tracks: Vec<&Track> = scene.a.iter().chain(&scene.b).collect();
    let times = tracks.iter().flat_map(|track| &track.points).map(|point| point.t_s);
    let end_s = times.filter(|t_s| t_s.is_finite()).fold(0.0, f64::max);
    if end_s <= 0.0 {
        return None;
    }
    let time = Axis::linear(0.0, end_s, [0.0, WIDTH]);
    let percent = Axis::linear(0.0, end_s, [0.0, 100.0]);
    let arms = [("A", &scene.a), ("B", &scene.b)];
    let ribbons = arms
        .iter()
        .filter_map(|(arm, track)| Some(ribbon(arm, track.as_ref()?, time, end_s)))
        .collect();
    let [a, b] = [&scene.a, &scene.b]
        .map(|track| track.as_ref().map_or_else(Vec::new, |track| track.thinned(points)));
    Some(Timeline {
        width: unit(WIDTH),
        height: unit(HEIGHT),
        end_s: format!("{end_s}"),
        ribbons,
        plots: QUANTITIES.iter().filter_map(|quantity| plot(quantity, time, &a, &b)).collect(),
        ticks: percent.ticks(6).into_iter().map(|tick| (tick.at, tick.label)).collect(),
    })
}

fn ribbon(arm: &'static str, track: &Track, time: Axis, end_s: f64) -> Ribbon {
    let ends = track.switches.iter().skip(1).map(|switch| switch.t_s).chain([end_s]);
    let stretches = |wanted: fn(&Switch) -> bool| -> Vec<[f64; 2]> {
        let all = track.switches.iter().zip(ends.clone());
        all.filter(|(switch, _)| wanted(switch)).map(|(switch, end)| [switch.t_s, end]).collect()
    };
    let feedback = stretches(|switch| switch.k == 0.0);
    let driven_s: f64 = feedback.iter().map(|[from, until]| until - from).sum();
    Ribbon {
        arm,
        words: format!("{} times, {} in all", feedback.len(), seconds(driven_s)),
        feedback: filled(&feedback, time, 0.0),
        projected: filled(&stretches(|switch| switch.k != 0.0 && switch.projected), time, 10.0),
    }
}

/// Rectangles from `top` to the lower edge of a ribbon; what is too near to be told apart is one.
fn filled(stretches: &[[f64; 2]], time: Axis, top: f64) -> String {
    let mut drawn: Vec<[f64; 2]> = Vec::new();
    for stretch in stretches {
        let [from, until] = stretch.map(|t_s| time.at(t_s).clamp(0.0, WIDTH));
        let until = until.max(from + LEAST_WIDTH);
        match drawn.last_mut() {
            Some(last) if from - last[1] < LEAST_WIDTH => last[1] = until,
            _ => drawn.push([from, until]),
        }
    }
    let mut path = String::new();
    for [from, until] in drawn {
        // Writing to a String cannot fail.
        let _ = write!(path, "M{} {top}V{RIBBON}H{}V{top}Z", unit(from), unit(until));
    }
    path
}

fn plot(quantity: &Quantity, time: Axis, a: &[&TrackPoint], b: &[&TrackPoint]) -> Option<Plot> {
    let values = |of: fn(&TrackPoint) -> f64| a.iter().chain(b).map(move |point| of(point));
    let asked = quantity.asked.into_iter().flat_map(values);
    let (low, high) = values(quantity.of)
        .chain(asked)
        .filter(|x| x.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    if low > high {
        return None;
    }
    let ends = [HEIGHT, 0.0];
    let (axis, low) = if quantity.logarithmic && high > 0.0 {
        let low = low.max(high * libm::pow(10.0, f64::from(-DECADES)));
        (Axis::logarithmic(low, high, ends), low)
    } else {
        // From 0, so that a line near the frame's edge is a small number.
        let low = low.min(0.0);
        (Axis::linear(low, high.max(0.0), ends), low)
    };
    let [low_shown, high_shown] = axis.range();
    let line = |of: fn(&TrackPoint) -> f64, points: &[&TrackPoint]| {
        path(points.iter().map(|point| [time.at(point.t_s), axis.at(of(point)).clamp(0.0, HEIGHT)]))
    };
    let asked = |points| quantity.asked.map_or_else(String::new, |of| line(of, points));
    let (asked_a, asked_b) = (asked(a), asked(b));
    Some(Plot {
        title: quantity.title,
        unit: quantity.unit,
        low: number(Some(low_shown)),
        high: number(Some(high_shown)),
        zero: (!quantity.logarithmic && low < 0.0 && high > 0.0).then(|| unit(axis.at(0.0))),
        a: line(quantity.of, a),
        b: line(quantity.of, b),
        asked_b: if asked_b == asked_a { String::new() } else { asked_b },
        asked_a,
    })
}
