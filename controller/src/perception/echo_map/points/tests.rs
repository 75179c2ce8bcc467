use proptest::prelude::*;

use super::super::beam::unit;
use super::*;

/// Whether a point is too old by itself, from what it says of itself alone.
fn is_old(point: &Point, now: Time, odometer_m: f64, silent: bool) -> bool {
    let resting = point.heard >= 2 && odometer_m - point.odometer_m <= 0.3;
    let coming = point.range_m < 0.5 && silent;
    let life_ms = match (point.confirmed, if point.confirmed { resting } else { coming }) {
        (true, true) => 20_000,
        (true, false) => 5_000,
        (false, true) => 720,
        (false, false) => 400,
    };
    now.since(point.fired) > Span(life_ms * 1_000_000)
}

proptest! {
    /// What points have in common with others of their firing, and their kinds, are what they are by
    /// themselves; and by that they age, the last one kept taking the place of each that goes.
    #[test]
    fn firings_and_kinds_are_those_of_the_points(
        echoes in prop::collection::vec(
            ((0_u8..16, 0.0..5.1_f64, any::<bool>()), (-0.4..0.4_f64, 1_u64..700, 0.0..0.1_f64)),
            1..60,
        ),
        silent in prop::collection::vec(any::<bool>(), 16),
    ) {
        let mut points = Points::new();
        let (mut now, mut odometer_m) = (schemas::SIMULATION_EPOCH.after_ns(1 << 40), 0.0);
        for ((sonar, range_m, doubted), (axis_rad, later_ms, on_m)) in echoes {
            now = now.after_ns(later_ms * 1_000_000);
            odometer_m += on_m;
            let arc_m = [-10.0, -5.0, 0.0, 5.0, 10.0].map(|off_deg: f64| {
                unit(axis_rad + off_deg.to_radians()).map(|part| range_m * part)
            });
            let echo = PlacedEcho {
                sonar,
                from_m: [0.0; 2],
                axis: unit(axis_rad),
                arc_m,
                range_m,
                fired: now,
                odometer_m,
            };
            points.hear(&echo, doubted);
            let mut left = points.kept.clone();
            let mut index = 0;
            while index < left.len() {
                if is_old(&left[index], now, odometer_m, silent[usize::from(left[index].sonar)]) {
                    left.swap_remove(index);
                } else {
                    index += 1;
                }
            }
            points.age(now, odometer_m, |firing| silent[usize::from(firing.sonar)]);
            let places = |points: &[Point]| points.iter().map(|p| p.at_m).collect::<Vec<_>>();
            prop_assert_eq!(places(&points.kept), places(&left));
            prop_assert_eq!(points.kinds().count(), left.len());
            for (point, (firing, kind)) in left.iter().zip(points.kinds()) {
                prop_assert_eq!(points.firings()[firing], point.firing());
                prop_assert_eq!(kind.confirmed(), point.confirmed);
                prop_assert_eq!(kind.stands(), point.stands());
                prop_assert_eq!(kind.counts(), point.confirmed || !point.doubted);
            }
            let firings = left.iter().map(|point| (point.sonar, point.fired));
            let firings: std::collections::BTreeSet<_> = firings.collect();
            let held = points.firings().iter().filter(|firing| firing.fired != Time(u64::MAX));
            prop_assert_eq!(held.count(), firings.len());
        }
    }
}
