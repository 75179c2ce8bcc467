//! The room's walls as segments that can be drawn.
//!
//! A room is an intersection of half-planes. Each wall is the part of its line that lies in all the
//! others. In an open room a wall may have no end; such a wall is cut off at a box about what else
//! there is to see.

use crate::{HalfPlane, Scenario, World};

/// How far beyond what is to be seen an endless wall is drawn, metres.
const MARGIN_M: f64 = 3.0;

/// From where to where a wall goes.
pub(super) type Segment = [[f64; 2]; 2];

/// The walls of a scenario's room.
pub(super) fn walls(scenario: &Scenario) -> Vec<Segment> {
    let room = &scenario.world.room;
    let clipped: Vec<(Line, [f64; 2])> = room
        .iter()
        .enumerate()
        .filter_map(|(index, wall)| {
            let line = Line::of(wall)?;
            let others =
                room.iter().enumerate().filter(|(other, _)| *other != index).map(|(_, wall)| wall);
            Some((line, line.within(others, [f64::NEG_INFINITY, f64::INFINITY])?))
        })
        .collect();

    let mut seen = content(scenario);
    for (line, span) in &clipped {
        seen.extend(span.iter().filter(|t| t.is_finite()).map(|t| line.at(*t)));
    }
    let frame = bounding_box(&seen);
    let walls = clipped.iter().filter_map(|(line, span)| {
        let [from, to] =
            if span.iter().all(|t| t.is_finite()) { *span } else { line.within(&frame, *span)? };
        Some([line.at(from), line.at(to)])
    });
    walls.collect()
}

/// The edge of a half-plane: a point on it and the direction along it.
#[derive(Clone, Copy)]
struct Line {
    origin: [f64; 2],
    along: [f64; 2],
}

impl Line {
    /// `None` where the half-plane has no edge.
    fn of(wall: &HalfPlane) -> Option<Line> {
        let [nx, ny] = wall.normal;
        let square = nx * nx + ny * ny;
        let scale = wall.offset_m / square;
        let line = Line { origin: [nx * scale, ny * scale], along: [-ny, nx] };
        (square > 0.0 && line.origin.iter().all(|x| x.is_finite())).then_some(line)
    }

    fn at(&self, t: f64) -> [f64; 2] {
        [self.origin[0] + t * self.along[0], self.origin[1] + t * self.along[1]]
    }

    /// The part of `span` that lies in all the half-planes; `None` if nothing is left.
    fn within<'a>(
        &self,
        walls: impl IntoIterator<Item = &'a HalfPlane>,
        [mut low, mut high]: [f64; 2],
    ) -> Option<[f64; 2]> {
        for wall in walls {
            let [nx, ny] = wall.normal;
            // n · (origin + t along) <= offset
            let slope = nx * self.along[0] + ny * self.along[1];
            let room = wall.offset_m - (nx * self.origin[0] + ny * self.origin[1]);
            if slope > 0.0 {
                high = high.min(room / slope);
            } else if slope < 0.0 {
                low = low.max(room / slope);
            } else if room < 0.0 {
                return None;
            }
        }
        (low < high).then_some([low, high])
    }
}

/// Points that a picture of the scenario has to show.
fn content(scenario: &Scenario) -> Vec<[f64; 2]> {
    let World { obstacles, discs, .. } = &scenario.world;
    let mut points = vec![scenario.start.pose.position_m()];
    if let Some(task) = &scenario.task {
        points.extend([0.0, task.until_s.min(scenario.duration_s)].map(|t| task.target(t).0));
    }
    points.extend(obstacles.iter().flat_map(|obstacle| obstacle.corners_m.iter().copied()));
    points.extend(discs.iter().flat_map(|disc| [disc.from_m, disc.to_m]));
    points
}

/// Half-planes of the box that holds the points, with a margin.
fn bounding_box(points: &[[f64; 2]]) -> [HalfPlane; 4] {
    let reach = |normal: [f64; 2]| {
        let along = points.iter().map(|p| p[0] * normal[0] + p[1] * normal[1]);
        let farthest = along.filter(|x| x.is_finite()).fold(f64::NEG_INFINITY, f64::max);
        HalfPlane { normal, offset_m: farthest + MARGIN_M }
    };
    [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]].map(reach)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::tests::session::scenario;

    fn room(planes: &[([f64; 2], f64)]) -> Scenario {
        let mut scenario = scenario();
        scenario.world.room = planes
            .iter()
            .map(|(normal, offset_m)| HalfPlane { normal: *normal, offset_m: *offset_m })
            .collect();
        scenario
    }

    fn rounded(walls: &[Segment]) -> Vec<[[i64; 2]; 2]> {
        let round = |x: f64| libm::round(x * 1000.0) as i64;
        let mut walls: Vec<_> = walls
            .iter()
            .map(|wall| {
                let mut ends = wall.map(|end| end.map(round));
                ends.sort_unstable();
                ends
            })
            .collect();
        walls.sort_unstable();
        walls
    }

    #[test]
    fn a_closed_room_is_its_polygon() {
        let square =
            room(&[([1.0, 0.0], 4.0), ([-1.0, 0.0], 2.0), ([0.0, 1.0], 2.0), ([0.0, -1.0], 1.0)]);
        assert_eq!(
            rounded(&walls(&square)),
            [
                [[-2000, -1000], [-2000, 2000]],
                [[-2000, -1000], [4000, -1000]],
                [[-2000, 2000], [4000, 2000]],
                [[4000, -1000], [4000, 2000]],
            ]
        );
        // x <= 1, y <= 1, x + y >= 0: a triangle with corners (1, 1), (-1, 1), (1, -1).
        let triangle = room(&[([1.0, 0.0], 1.0), ([0.0, 1.0], 1.0), ([-1.0, -1.0], 0.0)]);
        assert_eq!(
            rounded(&walls(&triangle)),
            [
                [[-1000, 1000], [1000, -1000]],
                [[-1000, 1000], [1000, 1000]],
                [[1000, -1000], [1000, 1000]],
            ]
        );
    }

    #[test]
    fn an_endless_wall_ends_a_margin_beyond_what_there_is_to_see() {
        let mut half = room(&[([0.0, 1.0], 2.0)]);
        half.world.obstacles.clear();
        half.task = None;
        // The start alone is to be seen, at (0.5, −0.5).
        assert_eq!(rounded(&walls(&half)), [[[-2500, 2000], [3500, 2000]]]);
    }

    #[test]
    fn a_wall_that_the_others_hide_is_not_drawn() {
        let hidden =
            room(&[([1.0, 0.0], 1.0), ([1.0, 0.0], 2.0), ([0.0, 1.0], 1.0), ([0.0, -1.0], 1.0)]);
        let walls = walls(&hidden);
        assert_eq!(walls.len(), 3);
        assert!(walls.iter().flatten().all(|end| end[0] <= 1.0 + 1e-12));
    }

    #[test]
    fn nonsense_draws_nothing() {
        assert!(walls(&room(&[])).is_empty());
        assert!(walls(&room(&[([0.0, 0.0], 1.0)])).is_empty());
        assert!(walls(&room(&[([f64::NAN, 0.0], 1.0)])).is_empty());
        // Two walls that leave no room between them: each lies outside of the other.
        assert!(walls(&room(&[([1.0, 0.0], -1.0), ([-1.0, 0.0], -1.0)])).is_empty());
    }
}
