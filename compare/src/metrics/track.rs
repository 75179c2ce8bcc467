//! A run to look at: where the robot went, who drove, and when that changed.

use schemas::{Reason, Region};

use crate::thinning::Thinning;

/// Most points of a track. When a run outgrows them, every second one goes.
const MOST_POINTS: usize = 512;

/// Most switches that are kept; a run that chatters more than that shows its first ones.
const MOST_SWITCHES: usize = 4096;

/// One instant of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackPoint {
    /// Seconds from the start of the run.
    pub t_s: f64,
    /// Position of the reference point, metres.
    pub x_m: f64,
    /// Position of the reference point, metres.
    pub y_m: f64,
    /// Heading, radians.
    pub theta_rad: f64,
    /// Sharing function.
    pub k: f64,
    /// Requested forward speed, clipped to the plant's limits, m/s.
    pub v_h_mps: f64,
    /// Commanded forward speed, m/s.
    pub v_s_mps: f64,
    /// Requested turn rate, clipped, rad/s.
    pub omega_h_radps: f64,
    /// Commanded turn rate, rad/s.
    pub omega_s_radps: f64,
    /// Signed clearance of the footprint, metres.
    pub clearance_m: f64,
    /// D, metres.
    pub distance_human_m: f64,
    /// Lyapunov function.
    pub lyapunov: f64,
}

/// A moment at which it changed who drives (k, or whether the safety layer altered the input), or
/// was seen first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Switch {
    /// Seconds from the start of the run.
    pub t_s: f64,
    /// The new k.
    pub k: f64,
    /// Whether the safety layer altered the person's input from here on; false while k = 0.
    pub projected: bool,
    /// Why, as the controller said.
    pub reason: Reason,
    /// Class of the state.
    pub region: Region,
    /// D, metres.
    pub distance_human_m: f64,
    /// D at the step before, metres; NaN where there was none.
    pub distance_before_m: f64,
    /// Requested forward speed, m/s.
    pub v_h_mps: f64,
    /// The sonar with the nearest echo of the last half second, and its range, metres; `None` without
    /// one.
    pub nearest_echo: Option<(u8, f64)>,
    /// The sonar whose echo ends D, or the ray of the safety layer, and its range, metres; `None` where
    /// that was not asked ([`Meter::ended_by`](super::Meter::ended_by)).
    pub ended_by: Option<(u8, f64)>,
    /// The critical distance that D is on the other side of; `None` where it is not that which switched.
    pub critical: Option<Critical>,
}

/// A critical distance of the sets (12).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Critical {
    /// Dc, metres.
    pub distance_m: f64,
    /// The speed that it is of, m/s: the requested one, or the present one where that is the worse.
    pub v_mps: f64,
}

/// A run, thinned to a bounded number of points.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Points in the order of time.
    pub points: Vec<TrackPoint>,
    /// Every change of who drives, in the order of time; bounded.
    pub switches: Vec<Switch>,
    thinning: Thinning,
    last: Option<TrackPoint>,
}

impl Track {
    pub(super) fn new() -> Track {
        let thinning = Thinning::to(MOST_POINTS);
        Track { points: Vec::new(), switches: Vec::new(), thinning, last: None }
    }

    pub(super) fn point(&mut self, point: TrackPoint) {
        self.last = Some(point);
        self.thinning.push(&mut self.points, point, false);
    }

    pub(super) fn switch(&mut self, switch: Switch) {
        let changed = self
            .switches
            .last()
            .is_none_or(|last| last.k != switch.k || last.projected != switch.projected);
        if changed && self.switches.len() < MOST_SWITCHES {
            self.switches.push(switch);
        }
    }

    /// Adds the last point of the run, which thinning may have left out.
    pub(super) fn finish(&mut self) {
        if let Some(last) = self.last
            && self.points.last().is_none_or(|point| point.t_s != last.t_s)
        {
            self.points.push(last);
        }
    }

    /// At most `most` of its points, and the last one: evenly left out where there are more.
    pub fn thinned(&self, most: usize) -> Vec<&TrackPoint> {
        let every = self.points.len().div_ceil(most.max(1)).max(1);
        let last = self.points.len().saturating_sub(1);
        let kept = |i: &usize| i.is_multiple_of(every) || *i == last;
        self.points.iter().enumerate().filter(|(i, _)| kept(i)).map(|(_, point)| point).collect()
    }

    /// The last switch at or before `t_s`: who drove then, and since when. `None` before the first,
    /// and after the last one kept where the run had more.
    pub fn driving_at(&self, t_s: f64) -> Option<&Switch> {
        let full = self.switches.len() == MOST_SWITCHES;
        if full && self.switches.last().is_some_and(|last| t_s > last.t_s) {
            return None;
        }
        self.switches.iter().take_while(|switch| switch.t_s <= t_s).last()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(t_s: f64) -> TrackPoint {
        TrackPoint {
            t_s,
            x_m: 0.0,
            y_m: 0.0,
            theta_rad: 0.0,
            k: 1.0,
            v_h_mps: 0.0,
            v_s_mps: 0.0,
            omega_h_radps: 0.0,
            omega_s_radps: 0.0,
            clearance_m: 0.0,
            distance_human_m: 0.0,
            lyapunov: 0.0,
        }
    }

    fn switch(t_s: f64, k: f64, projected: bool) -> Switch {
        Switch {
            t_s,
            k,
            projected,
            reason: Reason::Human,
            region: Region::Safe,
            distance_human_m: 0.0,
            distance_before_m: 0.0,
            v_h_mps: 0.0,
            nearest_echo: None,
            ended_by: None,
            critical: None,
        }
    }

    fn track(points: u32) -> Track {
        let mut track = Track::new();
        (0..points).for_each(|i| track.point(point(f64::from(i))));
        track.finish();
        track
    }

    fn times(points: &[&TrackPoint]) -> Vec<f64> {
        points.iter().map(|point| point.t_s).collect()
    }

    /// Up to 512 points are all kept; of 513 every second one is, of 1,026 every fourth; and the last one
    /// always, once.
    #[test]
    fn a_long_run_keeps_evenly_spaced_points_and_its_last() {
        for (given, every, kept) in
            [(0, 1, 0), (1, 1, 1), (512, 1, 512), (513, 2, 257), (514, 2, 258), (1_026, 4, 258)]
        {
            let track = track(given);
            assert_eq!(track.points.len(), kept, "of {given}");
            let [body @ .., _] = &track.points[..] else { continue };
            let even = body.iter().enumerate().all(|(i, at)| at.t_s == f64::from(every * i as u32));
            assert!(even, "of {given}");
            assert_eq!(track.points.last().map(|at| at.t_s), Some(f64::from(given - 1)));
        }
    }

    #[test]
    fn thinning_leaves_out_evenly_and_keeps_the_last() {
        let track = track(10);
        assert_eq!(times(&track.thinned(10)).len(), 10);
        assert_eq!(times(&track.thinned(5)), [0.0, 2.0, 4.0, 6.0, 8.0, 9.0]);
        assert_eq!(times(&track.thinned(4)), [0.0, 3.0, 6.0, 9.0]);
        assert_eq!(times(&track.thinned(1)), [0.0, 9.0]);
        assert_eq!(times(&track.thinned(0)), [0.0, 9.0]);
        assert!(Track::new().thinned(5).is_empty());
    }

    #[test]
    fn a_switch_is_a_change_of_who_drives() {
        let mut track = Track::new();
        for (t_s, k, projected) in [
            (1.0, 1.0, false),
            (2.0, 1.0, false),
            (3.0, 1.0, true),
            (4.0, 0.0, true),
            (5.0, 0.0, true),
        ] {
            track.switch(switch(t_s, k, projected));
        }
        let kept: Vec<f64> = track.switches.iter().map(|switch| switch.t_s).collect();
        assert_eq!(kept, [1.0, 3.0, 4.0]);
        let since = |t_s| track.driving_at(t_s).map(|switch| switch.t_s);
        let asked = [0.5, 1.0, 2.9, 3.0, 100.0].map(since);
        assert_eq!(asked, [None, Some(1.0), Some(1.0), Some(3.0), Some(4.0)]);
    }

    /// Of more than 4,096 switches the rest is not known: who drives after the last one kept neither.
    #[test]
    fn a_run_that_chatters_shows_its_first_switches() {
        let mut track = Track::new();
        for i in 0..4_095 {
            track.switch(switch(f64::from(i), f64::from(i % 2), false));
        }
        assert!(track.driving_at(1e9).is_some());
        for i in 4_095..5_000 {
            track.switch(switch(f64::from(i), f64::from(i % 2), false));
        }
        assert_eq!(track.switches.len(), 4_096);
        assert!(track.driving_at(4_095.5).is_none());
        assert_eq!(track.driving_at(4_095.0).map(|switch| switch.t_s), Some(4_095.0));
    }
}
