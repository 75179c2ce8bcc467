//! An explanation for a person.

use std::fmt::Write as _;

use compare::report::{number, with_unit};

use super::account::{Explanation, Side};
use super::words::{metres, pair, ray, turned};

/// How many echoes are listed.
const ECHOES: usize = 6;

/// The explanation as text: sentences first, then the numbers along the controller's data flow.
pub fn text(told: &Explanation) -> String {
    let mut page = Page(String::new());
    page.line(format!(
        "{}, step {} at {:.2} s ({}): {}, scenario {}, {} sensors",
        told.log, told.step_index, told.t_s, told.at, told.controller, told.scenario, told.sensors
    ));
    page.gap();
    for sentence in &told.summary {
        page.line(sentence.clone());
    }
    if let Some(why) = &told.untraced {
        page.line(format!("Rays and echoes are not named: {why}."));
    }
    sets(&mut page, told);
    distances(&mut page, told);
    law(&mut page, told);
    inputs(&mut page, told);
    changed(&mut page, told);
    echoes(&mut page, told);
    truth(&mut page, told);
    page.0
}

/// Text that grows line by line; writing to a String cannot fail.
struct Page(String);

impl Page {
    fn line(&mut self, line: impl AsRef<str>) {
        let _ = writeln!(self.0, "{}", line.as_ref().trim_end());
    }

    fn gap(&mut self) {
        self.0.push('\n');
    }

    fn title(&mut self, title: &str) {
        self.gap();
        self.line(title);
    }

    fn row(&mut self, label: &str, text: impl AsRef<str>) {
        self.line(format!("  {label:11} {}", text.as_ref()));
    }
}

/// Why D is not compared as it was measured.
fn why(d_m: f64, effective_m: f64) -> &'static str {
    if effective_m > d_m {
        "sonars make D too short (`sonar_shortfall_m`)"
    } else {
        "less guard and one period's travel"
    }
}

fn sets(page: &mut Page, told: &Explanation) {
    let sets = &told.sets;
    page.title("Sets (12)");
    page.row("region", format!("{}, danger {}", sets.region, number(Some(sets.danger))));
    for asked in &sets.asked {
        let about = format!(
            "{} velocity {}",
            asked.about,
            pair([asked.v_mps, asked.omega_radps], ["m/s", "rad/s"])
        );
        page.row("asked about", about);
        let Some(d_m) = asked.distance_m else { continue };
        let way = asked.ray.as_ref().map_or_else(String::new, ray);
        page.row("  D", format!("{}  {way}", metres(d_m)));
        if let Some(effective_m) = asked.effective_m.filter(|effective_m| *effective_m != d_m) {
            page.row(
                "  D_eff",
                format!("{}  as compared: {}", metres(effective_m), why(d_m, effective_m)),
            );
        }
        page.row("  Dc(b1)", format!("{}  dangerous up to here", metres(asked.critical1_m)));
        page.row(
            "  Dc(b2)",
            format!(
                "{}  safe from here; by itself {}",
                metres(asked.critical2_m),
                asked.region.unwrap_or("unknown")
            ),
        );
    }
    if let (Some(b1_m), Some(b2_m)) = (sets.b1_m, sets.b2_m) {
        page.row(
            "by",
            format!(
                "b1 = {}, b2 = {}, sets `{}`, D along `{}`",
                metres(b1_m),
                metres(b2_m),
                sets.form.unwrap_or_default(),
                sets.d_mode.unwrap_or_default()
            ),
        );
    }
}

fn distances(page: &mut Page, told: &Explanation) {
    let distances = &told.distances;
    page.title("Distances of the law");
    page.row(
        "frame",
        format!(
            "e1 at {:.1}° from `{}`, turning at {} rad/s; side {}",
            distances.psi_deg,
            distances.frame,
            number(Some(distances.omega_r_radps)),
            distances.side
        ),
    );
    for (name, side) in
        [("d1", &distances.ahead), ("d2l", &distances.left), ("d2r", &distances.right)]
    {
        page.row(name, side_text(side, distances.cap_m));
    }
}

fn side_text(side: &Side, cap_m: Option<f64>) -> String {
    let mut text = metres(side.d_m);
    if let Some(cap_m) = cap_m.filter(|cap_m| side.d_m == *cap_m) {
        let free = side.ray.as_ref().map_or_else(String::new, |ray| {
            if ray.free_m.is_finite() {
                format!(" of {}", metres(ray.free_m))
            } else {
                String::new()
            }
        });
        let _ = write!(text, "{free} (capped at {})", metres(cap_m));
    }
    if let Some(told) = &side.ray {
        let _ = write!(text, "  {}", ray(told));
    }
    if let (Some(wanted_m), Some(admissible_m), Some(z)) =
        (side.wanted_m, side.admissible_m, side.z)
    {
        let _ = write!(
            text,
            "; wanted {}, admissible {}, z = {}",
            metres(wanted_m),
            metres(admissible_m),
            number(Some(z))
        );
    }
    text
}

fn law(page: &mut Page, told: &Explanation) {
    let law = &told.law;
    page.title("Feedback law");
    page.row("branch", format!("{}: {}", law.branch, law.words));
    page.row(
        "target",
        format!(
            "({}, {}) m from `{}`, moving at ({}, {}) m/s",
            number(Some(law.target_m[0])),
            number(Some(law.target_m[1])),
            law.reference,
            number(Some(law.target_mps[0])),
            number(Some(law.target_mps[1]))
        ),
    );
    page.row(
        "wants",
        format!(
            "v* = {} m/s; heading in the frame {:.1}°, wanted {:.1}°, off by {:.1}°; turn rate {} rad/s",
            number(Some(law.v_star_mps)),
            law.theta_e_deg,
            law.theta_star_deg,
            law.error_deg,
            number(Some(law.omega_star_radps))
        ),
    );
    page.row("Lyapunov", number(Some(law.lyapunov)));
    page.row("u_f", pair(law.u_f, told.request.units));
}

fn inputs(page: &mut Page, told: &Explanation) {
    let (request, safety) = (&told.request, &told.safety);
    page.title("From the request to the command");
    page.row(
        "asked",
        format!(
            "{}, {} old",
            pair([request.v_h_mps, request.omega_h_radps], ["m/s", "rad/s"]),
            with_unit(&number(Some(request.joystick_age_s)), "s")
        ),
    );
    page.row("u_h", format!("{}  within the limits", pair(request.u_h, request.units)));
    let chosen = if told.k == 1.0 { "the person's" } else { "the law's, or a stop" };
    let s1 = if safety.saturated { ", brought down by S1" } else { "" };
    page.row("chosen", format!("{}  {chosen}{s1}", pair(safety.before_projection, request.units)));
    let projection = match (safety.layer, safety.projected) {
        (false, _) => "this version has no projection".to_owned(),
        (true, true) => format!("the projection took away {}", pair(safety.taken, request.units)),
        (true, false) => "the projection took nothing away".to_owned(),
    };
    page.row("applied", format!("{}  {projection}", pair(safety.after_projection, request.units)));
    if let Some(limit) = &safety.ray {
        page.row("looked", format!("{} free  {}", metres(limit.free_m), ray(limit)));
    }
    if let (Some(v_mps), Some(omega_radps)) = (request.v_mps, request.omega_radps) {
        page.row("commanded", pair([v_mps, omega_radps], ["m/s", "rad/s"]));
    }
}

fn changed(page: &mut Page, told: &Explanation) {
    let changed = &told.changed;
    if changed.rows.is_empty() {
        return;
    }
    let at = |t_s: Option<f64>| t_s.map_or_else(|| "-".to_owned(), |t_s| format!("{t_s:.2} s"));
    page.title("What changed: since the last step with another k, since the step before");
    let row = |cells: [&str; 4]| {
        let [field, then, before, now] = cells;
        format!("  {field:30} {then:>18} {before:>18} {now:>18}")
    };
    page.line(row(["", &at(changed.before_change_s), &at(changed.before_s), &at(Some(told.t_s))]));
    for told in &changed.rows {
        let unit = if told.unit.is_empty() { String::new() } else { format!(" ({})", told.unit) };
        page.line(row([
            // The unit stands in the name already, but for angles.
            &if told.unit == "°" {
                format!("{}{unit}", told.field)
            } else {
                told.field.to_owned()
            },
            told.before_change.as_deref().unwrap_or("-"),
            told.before.as_deref().unwrap_or("-"),
            &told.now,
        ]));
    }
}

fn echoes(page: &mut Page, told: &Explanation) {
    if told.echoes.is_empty() {
        return;
    }
    page.title("Nearest echoes");
    for echo in told.echoes.iter().take(ECHOES) {
        page.row(
            &format!("sonar {}", echo.sonar),
            format!(
                "{}  {}, {:.2} s before",
                echo.range_m.map_or_else(|| "no echo".to_owned(), metres),
                turned(echo.bearing_deg),
                echo.heard_s_before
            ),
        );
    }
    if told.echoes.len() > ECHOES {
        page.line(format!(
            "  and {} farther ones (--format json lists all)",
            told.echoes.len() - ECHOES
        ));
    }
}

fn truth(page: &mut Page, told: &Explanation) {
    let Some(truth) = &told.truth else { return };
    page.title("Really (simulation)");
    page.row(
        "clearance",
        format!(
            "{}{}",
            metres(truth.clearance_m),
            truth.nearest.as_ref().map_or_else(String::new, |thing| format!("  to {thing}"))
        ),
    );
    page.row(
        "pose",
        format!(
            "({}, {}) m, {:.1}°; {}",
            number(Some(truth.x_m)),
            number(Some(truth.y_m)),
            truth.theta_deg,
            pair([truth.v_mps, truth.omega_radps], ["m/s", "rad/s"])
        ),
    );
    page.row(
        "estimate",
        format!("off by {} and {:.1}°", metres(truth.estimate_off_m), truth.estimate_off_deg),
    );
}
