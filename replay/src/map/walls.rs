//! Straight faces through the points that enough echoes came from.

use schemas::Obstacle;

use super::grid::{Evidence, Raster};
use super::views::Gathered;
use super::votes::{Hit, distance_m};

/// Points about one are looked at within this distance for which way the face runs, metres.
const LOCAL_M: f64 = 0.35;

/// A point belongs to a face when it is no farther beside it than this, metres.
const BESIDE_M: f64 = 0.07;

/// Where a face has no point for longer than this it ends, metres.
const GAP_M: f64 = 0.3;

/// A face of fewer points is none.
const FEWEST: usize = 8;

/// How thick a face is written, metres; it extends away from who saw it.
const THICK_M: f64 = 0.08;

/// A face no farther than this before or behind a longer one is the same wall, heard again after the
/// estimate has drifted, metres.
const SAME_M: f64 = 0.15;

/// A face within 8° of a sonar's axis, and met within 30° of its normal, is heard.
const CORE_COS: f64 = 0.990;
const FACING_COS: f64 = 0.87;

/// So many echoes from behind for each from the face itself are too many.
const MOST_PAST: f64 = 0.3;

/// A straight stretch of something that echoes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Face {
    pub(super) from_m: [f64; 2],
    pub(super) to_m: [f64; 2],
    /// Unit vector towards who saw it.
    pub(super) towards: [f64; 2],
}

impl Face {
    /// A thin convex obstacle whose front is the face.
    pub(super) fn obstacle(&self) -> Obstacle {
        let back = |point: [f64; 2]| {
            [point[0] - THICK_M * self.towards[0], point[1] - THICK_M * self.towards[1]]
        };
        let corners = [self.from_m, self.to_m, back(self.to_m), back(self.from_m)];
        let along = [self.to_m[0] - self.from_m[0], self.to_m[1] - self.from_m[1]];
        let left = along[0] * self.towards[1] - along[1] * self.towards[0] > 0.0;
        let mut corners_m = corners.map(|corner| corner.map(millimetres)).to_vec();
        // Seen from the left of its direction, the back lies to the right: clockwise.
        if left {
            corners_m.reverse();
        }
        Obstacle { corners_m }
    }

    pub(super) fn length_m(&self) -> f64 {
        distance_m(self.from_m, self.to_m)
    }

    /// How far a point is from it, metres.
    pub(super) fn distance_m(&self, point_m: [f64; 2]) -> f64 {
        let way = [self.to_m[0] - self.from_m[0], self.to_m[1] - self.from_m[1]];
        let offset = [point_m[0] - self.from_m[0], point_m[1] - self.from_m[1]];
        let share = (offset[0] * way[0] + offset[1] * way[1]) / (way[0] * way[0] + way[1] * way[1]);
        let share = share.clamp(0.0, 1.0);
        libm::hypot(offset[0] - share * way[0], offset[1] - share * way[1])
    }

    /// Places along it, no farther apart than a step.
    pub(super) fn places(&self, step_m: f64) -> impl Iterator<Item = [f64; 2]> + '_ {
        let count = libm::ceil(distance_m(self.from_m, self.to_m) / step_m).max(1.0) as u32;
        (0..=count).map(move |i| {
            let share = f64::from(i) / f64::from(count);
            [0, 1].map(|axis| self.from_m[axis] + share * (self.to_m[axis] - self.from_m[axis]))
        })
    }
}

fn millimetres(metres: f64) -> f64 {
    libm::round(metres * 1000.0) / 1000.0
}

/// A line through points: their middle and the direction in which they spread most.
struct Line {
    middle_m: [f64; 2],
    along: [f64; 2],
}

impl Line {
    fn through(points: &[[f64; 2]]) -> Line {
        let count = points.len().max(1) as f64;
        let middle_m = [0, 1].map(|axis| points.iter().map(|p| p[axis]).sum::<f64>() / count);
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for point in points {
            let (dx, dy) = (point[0] - middle_m[0], point[1] - middle_m[1]);
            xx += dx * dx;
            xy += dx * dy;
            yy += dy * dy;
        }
        let (sin, cos) = libm::sincos(0.5 * libm::atan2(2.0 * xy, xx - yy));
        Line { middle_m, along: [cos, sin] }
    }

    /// Place along the line, and beside it.
    fn place(&self, point: [f64; 2]) -> [f64; 2] {
        let offset = [point[0] - self.middle_m[0], point[1] - self.middle_m[1]];
        [
            offset[0] * self.along[0] + offset[1] * self.along[1],
            self.along[0] * offset[1] - self.along[1] * offset[0],
        ]
    }

    fn at(&self, along_m: f64) -> [f64; 2] {
        [0, 1].map(|axis| self.middle_m[axis] + along_m * self.along[axis])
    }
}

/// The faces, those with most points first. Each point belongs to one.
pub(super) fn faces(hits: &[Hit], gathered: &Gathered, seen: &Evidence) -> Vec<Face> {
    let standing = |hit: &&Hit| hit.is_confirmed() && !seen.is_passing(hit.at_m);
    let hits: Vec<&Hit> = hits.iter().filter(standing).collect();
    let mut places: Raster<Vec<u32>> = Raster::about(hits.iter().map(|hit| hit.at_m), LOCAL_M);
    for (index, hit) in hits.iter().enumerate() {
        if let Some(cell) = places.index(hit.at_m) {
            places.cells[cell].push(index as u32);
        }
    }
    let mut order: Vec<u32> = (0..hits.len() as u32).collect();
    order.sort_by_key(|index| core::cmp::Reverse(hits[*index as usize].others));
    let mut taken = vec![false; hits.len()];
    let mut faces = Vec::new();
    for seed in order {
        if taken[seed as usize] {
            continue;
        }
        let centre_m = hits[seed as usize].at_m;
        let near: Vec<u32> = places
            .around(centre_m)
            .flat_map(|cell| places.cells[cell].iter().copied())
            .filter(|other| distance_m(hits[*other as usize].at_m, centre_m) <= LOCAL_M)
            .collect();
        if near.len() < FEWEST {
            continue;
        }
        let (members, face) = grow(&hits, &taken, &near, centre_m);
        // Later seeds look at what is left, not again and again at all there was.
        for member in members.into_iter().chain([seed]) {
            taken[member as usize] = true;
            if let Some(cell) = places.index(hits[member as usize].at_m) {
                places.cells[cell].retain(|index| *index != member);
            }
        }
        faces.extend(face);
    }
    // The longest first.
    faces.sort_by(|a, b| b.length_m().total_cmp(&a.length_m()));
    faces.retain(|face| !is_seen_past(face, gathered));
    single(&faces)
}

/// Whether sonars that should have heard a face heard something behind it: then it is not there, or not
/// any more.
fn is_seen_past(face: &Face, gathered: &Gathered) -> bool {
    let (mut heard, mut past) = (0_u32, 0_u32);
    let places: Vec<[f64; 2]> = face.places(0.1).collect();
    for view in gathered.views.iter().chain(&gathered.beyond) {
        let (sin, cos) = libm::sincos(view.axis_rad);
        let nearest_m = places.iter().filter_map(|at_m| {
            let way = [at_m[0] - view.from_m[0], at_m[1] - view.from_m[1]];
            let distance_m = libm::hypot(way[0], way[1]);
            let ahead = way[0] * cos + way[1] * sin >= CORE_COS * distance_m;
            let facing = -(way[0] * face.towards[0] + way[1] * face.towards[1]);
            (ahead && facing >= FACING_COS * distance_m).then_some(distance_m)
        });
        let Some(nearest_m) = nearest_m.min_by(f64::total_cmp) else { continue };
        if view.range_m > nearest_m + 0.25 {
            past += 1;
        } else if view.range_m > nearest_m - 0.15 {
            heard += 1;
        }
    }
    past >= 2 && f64::from(past) > MOST_PAST * f64::from(heard)
}

/// Without those that are another, longer one heard again: parallel to it, facing the same way, and no
/// farther beside it than that.
fn single(faces: &[Face]) -> Vec<Face> {
    let again = |face: &Face, other: &Face| {
        let way = [other.to_m[0] - other.from_m[0], other.to_m[1] - other.from_m[1]];
        let length_m = libm::hypot(way[0], way[1]);
        let alike = face.towards[0] * other.towards[0] + face.towards[1] * other.towards[1];
        let beside = [face.from_m, face.to_m].iter().all(|end| {
            let offset = [end[0] - other.from_m[0], end[1] - other.from_m[1]];
            let along_m = (offset[0] * way[0] + offset[1] * way[1]) / length_m;
            let beside_m = offset[0] * other.towards[0] + offset[1] * other.towards[1];
            (-0.15..=length_m + 0.15).contains(&along_m) && beside_m.abs() <= SAME_M
        });
        alike > 0.9 && beside
    };
    let mut kept: Vec<Face> = Vec::new();
    for face in faces {
        if !kept.iter().any(|other| again(face, other)) {
            kept.push(*face);
        }
    }
    kept
}

/// The longest run of points along a line through some of them, found three times: each time along the
/// line through the run before.
fn grow(
    hits: &[&Hit],
    taken: &[bool],
    near: &[u32],
    centre_m: [f64; 2],
) -> (Vec<u32>, Option<Face>) {
    let mut members: Vec<u32> = near.to_vec();
    let mut ends = (0.0, 0.0);
    let mut line = Line { middle_m: centre_m, along: [1.0, 0.0] };
    for _ in 0..3 {
        let points: Vec<[f64; 2]> = members.iter().map(|i| hits[*i as usize].at_m).collect();
        line = Line::through(&points);
        let mut on_line: Vec<(f64, u32)> = (0..hits.len() as u32)
            .filter(|i| !taken[*i as usize])
            .filter_map(|i| {
                let [along_m, beside_m] = line.place(hits[i as usize].at_m);
                (beside_m.abs() <= BESIDE_M).then_some((along_m, i))
            })
            .collect();
        on_line.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let home_m = line.place(centre_m)[0];
        let Some(run) = run_about(&on_line, home_m) else { return (near.to_vec(), None) };
        ends = (run[0].0, run[run.len() - 1].0);
        members = run.iter().map(|(_, i)| *i).collect();
    }
    if members.len() < FEWEST {
        return (members, None);
    }
    // Towards the sonars that heard it, on the whole.
    let normal = [-line.along[1], line.along[0]];
    let side: f64 = members
        .iter()
        .map(|i| {
            let hit = hits[*i as usize];
            let way = [hit.view.from_m[0] - hit.at_m[0], hit.view.from_m[1] - hit.at_m[1]];
            (way[0] * normal[0] + way[1] * normal[1]).signum()
        })
        .sum();
    let towards = if side >= 0.0 { normal } else { normal.map(|x| -x) };
    // A point alone has some extent too.
    let (low_m, high_m) = (ends.0 - 0.02, ends.1 + 0.02);
    let face = Face { from_m: line.at(low_m), to_m: line.at(high_m), towards };
    (members, Some(face))
}

/// The run of points without a gap that lies about a place.
fn run_about(on_line: &[(f64, u32)], home_m: f64) -> Option<&[(f64, u32)]> {
    let mut from = 0;
    for i in 0..on_line.len() {
        let ends = i + 1 == on_line.len() || on_line[i + 1].0 - on_line[i].0 > GAP_M;
        if ends {
            let run = &on_line[from..=i];
            if run[0].0 - GAP_M <= home_m && home_m <= on_line[i].0 + GAP_M {
                return Some(run);
            }
            from = i + 1;
        }
    }
    None
}
