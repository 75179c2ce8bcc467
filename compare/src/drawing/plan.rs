//! The world from above: metres to units of a picture.

use schemas::{Footprint, HalfPlane, Pose, Scenario};

use super::unit;

/// How far beyond paths and obstacles a picture looks for walls, metres.
const LOOKS_FOR_WALLS_M: f64 = 2.0;

/// Blank around everything drawn, metres.
const BORDER_M: f64 = 0.25;

/// A bounding box, metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    low: [f64; 2],
    high: [f64; 2],
}

impl Bounds {
    /// Nothing.
    pub(crate) const EMPTY: Bounds =
        Bounds { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };

    /// Takes in a point and what is around it; what is not finite is nowhere.
    pub(crate) fn take(&mut self, p: [f64; 2], around_m: f64) {
        if p.iter().all(|x| x.is_finite()) {
            for (i, x) in p.into_iter().enumerate() {
                self.low[i] = self.low[i].min(x - around_m);
                self.high[i] = self.high[i].max(x + around_m);
            }
        }
    }

    fn grown(self, by_m: f64) -> Bounds {
        Bounds { low: self.low.map(|x| x - by_m), high: self.high.map(|x| x + by_m) }
    }

    fn corners(self) -> Vec<[f64; 2]> {
        let ([x0, y0], [x1, y1]) = (self.low, self.high);
        vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]]
    }
}

/// A picture of a world: which part of it, and how large.
#[derive(Clone, Debug)]
pub(crate) struct Plan {
    left_m: f64,
    top_m: f64,
    /// Units per metre.
    pub(crate) scale: f64,
    /// Size of the picture, units.
    pub(crate) size: [f64; 2],
    /// Corners of the free space inside the room, metres.
    pub(crate) room_m: Vec<[f64; 2]>,
}

impl Plan {
    /// A picture of at most `most` units that holds `content` (where robots were), and the walls and
    /// things of the scenario; `None` where nothing has a place.
    pub(crate) fn of(
        scenario: Option<&Scenario>,
        mut content: Bounds,
        most: [f64; 2],
    ) -> Option<Plan> {
        if let Some(scenario) = scenario {
            for corner in scenario.world.obstacles.iter().flat_map(|obstacle| &obstacle.corners_m) {
                content.take(*corner, 0.0);
            }
            for disc in &scenario.world.discs {
                content.take(disc.from_m, disc.radius_m);
                content.take(disc.to_m, disc.radius_m);
            }
        }
        if content.low.iter().chain(&content.high).any(|x| !x.is_finite()) {
            return None;
        }
        let mut room_m = content.grown(LOOKS_FOR_WALLS_M).corners();
        for face in scenario.iter().flat_map(|scenario| &scenario.world.room) {
            room_m = clipped(&room_m, face);
        }
        let mut shown = content;
        for corner in &room_m {
            shown.take(*corner, 0.0);
        }
        let shown = shown.grown(BORDER_M);
        let size = [shown.high[0] - shown.low[0], shown.high[1] - shown.low[1]];
        let scale = (most[0] / size[0]).min(most[1] / size[1]);
        let (left_m, top_m) = (shown.low[0], shown.high[1]);
        Some(Plan { left_m, top_m, scale, size: size.map(|x| x * scale), room_m })
    }

    /// What stands at the upper left corner, metres.
    pub(crate) fn corner_m(&self) -> [f64; 2] {
        [self.left_m, self.top_m]
    }

    /// Units of a point; y upwards becomes y downwards.
    pub(crate) fn at(&self, p: [f64; 2]) -> [f64; 2] {
        [(p[0] - self.left_m) * self.scale, (self.top_m - p[1]) * self.scale]
    }

    /// The same as text.
    pub(crate) fn point(&self, p: [f64; 2]) -> [String; 2] {
        self.at(p).map(unit)
    }

    /// A list of points, as polygons and polylines have it.
    pub(crate) fn points(&self, all: &[[f64; 2]]) -> String {
        all.iter().map(|p| self.point(*p).join(",")).collect::<Vec<_>>().join(" ")
    }

    /// The outline of a body; `None` for a point robot or a pose that is not known.
    pub(crate) fn body(&self, footprint: Footprint, pose: &Pose) -> Option<String> {
        let (ahead_m, aside_m) = (0.5 * footprint.length_m, 0.5 * footprint.width_m);
        let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)]
            .map(|(x, y)| pose.transform(x * ahead_m, y * aside_m));
        (footprint != Footprint::POINT && pose.is_finite()).then(|| self.points(&corners))
    }
}

/// The part of a convex polygon that lies in a half-plane (Sutherland and Hodgman, 1974).
fn clipped(polygon: &[[f64; 2]], face: &HalfPlane) -> Vec<[f64; 2]> {
    let beyond = |p: [f64; 2]| face.normal[0] * p[0] + face.normal[1] * p[1] - face.offset_m;
    let mut kept = Vec::new();
    for (i, &p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        let (at_p, at_q) = (beyond(p), beyond(q));
        if at_p <= 0.0 {
            kept.push(p);
        }
        if (at_p <= 0.0) != (at_q <= 0.0) {
            let share = at_p / (at_p - at_q);
            kept.push([p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])]);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::scenario;

    /// The room of 4 m × 2 m with its border of 0.25 m on 450 units: 100 units per metre, y down.
    #[test]
    fn metres_become_units() {
        let mut content = Bounds::EMPTY;
        content.take([1.0, 1.0], 0.0);
        content.take([f64::NAN, 9.0], 0.0);
        let plan = Plan::of(Some(&scenario()), content, [450.0, 900.0]).unwrap();
        // Walls farther than 2 m from all that there is are not looked for.
        assert_eq!(plan.room_m, [[3.0, 0.0], [3.0, 2.0], [0.0, 2.0], [0.0, 0.0]]);
        assert!((plan.scale - 450.0 / 3.5).abs() < 1e-9);
        assert_eq!(plan.point([-0.25, 2.25]), ["0", "0"]);
        assert!(Plan::of(Some(&scenario()), Bounds::EMPTY, [1.0, 1.0]).is_none());
    }

    #[test]
    fn a_body_is_drawn_as_it_stands() {
        let mut content = Bounds::EMPTY;
        content.take([0.0, 0.0], 1.0);
        let plan = Plan::of(None, content, [650.0, 650.0]).unwrap();
        let body = Footprint { length_m: 1.0, width_m: 0.5 };
        let pose = Pose { x_m: 0.0, y_m: 0.0, theta_rad: 0.0 };
        // Without a room the picture ends 2 m + 0.25 m beyond the content: 6.5 m on 650 units.
        assert_eq!(plan.body(body, &pose).unwrap(), "375,300 275,300 275,350 375,350");
        assert_eq!(plan.body(Footprint::POINT, &pose), None);
    }
}
