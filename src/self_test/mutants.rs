//! The mutants: one parameter changed, or one thing done wrong in the code.

use anyhow::Result;
use controller::{Law, Mutation, Spec};
use schemas::Node;
use toml::Value;

/// What is different about a mutant.
#[derive(Clone, Copy, Debug)]
enum Change {
    /// Numbers multiplied.
    Scaled(&'static [&'static str], f64),
    /// A name exchanged for the other one of two.
    Exchanged(&'static str, [&'static str; 2]),
    /// Code that is wrong.
    Wrong(Mutation),
}

/// A controller that is wrong on purpose.
#[derive(Clone, Debug)]
pub struct Mutant {
    /// What is wrong with it.
    pub name: String,
    /// The stages that this is in.
    pub nodes: &'static [Node],
    change: Change,
}

/// Which parameters are raised and lowered by a tenth, and where they act.
const SCALED: [(&str, &[&str], &[Node]); 9] = [
    ("gamma1", &["gamma1"], &[Node::Law]),
    ("gamma2", &["gamma2"], &[Node::Law]),
    ("gamma3", &["gamma3"], &[Node::Law]),
    ("gamma4", &["gamma4"], &[Node::Law]),
    ("gamma5", &["gamma5"], &[Node::Law]),
    ("cap_m", &["cap_m"], &[Node::Distances]),
    ("r_m", &["r_m"], &[Node::Reference]),
    ("epsilon_m", &["epsilon_m"], &[Node::Reference]),
    // Together, since b2 is to stay above b1.
    ("b1 and b2", &["b1_task_m", "b2_task_m", "b1_free_m", "b2_free_m"], &[Node::Sharing]),
];

/// What only the dynamic law uses.
const DYNAMIC_ONLY: [&str; 2] = ["gamma4", "gamma5"];

/// Which names are exchanged, and where they act.
const EXCHANGED: [(&str, [&str; 2], &[Node]); 8] = [
    ("frame", ["wall", "ref"], &[Node::Distances]),
    ("d_body", ["footprint", "disc"], &[Node::Distances]),
    ("law_body", ["lane", "disc"], &[Node::Distances]),
    ("side_rule", ["near", "printed"], &[Node::Reference]),
    ("branch_signs", ["sigma", "left"], &[Node::Law]),
    ("wait", ["always", "never"], &[Node::Sharing]),
    ("saturation", ["scale", "clip"], &[Node::Command]),
    // The safety layer also says whether the person may drive.
    ("projection", ["both", "none"], &[Node::Sharing, Node::Command]),
];

/// The mutants of a controller; those that only sonars can tell from it are among them if there are
/// any.
pub fn mutants(law: Law, sonars: bool) -> Vec<Mutant> {
    let mut all = Vec::new();
    for (name, keys, nodes) in SCALED {
        if law == Law::Dynamic || !DYNAMIC_ONLY.contains(&name) {
            for (words, factor) in [("+10 %", 1.1), ("-10 %", 0.9)] {
                let change = Change::Scaled(keys, factor);
                all.push(Mutant { name: format!("{name} {words}"), nodes, change });
            }
        }
    }
    for (key, names, nodes) in EXCHANGED {
        all.push(Mutant {
            name: format!("the other {key}"),
            nodes,
            change: Change::Exchanged(key, names),
        });
    }
    for mutation in Mutation::ALL {
        if sonars || mutation != Mutation::SonarDropped {
            let nodes = Node::ALL.iter().position(|node| *node == mutation.node());
            all.push(Mutant {
                name: mutation.name().to_owned(),
                nodes: nodes.map_or(&[], |i| &Node::ALL[i..=i]),
                change: Change::Wrong(mutation),
            });
        }
    }
    all
}

impl Mutant {
    /// What to run in place of a controller. `None` where the change is none: a gain of 0 has no tenth.
    ///
    /// # Errors
    /// A value is out of its range.
    pub fn of(&self, spec: &Spec) -> Result<Option<(Spec, Option<Mutation>)>> {
        let mut mutant = spec.clone();
        match self.change {
            Change::Wrong(mutation) => return Ok(Some((mutant, Some(mutation)))),
            Change::Scaled(keys, factor) => {
                let table: toml::Table = spec.params_toml().parse()?;
                for key in keys {
                    let value = table.get(*key).and_then(Value::as_float).unwrap_or(f64::NAN);
                    mutant.params.set(key, &Value::Float(factor * value))?;
                }
            }
            Change::Exchanged(key, [one, other]) => {
                let table: toml::Table = spec.params_toml().parse()?;
                let is_one = table.get(key).and_then(Value::as_str) == Some(one);
                let name = if is_one { other } else { one };
                mutant.params.set(key, &Value::String(name.to_owned()))?;
            }
        }
        Ok((mutant.params != spec.params).then_some((mutant, None)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every mutant of every version that shares changes something, and one thing.
    #[test]
    fn mutants_differ_from_what_they_are_made_of() {
        for version in controller::versions().iter().filter(|v| v.law != Law::Human) {
            let spec = Spec::resolve(version.name, &[]).unwrap();
            let all = mutants(spec.law, true);
            assert!(all.len() >= 25, "{}", all.len());
            for mutant in all {
                let Some((changed, mutation)) = mutant.of(&spec).unwrap() else {
                    // gamma5 is 0 as printed.
                    assert!(mutant.name.starts_with("gamma5"), "{}", mutant.name);
                    continue;
                };
                assert_ne!(changed.params != spec.params, mutation.is_some(), "{}", mutant.name);
                let pairs = spec.params.settings().into_iter().zip(changed.params.settings());
                let different = pairs.filter(|(a, b)| a != b).count();
                let most = if mutant.name.starts_with("b1 and b2") { 4 } else { 1 };
                assert!(different <= most, "{}: {different}", mutant.name);
            }
        }
    }
}
