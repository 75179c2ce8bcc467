//! The Pioneer 3-AT: its body and where its sonars sit.

use serde::{Deserialize, Serialize};

/// A rectangle about the reference point, which is the body's centre. 0 × 0 is a point robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Footprint {
    /// Extent along the heading, metres.
    pub length_m: f64,
    /// Extent across the heading, metres.
    pub width_m: f64,
}

impl Footprint {
    /// The point robot of the paper's simulations.
    pub const POINT: Footprint = Footprint { length_m: 0.0, width_m: 0.0 };

    /// Radius of the circle about the reference point that holds the body at every heading, metres.
    pub fn circumscribed_radius_m(&self) -> f64 {
        0.5 * libm::hypot(self.length_m, self.width_m)
    }
}

/// Where one sonar sits on the body and which way it looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SonarMount {
    /// Forward of the reference point, metres.
    pub x_m: f64,
    /// Left of the reference point, metres.
    pub y_m: f64,
    /// Axis, degrees from the heading, counter-clockwise.
    pub bearing_deg: f64,
}

const fn mount(x_mm: i16, y_mm: i16, bearing_deg: i16) -> SonarMount {
    SonarMount {
        x_m: x_mm as f64 / 1000.0,
        y_m: y_mm as f64 / 1000.0,
        bearing_deg: bearing_deg as f64,
    }
}

/// The sixteen sonars of the Pioneer 3-AT by id: the front array 0–7, then the rear array 8–15
/// (manufacturer's parameter file for the P3-AT).
pub const SONARS: [SonarMount; 16] = [
    mount(147, 136, 90),
    mount(193, 119, 50),
    mount(227, 79, 30),
    mount(245, 27, 10),
    mount(245, -27, -10),
    mount(227, -79, -30),
    mount(193, -119, -50),
    mount(147, -136, -90),
    mount(-144, -136, -90),
    mount(-189, -119, -130),
    mount(-223, -79, -150),
    mount(-241, -27, -170),
    mount(-241, 27, 170),
    mount(-223, 79, 150),
    mount(-189, 119, 130),
    mount(-144, 136, 90),
];

/// The farthest a sonar hears, metres; the device reports this number when nothing came back.
pub const SONAR_REACH_M: f64 = 5.0;

/// The nearest a sonar can tell, metres.
pub const SONAR_BLIND_M: f64 = 0.1;
