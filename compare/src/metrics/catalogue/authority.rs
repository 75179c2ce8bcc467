//! Authority: how much the person drives, and how far the command is from what they asked for.

use super::{Feed, Group, Metric};
use crate::metrics::accumulate::Accumulate;
use crate::metrics::agreement::{Cosine, Disagreement, Override};
use crate::metrics::authority::{Chatter, Deadlock, HumanShare, Switches};
use crate::metrics::intervention::{Durations, Interventions};
use crate::metrics::sample::Setting;
use crate::metrics::warrant::{Correction, Verdicts};

const fn row(
    name: &'static str,
    formula: &'static str,
    make: fn(&Setting) -> Box<dyn Accumulate>,
) -> Metric {
    Metric::new(name, Group::Authority, Feed::Decision, formula, make)
}

/// What the judgement of an input is made from.
const JUDGED: &str = "/step and /command; pose, speeds and discs of /truth where there is one; \
                      world, footprint and limits of the scenario";

pub(super) const ROWS: &[Metric] = &[
    row(
        "human_share",
        "mean of the sharing function k over time: 1 when the person always drives",
        |_| Box::new(HumanShare::default()),
    )
    .higher_is_better()
    .primary(),
    row(
        "interventions_per_min",
        "rising edges of |S(u_s - u_h)| > 0.05, merged when less than 0.3 s apart, per minute; \
         steps at which the person's input goes out bit for bit are no intervention",
        |setting| Box::new(Interventions::new(setting.limits)),
    )
    .unit("1/min")
    .primary(),
    row(
        "intervention_p50_s",
        "median duration of the interventions, by nearest rank; undefined without one",
        |setting| Box::new(Durations::new(setting.limits, 0.5)),
    )
    .unit("s"),
    row(
        "intervention_p95_s",
        "95th percentile of the interventions' durations, by nearest rank; undefined without one",
        |setting| Box::new(Durations::new(setting.limits, 0.95)),
    )
    .unit("s"),
    row("switches_per_min", "changes of k, either way, per minute", |_| Box::new(Switches::new()))
        .unit("1/min"),
    row(
        "chatter_per_min",
        "switches of k that undo the one before within 0.5 s, per minute",
        |_| Box::new(Chatter::new()),
    )
    .unit("1/min")
    .primary(),
    row(
        "deadlock_s",
        "time with |S u_h| > 0.05 while the robot moves at |S u| <= 0.02, where motion has been \
         asked for longer than the actuator delay",
        |setting| Box::new(Deadlock::new(setting)),
    )
    .unit("s")
    .primary()
    .after("/step, and /truth where there is one"),
    row("override_m", "integral of |v_s - v_h| over time", |_| Box::new(Override::travel()))
        .unit("m")
        .primary(),
    row("override_rad", "integral of |omega_s - omega_h| over time", |_| {
        Box::new(Override::turning())
    })
    .unit("rad")
    .primary(),
    row("disagreement", "time mean of |S(u_s - u_h)|", |setting| {
        Box::new(Disagreement::new(setting.limits))
    })
    .primary(),
    row(
        "cosine",
        "time mean of <S u_s, S u_h>/(|S u_s| |S u_h|) where |S u_h| > 0.05; 0 where u_s = 0",
        |setting| Box::new(Cosine::new(setting.limits)),
    )
    .higher_is_better(),
    row(
        "unwarranted",
        "share of the time with safe human input in which it was overridden; safe: held for 1 s \
         and braked from, the footprint stays clear",
        |setting| Box::new(Verdicts::unwarranted(setting.limits)),
    )
    .after(JUDGED),
    row(
        "missed",
        "share of the time with unsafe human input in which it was not overridden",
        |setting| Box::new(Verdicts::missed(setting.limits)),
    )
    .after(JUDGED),
    row(
        "necessary",
        "time mean of |S(u* - u_h)|, u* the safe input nearest to the person's",
        |setting| Box::new(Correction::necessary(setting.limits)),
    )
    .after(JUDGED),
    row(
        "excess",
        "time mean of |S(u_s - u*)|: how far the command is from the least correction",
        |setting| Box::new(Correction::excess(setting.limits)),
    )
    .after(JUDGED),
];
