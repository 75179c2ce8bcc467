//! Quantities over time, one panel each.

use serde::Serialize;

use super::recording::{Point, Recording};
use crate::drawing::{Axis, Tick, path, unit};

/// Width of a panel's drawing area, units.
pub(super) const WIDTH: f64 = 660.0;

/// Height of a panel's drawing area, units.
pub(super) const HEIGHT: f64 = 84.0;

/// A panel, ready to be drawn.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Panel {
    title: &'static str,
    height: String,
    ticks: Vec<Tick>,
    lines: Vec<Line>,
}

/// One line of a panel.
#[derive(Clone, Debug, Serialize)]
struct Line {
    class: &'static str,
    label: &'static str,
    /// Where its sample and its label stand in the panel's head.
    sample_at: String,
    label_at: String,
    path: String,
}

/// A quantity of a run: what it is called, how it is drawn, where it stands in a point.
struct Quantity {
    label: &'static str,
    /// How it is drawn: `main`, `other`, `asked`, `low`, `high` (see the template).
    class: &'static str,
    of: fn(&Point) -> f64,
}

/// How the values of a panel become heights.
enum Range {
    /// From the least to the greatest value, 0 included.
    Whole,
    /// From 0 or less to a little more than the quantities with these classes ever have.
    About(&'static [&'static str]),
    /// Decades, at most six.
    Decades,
    /// From 0 to 1.
    Share,
}

struct Content {
    title: &'static str,
    range: Range,
    quantities: &'static [Quantity],
}

const CONTENTS: [Content; 7] = [
    Content {
        title: "danger shown to the person",
        range: Range::Share,
        quantities: &[Quantity { label: "danger", class: "main", of: |p| p.danger }],
    },
    Content {
        title: "forward speed v, m/s",
        range: Range::Whole,
        quantities: &[
            Quantity { label: "asked for", class: "asked", of: |p| p.v_h_mps },
            Quantity { label: "commanded", class: "main", of: |p| p.v_s_mps },
        ],
    },
    Content {
        title: "turn rate ω, rad/s",
        range: Range::Whole,
        quantities: &[
            Quantity { label: "asked for", class: "asked", of: |p| p.omega_h_radps },
            Quantity { label: "commanded", class: "main", of: |p| p.omega_s_radps },
        ],
    },
    Content {
        title: "distance D as compared, m",
        range: Range::About(&["low", "high"]),
        quantities: &[
            Quantity { label: "Dc(b1): dangerous below", class: "low", of: |p| p.critical1_m },
            Quantity { label: "Dc(b2): safe above", class: "high", of: |p| p.critical2_m },
            Quantity { label: "D", class: "main", of: |p| p.effective_m },
        ],
    },
    Content {
        title: "distances of the law, m",
        range: Range::Whole,
        quantities: &[
            Quantity { label: "wanted d_r1", class: "low", of: |p| p.d_r1_m },
            Quantity { label: "d1 ahead", class: "main", of: |p| p.d1_m },
            Quantity { label: "d2 left", class: "other", of: |p| p.d2l_m },
            Quantity { label: "d2 right", class: "third", of: |p| p.d2r_m },
        ],
    },
    Content {
        title: "Lyapunov function",
        range: Range::Decades,
        quantities: &[Quantity { label: "L", class: "main", of: |p| p.lyapunov }],
    },
    Content {
        title: "clearance of the footprint, m",
        range: Range::Whole,
        quantities: &[Quantity { label: "clearance", class: "main", of: |p| p.clearance_m }],
    },
];

/// Ranges are this much longer than their values, so that no line lies on the frame.
const HEADROOM: f64 = 1.06;

/// … and no shorter than this, in the unit of the panel.
const LEAST_RANGE: f64 = 0.05;

/// Where samples of lines begin in a panel's head, their length, and the width of a letter, units.
const LEGEND_AT: f64 = 190.0;
const SAMPLE: f64 = 22.0;
const LETTER: f64 = 6.2;

/// Decades that a logarithmic panel shows at most, below its greatest value.
const DECADES: i32 = 6;

/// The panels of a run, without those in which nothing is known.
pub(super) fn panels(run: &Recording, time: Axis) -> Vec<Panel> {
    CONTENTS.iter().filter_map(|content| panel(content, run, time)).collect()
}

fn panel(content: &Content, run: &Recording, time: Axis) -> Option<Panel> {
    let extent = |classes: Option<&[&str]>| {
        let chosen = content
            .quantities
            .iter()
            .filter(|quantity| classes.is_none_or(|classes| classes.contains(&quantity.class)));
        let values = chosen.flat_map(|quantity| run.points.iter().map(quantity.of));
        values
            .filter(|x| x.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
    };
    let (low, high) = extent(None);
    if low > high {
        return None;
    }
    let ends = [HEIGHT, 0.0];
    let axis = match content.range {
        Range::Share => Axis::linear(0.0, HEADROOM, ends),
        Range::Whole => {
            // Rounding errors are not to fill a panel.
            let (low, high) = (low.min(0.0), high.max(low.min(0.0) + LEAST_RANGE).max(0.0));
            Axis::linear(low * HEADROOM, high * HEADROOM, ends)
        }
        Range::About(classes) => {
            // What is far beyond what it is compared with is only that.
            let (_, top) = extent(Some(classes));
            let top = if top > 0.0 { (2.5 * top).min(high) } else { high };
            Axis::linear(low.max(-0.25 * top).min(0.0), top * HEADROOM, ends)
        }
        Range::Decades => {
            let least = high * libm::pow(10.0, f64::from(-DECADES));
            Axis::logarithmic(low.max(least).max(f64::MIN_POSITIVE), high.max(least), ends)
        }
    };
    let mut legend_at = LEGEND_AT;
    let mut lines = Vec::new();
    for quantity in content.quantities {
        let path = path(run.points.iter().map(|point| {
            // What leaves the panel is cut off at its edge and not drawn far outside.
            let y = axis.at((quantity.of)(point));
            [time.at(point.t_s), y.clamp(-HEIGHT, 2.0 * HEIGHT)]
        }));
        if !path.is_empty() {
            let label_at = legend_at + SAMPLE + 5.0;
            lines.push(Line {
                class: quantity.class,
                label: quantity.label,
                sample_at: unit(legend_at),
                label_at: unit(label_at),
                path,
            });
            legend_at = label_at + LETTER * quantity.label.chars().count() as f64 + 16.0;
        }
    }
    Some(Panel { title: content.title, height: unit(HEIGHT), ticks: axis.ticks(4), lines })
}
