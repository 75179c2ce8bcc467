//! Which parameters differ between the arms.

use std::collections::BTreeSet;

use super::result::ParameterChange;

/// The parameters that differ, by key. What cannot be read as TOML has none.
pub(super) fn parameters(a_toml: &str, b_toml: &str) -> Vec<ParameterChange> {
    let read = |text: &str| toml::from_str::<toml::Table>(text).unwrap_or_default();
    let (a, b) = (read(a_toml), read(b_toml));
    let keys: BTreeSet<&String> = a.keys().chain(b.keys()).collect();
    keys.into_iter()
        .filter(|key| a.get(*key) != b.get(*key))
        .map(|key| ParameterChange {
            key: key.clone(),
            a: a.get(key).map(ToString::to_string),
            b: b.get(key).map(ToString::to_string),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_that_differ_are_told_with_both_values() {
        let changes = parameters(
            "gamma3 = 2.0\nframe = \"wall\"\nonly_a = 1\nsame = 3.5\n",
            "gamma3 = 2.1\nframe = \"ref\"\nsame = 3.5\n",
        );
        let told: Vec<(&str, Option<&str>, Option<&str>)> =
            changes.iter().map(|c| (c.key.as_str(), c.a.as_deref(), c.b.as_deref())).collect();
        assert_eq!(
            told,
            [
                ("frame", Some("\"wall\""), Some("\"ref\"")),
                ("gamma3", Some("2.0"), Some("2.1")),
                ("only_a", Some("1"), None),
            ]
        );
        assert!(parameters("not toml = = 1", "").is_empty());
    }
}
