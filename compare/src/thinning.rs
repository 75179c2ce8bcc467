//! A list that stays within bounds however much is added: every so many is kept, ever fewer of them.

/// Which of what is added is kept.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Thinning {
    most: usize,
    stride: usize,
    skipped: usize,
}

impl Thinning {
    /// Keeps a list to this many. Of a full one every other stays, and of what comes half as much as before.
    pub(crate) fn to(most: usize) -> Thinning {
        Thinning { most, stride: 1, skipped: 0 }
    }

    /// Adds one that was not yet passed over, or passes it over; `even_so` keeps it whichever it is.
    pub(crate) fn push<T>(&mut self, list: &mut Vec<T>, next: T, even_so: bool) {
        if self.skipped > 0 && !even_so {
            self.skipped -= 1;
            return;
        }
        if list.len() >= self.most {
            let mut keep = false;
            list.retain(|_| {
                keep = !keep;
                keep
            });
            self.stride *= 2;
        }
        list.push(next);
        self.skipped = self.stride - 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// However many come, no more than the bound are kept, the first among them, evenly spread; one that is to
    /// be kept even so is the last.
    #[test]
    fn what_is_kept_is_spread_evenly() {
        for count in [1, 7, 8, 9, 100, 1000] {
            let (mut thinning, mut list) = (Thinning::to(8), Vec::new());
            for number in 0..count {
                thinning.push(&mut list, number, false);
            }
            assert!(list.len() <= 8 && list[0] == 0, "{list:?}");
            let apart: Vec<i32> = list.windows(2).map(|pair| pair[1] - pair[0]).collect();
            assert!(apart.windows(2).all(|pair| pair[0] == pair[1]), "{list:?}");
            thinning.push(&mut list, -1, true);
            assert_eq!(list.last(), Some(&-1));
            assert!(list.len() <= 8);
        }
    }
}
