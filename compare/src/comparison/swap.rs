//! Which parameter makes the difference: swapped one at a time from A to B, and back.
//!
//! Both ways, because parameters act together: what a parameter does alone beside A's others, and what
//! is lost when it alone goes back beside B's others. Where the two disagree, it is not the
//! parameter's doing alone.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use super::result::ParameterChange;

/// Metrics of a run, or their means over runs, by name.
pub type Values = BTreeMap<String, f64>;

/// What one parameter does to every metric.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Swap {
    /// The parameter.
    pub key: String,
    /// A with this one of B, less A.
    pub forth: Values,
    /// B, less B with this one of A.
    pub back: Values,
}

/// Swaps the parameters that differ one at a time. `measure` runs A with the named ones taken from B:
/// none for A itself, all for B.
///
/// # Errors
/// What `measure` gives.
pub fn swap_parameters<E>(
    parameters: &[ParameterChange],
    mut measure: impl FnMut(&BTreeSet<&str>) -> Result<Values, E>,
) -> Result<Vec<Swap>, E> {
    let all: BTreeSet<&str> = parameters.iter().map(|change| change.key.as_str()).collect();
    let (a, b) = (measure(&BTreeSet::new())?, measure(&all)?);
    let mut swaps = Vec::new();
    for key in &all {
        let with = measure(&BTreeSet::from([*key]))?;
        let mut others = all.clone();
        others.remove(key);
        let without = measure(&others)?;
        swaps.push(Swap {
            key: (*key).to_owned(),
            forth: less(&with, &a),
            back: less(&b, &without),
        });
    }
    Ok(swaps)
}

/// Differences of what both have.
fn less(of: &Values, other: &Values) -> Values {
    of.iter().filter_map(|(name, x)| Some((name.clone(), x - other.get(name)?))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// y = 10 p + 1 q + 5 p q for parameters that go from 0 to 1: forth 10 and 1, back 15 and 6.
    #[test]
    fn each_parameter_is_swapped_forth_and_back() {
        let change = |key: &str| ParameterChange { key: key.to_owned(), a: None, b: None };
        let mut runs = 0;
        let swaps = swap_parameters::<()>(&[change("p"), change("q")], |of_b| {
            runs += 1;
            let on = |key: &str| f64::from(u8::from(of_b.contains(key)));
            let (p, q) = (on("p"), on("q"));
            Ok(Values::from([("y".to_owned(), 10.0 * p + q + 5.0 * p * q)]))
        })
        .expect("measures");
        let told: Vec<(&str, f64, f64)> =
            swaps.iter().map(|s| (s.key.as_str(), s.forth["y"], s.back["y"])).collect();
        assert_eq!(told, [("p", 10.0, 15.0), ("q", 1.0, 6.0)]);
        assert_eq!(runs, 6);
    }

    #[test]
    fn nothing_differs_and_what_fails() {
        assert_eq!(swap_parameters::<()>(&[], |_| Ok(Values::new())), Ok(Vec::new()));
        assert_eq!(swap_parameters(&[], |_| Err("stopped")), Err("stopped"));
    }
}
