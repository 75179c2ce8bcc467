//! One offline HTML page.
//!
//! No script, no network, no file beside it: the page's own policy forbids them. Everything that
//! comes from a log or a command line is escaped by the template engine, which escapes whatever a
//! template does not declare safe; ours declares nothing safe.

use minijinja::Environment;
use minijinja::value::Serde;
use serde::Serialize;

use super::map::{Map, map};
use super::plot::{Timeline, timeline};
use super::view::View;
use crate::CompareError;
use crate::comparison::{Comparison, ViolationRecord};

/// The name ends in `.html`, which turns escaping on.
const TEMPLATE: &str = "page.html";

/// What the template sees.
#[derive(Serialize)]
struct Page {
    #[serde(flatten)]
    view: View,
    undefined: String,
    pictures: Vec<Picture>,
}

/// The drawings of one log, in the order of the logs.
#[derive(Serialize)]
struct Picture {
    map: Option<Map>,
    timeline: Option<Timeline>,
}

/// The comparison as a page, verdict first.
///
/// # Errors
/// [`CompareError::Page`]; the template is part of the program, so that is not expected.
pub fn html(comparison: &Comparison) -> Result<String, CompareError> {
    let mut environment = Environment::new();
    environment.add_template(TEMPLATE, include_str!("page.html"))?;
    let view = View::new(comparison);
    let page = Page {
        undefined: view.undefined_metrics().join(", "),
        pictures: pictures(comparison),
        view,
    };
    Ok(environment.get_template(TEMPLATE)?.render(Serde(&page))?)
}

fn pictures(comparison: &Comparison) -> Vec<Picture> {
    comparison
        .scenes
        .iter()
        .map(|scene| {
            let violations: Vec<&ViolationRecord> =
                comparison.violations.iter().filter(|v| v.log == scene.log).collect();
            Picture { map: map(scene, &violations), timeline: timeline(scene) }
        })
        .collect()
}
