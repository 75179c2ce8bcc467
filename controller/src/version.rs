//! The versions of the controller that exist, each a row of data.

use crate::params::Setting;
use crate::params::Setting::{Name, Number};
use crate::spec::Law;

/// A named version of the controller: a law, and how its parameters differ from the table's
/// defaults.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Version {
    /// The name on the command line and in logs.
    pub name: &'static str,
    /// The law that it runs.
    pub law: Law,
    /// What it is, in a sentence.
    pub summary: &'static str,
    /// Where its parameters differ from [`crate::Params::table`]: groups of keys and values, each laid
    /// over those before it.
    pub differences: &'static [&'static [(&'static str, Setting)]],
}

/// What both versions of the paper's laws have as printed.
const PRINTED: &[(&str, Setting)] = &[
    ("frame", Name("ref")),
    ("side_rule", Name("printed")),
    ("branch_signs", Name("left")),
    ("sets", Name("printed")),
    ("d_mode_task", Name("heading")),
    ("d_mode_free", Name("heading")),
    ("d_body", Name("disc")),
    ("law_body", Name("disc")),
    ("wait", Name("never")),
    ("reverse_law", Name("same")),
    ("margin", Name("never")),
    ("sonar_shortfall_m", Number(0.0)),
    ("v_rest_mps", Number(0.0)),
    ("saturation", Name("clip")),
    ("projection", Name("none")),
];

const VERSIONS: &[Version] = &[
    Version {
        name: "paper-kinematic",
        law: Law::Kinematic,
        summary: "the kinematic law, sets and hysteresis as printed in the paper; the baseline, which may hit things",
        differences: &[PRINTED],
    },
    Version {
        name: "tandem-kinematic",
        law: Law::Kinematic,
        summary: "the kinematic law with the paper's errata mended, limits that keep the path, and the safety layer",
        differences: &[],
    },
    Version {
        name: "paper-dynamic",
        law: Law::Dynamic,
        summary: "the dynamic law, sets and hysteresis as printed in the paper; the baseline, which may hit things",
        differences: &[
            PRINTED,
            &[
                ("gamma1", Number(0.3)),
                ("gamma2", Number(0.3)),
                ("gamma3", Number(4.0)),
                ("gamma5", Number(0.0)),
                ("lambda", Number(1.0)),
                ("control_period_s", Number(0.01)),
            ],
        ],
    },
    Version {
        name: "tandem-dynamic",
        law: Law::Dynamic,
        summary: "the dynamic law with the paper's errata mended and damping of the heading error, with limits and the safety layer",
        differences: &[&[
            ("gamma1", Number(0.3)),
            ("gamma2", Number(0.3)),
            ("gamma3", Number(4.0)),
            ("control_period_s", Number(0.01)),
            ("v_rest_mps", Number(0.01)),
        ]],
    },
    Version {
        name: "human",
        law: Law::Human,
        summary: "the person drives alone (k = 1); the law is computed and logged but never applied",
        differences: &[&[("saturation", Name("clip")), ("projection", Name("none"))]],
    },
];

/// Every version that works, in the order of a list.
pub fn versions() -> &'static [Version] {
    VERSIONS
}
