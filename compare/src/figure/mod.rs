//! One run as a picture: a map with the way and who drove on it, and quantities over time.
//!
//! In: what a run says about itself and its events, through a [`Recording`]. Out: one SVG file that
//! stands alone, in light and dark, and the [`Facts`] that can be read off it.

mod map;
mod panel;
mod recording;
#[cfg(test)]
mod tests;

use minijinja::Environment;
use minijinja::value::Serde;
use serde::Serialize;

pub use recording::Recording;

use self::map::Map;
use self::panel::{Panel, WIDTH};
use crate::CompareError;
use crate::drawing::{Axis, Tick, unit};

/// The name ends in `.xml`, which turns escaping on.
const TEMPLATE: &str = "figure.xml";

/// Where the panels begin from the left, and how far apart they are, units.
const LEFT: f64 = 50.0;
const PITCH: f64 = panel::HEIGHT + 30.0;

/// What can be read off a figure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Facts {
    /// How long the run is, seconds.
    pub duration_s: f64,
    /// Stretches in which the feedback law drives: from, until, seconds.
    pub feedback_s: Vec<[f64; 2]>,
    /// Share of the time in which it does.
    pub feedback_share: f64,
    /// Least clearance of the footprint, metres, and when; `None` where it is not known.
    pub least_clearance_m: Option<f64>,
    /// When that is, seconds.
    pub least_clearance_at_s: Option<f64>,
    /// Where the run ends, metres.
    pub end_m: [f64; 2],
}

/// What the template sees.
#[derive(Serialize)]
struct Picture {
    title: String,
    width: String,
    height: String,
    left: String,
    panel_width: String,
    map: Option<Map>,
    panels: Vec<(String, Panel)>,
    ticks: Vec<Tick>,
    /// Where the feedback law drives: left edge and width.
    feedback: Vec<[String; 2]>,
    axis_at: String,
}

/// The figure of a run, and what can be read off it.
///
/// # Errors
/// [`CompareError::NoSteps`] where the run held no step, since then there is nothing to draw;
/// [`CompareError::Page`], which is not expected, since the template is part of the program.
pub fn figure(run: Recording) -> Result<(String, Facts), CompareError> {
    let run = run.finished().ok_or(CompareError::NoSteps { events: 0 })?;
    let time = Axis::linear(0.0, run.end_s, [0.0, WIDTH]);
    let (map, map_height) = map::map(&run).unzip();
    let top = 46.0 + map_height.map_or(0.0, |height| height + 58.0);
    let panels: Vec<(String, Panel)> = panel::panels(&run, time)
        .into_iter()
        .enumerate()
        .map(|(i, panel)| (unit(top + i as f64 * PITCH), panel))
        .collect();
    let bottom = top + panels.len() as f64 * PITCH - 30.0;
    let info = &run.header.run;
    let picture = Picture {
        title: format!(
            "{}: {}, {} sensors{}",
            info.scenario,
            info.controller,
            info.sensors,
            if run.cut_short { "; only a part, the log is damaged" } else { "" }
        ),
        width: unit(LEFT + WIDTH + 20.0),
        height: unit(bottom + 40.0),
        left: unit(LEFT),
        panel_width: unit(WIDTH),
        map,
        panels,
        ticks: time.ticks(8),
        feedback: run
            .feedback_s()
            .iter()
            .map(|[from_s, until_s]| {
                let (from, until) = (time.at(*from_s), time.at(*until_s));
                [unit(from), unit((until - from).max(0.5))]
            })
            .collect(),
        axis_at: unit(bottom + 14.0),
    };
    let mut environment = Environment::new();
    environment.add_template(TEMPLATE, include_str!("figure.svg"))?;
    let text = environment.get_template(TEMPLATE)?.render(Serde(&picture))?;
    Ok((text, facts(&run)))
}

fn facts(run: &Recording) -> Facts {
    let feedback_s = run.feedback_s();
    let driven_s: f64 = feedback_s.iter().map(|[from_s, until_s]| until_s - from_s).sum();
    let nearest = run
        .points
        .iter()
        .filter(|point| !point.clearance_m.is_nan())
        .min_by(|a, b| a.clearance_m.total_cmp(&b.clearance_m));
    // A part of a session begins late.
    let begins_s = run.points.first().map_or(0.0, |point| point.t_s);
    let duration_s = run.end_s - begins_s;
    Facts {
        duration_s,
        feedback_share: if duration_s > 0.0 { driven_s / duration_s } else { 0.0 },
        feedback_s,
        least_clearance_m: nearest.map(|point| point.clearance_m),
        least_clearance_at_s: nearest.map(|point| point.t_s),
        end_m: run.points.last().map_or([f64::NAN; 2], |point| point.pose.position_m()),
    }
}
