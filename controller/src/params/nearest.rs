//! The existing name nearest to a mistyped one.

/// Edit distance (Levenshtein): insertions, deletions and replacements that turn `a` into `b`.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, cb) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(ca != *cb);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

/// The candidate that `name` abbreviates, else that with the smallest edit distance; the first of
/// equals; empty if there is no candidate.
pub(crate) fn nearest<'a>(name: &str, candidates: impl Iterator<Item = &'a str>) -> &'a str {
    candidates
        .min_by_key(|candidate| (!candidate.starts_with(name), distance(name, candidate)))
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_of_known_words() {
        assert_eq!(distance("kitten", "sitting"), 3);
        assert_eq!(distance("", "abc"), 3);
        assert_eq!(distance("abc", "abc"), 0);
    }

    #[test]
    fn the_nearest_is_found() {
        assert_eq!(nearest("gama1", ["gamma3", "gamma1", "lambda"].into_iter()), "gamma1");
        assert_eq!(nearest("gam", ["lam", "gamma"].into_iter()), "gamma");
        assert_eq!(nearest("x", std::iter::empty()), "");
    }
}
