//! Several tests at once.

/// Holm's step-down adjustment ("A simple sequentially rejective multiple test procedure", 1979):
/// rejecting where the adjusted value is at most α keeps the chance of even one false rejection
/// among all of them at α. The result is in the order of the argument; a NaN counts as 1.
pub fn holm(p_values: &[f64]) -> Vec<f64> {
    let p: Vec<f64> = p_values.iter().map(|p| if p.is_nan() { 1.0 } else { *p }).collect();
    let mut order: Vec<usize> = (0..p.len()).collect();
    order.sort_by(|&i, &j| p[i].total_cmp(&p[j]));
    let mut adjusted = vec![1.0; p.len()];
    let mut largest: f64 = 0.0;
    for (rank, &i) in order.iter().enumerate() {
        largest = largest.max((p[i] * (p.len() - rank) as f64).min(1.0));
        adjusted[i] = largest;
    }
    adjusted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_p_is_multiplied_by_the_number_of_tests_left() {
        // By hand: sorted .01 .03 .04; × 3, 2, 1 = .03 .06 .04; running maximum .03 .06 .06.
        let adjusted = holm(&[0.04, 0.01, 0.03]);
        for (got, want) in adjusted.iter().zip([0.06, 0.03, 0.06]) {
            assert!((got - want).abs() < 1e-15, "{adjusted:?}");
        }
    }

    #[test]
    fn never_above_one_and_empty_for_nothing() {
        assert_eq!(holm(&[0.9, f64::NAN]), [1.0, 1.0]);
        assert!(holm(&[]).is_empty());
    }
}
