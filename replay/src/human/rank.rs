//! The number of a rank among very many, without keeping them.

/// Bits of a number that are settled by one pass.
const BITS: u32 = 13;

/// Passes that settle all 64.
const PASSES: u32 = 64_u32.div_ceil(BITS);

/// Of N heaps of numbers, none of them negative, the number that comes at a rank when they are in order;
/// `None` where a heap has no such rank. What is not a number comes after all others.
///
/// `pass` goes through all the numbers, each with its heap, and is asked to do so several times. `rank`
/// says which rank is wanted of a heap of so many, from 0.
///
/// Numbers without a sign stand in the order of their bits: each pass counts by a few bits more among those
/// that begin like the one that is sought.
pub(super) fn ranked<const N: usize>(
    pass: impl Fn(&mut dyn FnMut(usize, f64)),
    rank: impl Fn(usize, usize) -> usize,
) -> [Option<f64>; N] {
    let mut counts = Vec::new();
    // What is known of each: its first bits, and its rank among those that begin with them.
    let mut found: [Option<(u64, usize)>; N] = [None; N];
    for turn in 1..=PASSES {
        let known = BITS * (turn - 1);
        let shift = 64_u32.saturating_sub(BITS * turn);
        let mask = (1 << (64 - known - shift)) - 1;
        counts.clear();
        counts.resize(1 << BITS, [0_usize; N]);
        pass(&mut |heap, number| {
            let bits = number.to_bits();
            let begins = found[heap].map_or(0, |(begin, _)| begin);
            if turn == 1 || bits >> (64 - known) == begins {
                counts[(bits >> shift & mask) as usize][heap] += 1;
            }
        });
        for (heap, found) in found.iter_mut().enumerate() {
            let count = || counts.iter().map(|counts| counts[heap]);
            let (begin, mut left) = if turn == 1 {
                let all = count().sum();
                let rank = rank(heap, all);
                if rank >= all {
                    continue;
                }
                (0, rank)
            } else {
                let Some(known) = *found else { continue };
                known
            };
            *found = count().enumerate().find_map(|(next, count)| {
                if left < count {
                    return Some((begin << (64 - known - shift) | next as u64, left));
                }
                left -= count;
                None
            });
        }
    }
    found.map(|found| found.map(|(bits, _)| f64::from_bits(bits)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn number() -> impl Strategy<Value = f64> {
        prop_oneof![
            4 => 0.0..2.0_f64,
            2 => (0..4_u8).prop_map(f64::from),
            1 => any::<f64>().prop_map(f64::abs),
            1 => prop_oneof![Just(f64::INFINITY), Just(f64::NAN.abs()), Just(5e-324)],
        ]
    }

    proptest! {
        /// It is what stands at that place once the heap is sorted.
        #[test]
        fn a_rank_is_a_place_in_the_order(
            heaps in prop::array::uniform3(prop::collection::vec(number(), 0..40)),
            share in prop_oneof![Just(0.0), Just(1.0), 0.0..1.0_f64],
        ) {
            let rank = |_: usize, count: usize| (count as f64 * share) as usize;
            let pass = |see: &mut dyn FnMut(usize, f64)| {
                for (heap, numbers) in heaps.iter().enumerate() {
                    for number in numbers {
                        see(heap, *number);
                    }
                }
            };
            let found: [Option<f64>; 3] = ranked(pass, rank);
            for (numbers, found) in heaps.iter().zip(found) {
                let mut sorted = numbers.clone();
                sorted.sort_by(f64::total_cmp);
                let wanted = sorted.get(rank(0, sorted.len()));
                prop_assert_eq!(found.map(f64::to_bits), wanted.map(|wanted| wanted.to_bits()));
            }
        }
    }
}
