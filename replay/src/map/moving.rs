//! What walked: points where it is free at other times, followed from one to the next.

use schemas::WalkedPath;

use super::votes::{Hit, distance_m};
use super::walls::Face;

/// Points of so many seconds are one place.
const TOGETHER_S: f64 = 0.4;

/// Points no farther apart than this are one walker, metres.
const BREADTH_M: f64 = 0.45;

/// Fastest walker, m/s.
const FASTEST_MPS: f64 = 0.8;

/// A walker out of sight for longer than this is another one, seconds.
const LOST_S: f64 = 1.5;

/// A walker is seen at so many places at least, and gets so far.
const FEWEST: usize = 8;
const LEAST_WAY_M: f64 = 0.35;

/// What echoes within this distance of a face is the face, metres.
const STANDING_M: f64 = 0.3;

/// A walker is seen for so long at least, seconds.
const LEAST_S: f64 = 2.0;

/// What does not get as far as this share of its way does not walk: it is something still, heard here
/// and there.
const STRAIGHT: f64 = 0.6;

/// How big a walker is taken to be, metres: the points tell where their near side is.
const RADIUS_M: f64 = 0.2;

/// A walker while it is followed.
struct Track {
    places: Vec<(f64, [f64; 2])>,
}

impl Track {
    fn last(&self) -> (f64, [f64; 2]) {
        self.places[self.places.len() - 1]
    }
}

pub(super) fn walkers(hits: &[Hit], faces: &[Face]) -> Vec<WalkedPath> {
    let passing = |hit: &&Hit| {
        hit.others >= 1 && faces.iter().all(|face| face.distance_m(hit.at_m) > STANDING_M)
    };
    let passing: Vec<&Hit> = hits.iter().filter(passing).collect();
    let mut tracks: Vec<Track> = Vec::new();
    // Those that may go on: of an hour's walkers few are in sight.
    let mut live: Vec<usize> = Vec::new();
    let mut at = 0;
    while at < passing.len() {
        let t_s = passing[at].view.t_s;
        live.retain(|index| t_s - tracks[*index].last().0 <= LOST_S);
        let count = passing[at..].partition_point(|hit| hit.view.t_s < t_s + TOGETHER_S);
        for (t_s, centre_m) in clusters(&passing[at..at + count]) {
            let nearest = live
                .iter()
                .copied()
                .filter(|index| {
                    let (last_s, last_m) = tracks[*index].last();
                    let gone_s = t_s - last_s;
                    gone_s > 0.0
                        && gone_s <= LOST_S
                        && distance_m(last_m, centre_m) <= 0.2 + FASTEST_MPS * gone_s
                })
                .min_by(|a, b| {
                    let away_m = |index: &usize| distance_m(tracks[*index].last().1, centre_m);
                    away_m(a).total_cmp(&away_m(b))
                });
            if let Some(index) = nearest {
                tracks[index].places.push((t_s, centre_m));
            } else {
                live.push(tracks.len());
                tracks.push(Track { places: vec![(t_s, centre_m)] });
            }
        }
        at += count.max(1);
    }
    tracks.iter().filter_map(path).collect()
}

/// Groups of points that lie together, each with its time and the middle of who made it.
fn clusters(hits: &[&Hit]) -> Vec<(f64, [f64; 2])> {
    let mut groups: Vec<Vec<&Hit>> = Vec::new();
    for hit in hits {
        let group = groups
            .iter_mut()
            .find(|group| group.iter().any(|other| distance_m(other.at_m, hit.at_m) <= BREADTH_M));
        match group {
            Some(group) => group.push(hit),
            None => groups.push(vec![hit]),
        }
    }
    groups
        .iter()
        .map(|group| {
            let count = group.len() as f64;
            let t_s = group.iter().map(|hit| hit.view.t_s).sum::<f64>() / count;
            // The echo is from its near side; the middle lies a radius beyond.
            let middle = |axis: usize| {
                let beyond =
                    |hit: &&Hit| hit.view.along(hit.off_rad, hit.view.range_m + RADIUS_M)[axis];
                group.iter().map(beyond).sum::<f64>() / count
            };
            (t_s, [middle(0), middle(1)])
        })
        .collect()
}

/// A track that went somewhere, smoothed.
fn path(track: &Track) -> Option<WalkedPath> {
    let places = &track.places;
    if places.len() < FEWEST {
        return None;
    }
    let mut smooth: Vec<[f64; 3]> = (0..places.len())
        .map(|i| {
            let about = &places[i.saturating_sub(2)..(i + 3).min(places.len())];
            let mean = |axis: usize| {
                about.iter().map(|(_, at)| at[axis]).sum::<f64>() / about.len() as f64
            };
            [places[i].0, mean(0), mean(1)].map(|x| libm::round(x * 1000.0) / 1000.0)
        })
        .collect();
    // Two places of one millisecond are one: a path does not go back, nor stand in two places.
    smooth.dedup_by(|later, before| later[0] <= before[0]);
    let farthest_m = smooth
        .iter()
        .map(|[_, x, y]| distance_m([*x, *y], [smooth[0][1], smooth[0][2]]))
        .fold(0.0, f64::max);
    let way_m: f64 = smooth
        .windows(2)
        .map(|pair| distance_m([pair[0][1], pair[0][2]], [pair[1][1], pair[1][2]]))
        .sum();
    let lasted_s = smooth[smooth.len() - 1][0] - smooth[0][0];
    let walked = farthest_m >= LEAST_WAY_M
        && farthest_m >= STRAIGHT * way_m
        && lasted_s >= LEAST_S
        && way_m <= FASTEST_MPS * lasted_s;
    walked.then_some(WalkedPath { radius_m: RADIUS_M, points: smooth })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two places within one millisecond are one in what is written; a path that goes back in time would
    /// not be read again.
    #[test]
    fn times_of_a_path_increase_as_they_are_written() {
        let mut places: Vec<(f64, [f64; 2])> =
            (0..30).map(|i| (0.1 * f64::from(i), [0.05 * f64::from(i), 0.0])).collect();
        places.insert(11, (1.000_2, [0.51, 0.0]));
        places.insert(12, (1.000_4, [0.52, 0.0]));
        let path = path(&Track { places }).expect("1.45 m in 2.9 s is a walk");
        assert_eq!(path.points.len(), 30);
        assert!(path.points.windows(2).all(|pair| pair[0][0] < pair[1][0]), "{:?}", path.points);
        let world = schemas::World { paths: vec![path], ..schemas::World::default() };
        world.check().expect("a world that can be read again");
    }
}
