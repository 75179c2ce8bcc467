//! The edges of a convex polygon and the signed distance to it.

use super::{Obstacle, dot, minus};

/// One edge of an obstacle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    /// Where it starts, metres.
    pub(super) from_m: [f64; 2],
    /// From its start to its end, metres.
    pub(super) along_m: [f64; 2],
}

impl Edge {
    /// Outward normal, as long as the edge: enough wherever only signs or ratios matter.
    pub(super) fn outward(&self) -> [f64; 2] {
        [self.along_m[1], -self.along_m[0]]
    }

    pub(super) fn length_squared(&self) -> f64 {
        dot(self.along_m, self.along_m)
    }

    /// Outward unit normal; `None` for an edge without length.
    pub(super) fn normal(&self) -> Option<[f64; 2]> {
        let length_m = libm::sqrt(self.length_squared());
        (length_m > 0.0).then(|| [self.along_m[1] / length_m, -self.along_m[0] / length_m])
    }

    /// Square of the distance from a point to the edge, m².
    pub(super) fn distance_squared(&self, point_m: [f64; 2]) -> f64 {
        let offset_m = minus(point_m, self.from_m);
        let length_squared = self.length_squared();
        let share = if length_squared > 0.0 {
            (dot(offset_m, self.along_m) / length_squared).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let gap_m = [offset_m[0] - share * self.along_m[0], offset_m[1] - share * self.along_m[1]];
        dot(gap_m, gap_m)
    }
}

/// The edges of the closed polygon through `corners_m`, in order.
pub(super) fn edges(corners_m: &[[f64; 2]]) -> impl Iterator<Item = Edge> + '_ {
    corners_m.iter().enumerate().map(|(i, &from_m)| {
        let to_m = corners_m.get(i + 1).copied().unwrap_or(corners_m[0]);
        Edge { from_m, along_m: minus(to_m, from_m) }
    })
}

impl Obstacle {
    pub(super) fn edges(&self) -> impl Iterator<Item = Edge> + '_ {
        edges(&self.corners_m)
    }

    /// How far a point lies beyond the face that it is farthest beyond, and that face's outward
    /// unit normal. Negative inside, where it is minus the way out; outside a face it is the
    /// distance, off a corner a lower bound of it.
    pub(super) fn separation(&self, point_m: [f64; 2]) -> Option<(f64, [f64; 2])> {
        let mut widest: Option<(f64, [f64; 2])> = None;
        for edge in self.edges() {
            let Some(normal) = edge.normal() else { continue };
            let beyond_m = dot(normal, minus(point_m, edge.from_m));
            if widest.is_none_or(|(most_m, _)| beyond_m > most_m) {
                widest = Some((beyond_m, normal));
            }
        }
        widest
    }

    /// Distance, metres, from a point to the polygon; inside, minus the way out; +∞ to a polygon
    /// without an edge.
    pub fn distance_m(&self, point_m: [f64; 2]) -> f64 {
        match self.separation(point_m) {
            None => f64::INFINITY,
            Some((beyond_m, _)) if beyond_m <= 0.0 => beyond_m,
            Some(_) => {
                let mut least = f64::INFINITY;
                for edge in self.edges() {
                    let squared = edge.distance_squared(point_m);
                    if squared < least {
                        least = squared;
                    }
                }
                libm::sqrt(least)
            }
        }
    }
}
