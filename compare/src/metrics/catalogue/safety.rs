//! Safety: whether anything was hit, and how nearly.

use super::{Feed, Group, Metric};
use crate::metrics::accumulate::Accumulate;
use crate::metrics::clearance::{MinClearance, NearMiss};
use crate::metrics::contact::{Collisions, ContactSpeed};
use crate::metrics::invariance::{Barrier, Breaches, FirstBreach, WorstBreach};
use crate::metrics::sample::Setting;
use crate::metrics::ttc::{MinTtc, StopMargin, TtcExposure};

const fn row(
    name: &'static str,
    formula: &'static str,
    make: fn(&Setting) -> Box<dyn Accumulate>,
) -> Metric {
    Metric::new(name, Group::Safety, Feed::Motion, formula, make)
}

pub(super) const ROWS: &[Metric] = &[
    row("min_clearance_m", "least signed clearance d of the footprint over the run", |_| {
        Box::new(MinClearance::new())
    })
    .unit("m")
    .higher_is_better()
    .primary(),
    row("collisions", "number of maximal intervals with d <= 0, moving discs included", |_| {
        Box::new(Collisions::default())
    })
    .primary(),
    row(
        "contact_speed_mps",
        "greatest |v| at the first sample of a collision; undefined without one",
        |_| Box::new(ContactSpeed::default()),
    )
    .unit("m/s")
    .primary(),
    row(
        "min_ttc_s",
        "least time to collision: first time <= 3 s at which the footprint touches something when \
         it goes on at its present (v, omega) and the discs as they do; 3 where nothing is met",
        |_| Box::new(MinTtc::new()),
    )
    .unit("s")
    .higher_is_better(),
    row("ttc_exposure_s", "time with a time to collision below 1.5 s", |_| {
        Box::new(TtcExposure::default())
    })
    .unit("s")
    .after(
        "/truth, or the estimate in /step with the scenario's world; TET of Minderhoud and Bovy \
         (2001), threshold of van der Horst (1990)",
    ),
    row("near_miss_s", "time with 0 < d < 0.1 m", |_| Box::new(NearMiss::default()))
        .unit("s")
        .primary(),
    row(
        "stop_margin_m",
        "least d - |v| t_react - v^2/(2 a_max), t_react the actuator delay and 0.1 s: what an \
         emergency stop would have left",
        |setting| Box::new(StopMargin::new(setting)),
    )
    .unit("m")
    .higher_is_better(),
    row(
        "invariance_breaches",
        "number of maximal intervals in which the body overlaps a wall or an obstacle: leavings \
         of the static admissible set",
        |_| Box::new(Breaches::default()),
    )
    .primary(),
    row(
        "invariance_first_s",
        "when the static admissible set was first left; undefined if never",
        |_| Box::new(FirstBreach::default()),
    )
    .unit("s")
    .higher_is_better(),
    row("invariance_worst_m", "deepest overlap with a wall or an obstacle, 0 if none", |_| {
        Box::new(WorstBreach::default())
    })
    .unit("m"),
    row(
        "barrier_breaches",
        "number of maximal intervals with h(x+) < (1 - gamma) h(x), h the clearance from what \
         stands still, gamma = 0.5 per 0.1 s",
        |_| Box::new(Barrier::default()),
    )
    .after(
        "/truth, or the estimate in /step with the scenario's world; discrete control barrier \
         functions, Agrawal and Sreenath (2017)",
    ),
];
