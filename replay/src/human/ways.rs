//! The cheapest ways to many ends, in the memory of few.
//!
//! The Viterbi algorithm remembers for each block and each candidate where its cheapest way came from. But
//! ways that end in different places have most of the past in common, and a way is a few long stretches of
//! one candidate each: kept are these, each once for all the ways that go through it, and none that no way
//! goes through any more.

/// A stretch of a way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Stretch {
    /// Its first block.
    pub(super) from: usize,
    /// The candidate that holds throughout.
    pub(super) candidate: usize,
}

/// A stretch that is over, and the one before it.
#[derive(Clone, Copy, Debug)]
struct Past {
    stretch: Stretch,
    before: Option<usize>,
}

/// The newest stretch of the way to a candidate: its beginning, and the past before it.
#[derive(Clone, Copy, Debug, Default)]
struct Newest {
    from: usize,
    before: Option<usize>,
}

/// Past stretches that are put up with before those that nobody needs are looked for.
const LITTER: usize = 4096;

/// The cheapest way to each candidate so far.
#[derive(Debug)]
pub(super) struct Ways {
    newest: Vec<Newest>,
    /// Each stands after the one before it.
    past: Vec<Past>,
    /// Once there are so many past stretches, those that no way goes through are dropped.
    full: usize,
}

impl Ways {
    /// Ways to so many candidates, each of which holds from the first block on.
    pub(super) fn new(candidates: usize) -> Ways {
        Ways { newest: vec![Newest::default(); candidates], past: Vec::new(), full: LITTER }
    }

    /// Candidates are about to be changed to, all of them from the one way to `best`, at this block.
    pub(super) fn changes(&mut self, best: usize, block: usize) -> Changes<'_> {
        if self.past.len() >= self.full {
            self.tidy();
        }
        let last = self.newest.get(best).copied().unwrap_or_default();
        Changes { ways: self, best, last, before: None, block }
    }

    /// The way to a candidate, from its first stretch to its last.
    pub(super) fn to(&self, candidate: usize) -> Vec<Stretch> {
        let Some(newest) = self.newest.get(candidate) else { return Vec::new() };
        let mut way = vec![Stretch { from: newest.from, candidate }];
        let mut before = newest.before;
        while let Some(past) = before.map(|at| self.past[at]) {
            way.push(past.stretch);
            before = past.before;
        }
        way.reverse();
        way
    }

    /// Drops the stretches that no way goes through.
    fn tidy(&mut self) {
        let mut needed = vec![false; self.past.len()];
        for newest in &self.newest {
            let mut at = newest.before;
            while let Some(index) = at.filter(|index| !needed[*index]) {
                needed[index] = true;
                at = self.past[index].before;
            }
        }
        let mut places = vec![0; self.past.len()];
        let mut kept = 0;
        for index in (0..needed.len()).filter(|index| needed[*index]) {
            let Past { stretch, before } = self.past[index];
            self.past[kept] = Past { stretch, before: before.map(|before| places[before]) };
            places[index] = kept;
            kept += 1;
        }
        self.past.truncate(kept);
        for newest in &mut self.newest {
            newest.before = newest.before.map(|before| places[before]);
        }
        self.full = 2 * kept + LITTER;
    }
}

/// Changes at one block.
pub(super) struct Changes<'a> {
    ways: &'a mut Ways,
    best: usize,
    last: Newest,
    /// Where the stretch that ends stands, once there was a change.
    before: Option<usize>,
    block: usize,
}

impl Changes<'_> {
    /// From here on the cheapest way to `candidate` is a change to it.
    pub(super) fn to(&mut self, candidate: usize) {
        let past = &mut self.ways.past;
        let before = *self.before.get_or_insert_with(|| {
            let stretch = Stretch { from: self.last.from, candidate: self.best };
            past.push(Past { stretch, before: self.last.before });
            past.len() - 1
        });
        self.ways.newest[candidate] = Newest { from: self.block, before: Some(before) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        /// The way to each candidate is that of a table which keeps every block, tidied or not.
        #[test]
        fn ways_are_those_of_the_whole_table(
            candidates in 2..9_usize,
            blocks in prop::collection::vec((any::<prop::sample::Index>(), any::<u16>()), 0..300),
            tidies in 1..20_usize,
        ) {
            let mut ways = Ways::new(candidates);
            let mut table = Vec::new();
            for (block, (best, changed)) in blocks.iter().enumerate() {
                let best = best.index(candidates);
                let changed = |candidate: usize| {
                    candidate != best && changed >> candidate & 1 == 1
                };
                if block % tidies == 0 {
                    ways.tidy();
                }
                let mut changes = ways.changes(best, block);
                (0..candidates).filter(|to| changed(*to)).for_each(|to| changes.to(to));
                table.push((0..candidates).map(|to| if changed(to) { best } else { to }).collect());
            }
            let table: Vec<Vec<usize>> = table;
            for candidate in 0..candidates {
                let mut at = candidate;
                let mut path = vec![0; blocks.len()];
                for block in (0..blocks.len()).rev() {
                    path[block] = at;
                    at = table[block][at];
                }
                let way = ways.to(candidate);
                prop_assert_eq!(way[0].from, 0);
                for (block, candidate) in path.into_iter().enumerate() {
                    let holds = way.iter().rfind(|stretch| stretch.from <= block);
                    prop_assert_eq!(holds.map(|stretch| stretch.candidate), Some(candidate));
                }
            }
        }
    }

    /// Ten thousand blocks in which all but the best change leave the best one's stretch and nothing else.
    #[test]
    fn what_no_way_goes_through_is_dropped() {
        let mut ways = Ways::new(100);
        for block in 0..10_000 {
            let mut changes = ways.changes(3, block);
            (0..100).filter(|to| *to != 3).for_each(|to| changes.to(to));
            assert!(ways.past.len() <= LITTER + 200);
        }
        ways.tidy();
        assert_eq!(ways.past.len(), 1);
        assert_eq!(ways.to(3), [Stretch { from: 0, candidate: 3 }]);
        assert_eq!(ways.to(4)[1], Stretch { from: 9_999, candidate: 4 });
    }
}
