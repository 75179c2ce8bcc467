//! Whether a recorded person reacted to anything.

use super::rank::ranked;
use crate::recording::Recording;

/// Blocks of a tenth of a second that a stroke needs to be one.
const LEAST_BLOCKS: usize = 4;

/// Ticks in a block.
const BLOCK: usize = 5;

/// Share of the time that constant strokes must fill before a person counts as a script.
const SCRIPTED_SHARE: f64 = 0.9;

/// What can be said about how a recorded person's joystick came about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reaction {
    /// The log says that a script or a recording held the stick.
    Scripted,
    /// The joystick consists of constant strokes: nothing in it follows what the robot does. A
    /// person who decides anew only now and then looks the same.
    Strokes,
    /// The joystick changes all the time, as that of someone who looks does.
    Reacts,
}

impl Reaction {
    /// Judges the person of a recording.
    pub fn of(recording: &Recording) -> Reaction {
        // Simulated people whose joystick does not depend on the robot, and joysticks played back.
        const BLIND: [&str; 3] = ["script", "joystick", "playback"];
        if BLIND.contains(&recording.header().run.driver.as_str()) {
            Reaction::Scripted
        } else if recording.explanations().constant_share(|| constant_share(recording))
            >= SCRIPTED_SHARE
        {
            Reaction::Strokes
        } else {
            Reaction::Reacts
        }
    }

    /// Whether the recorded joystick is what the person would have done under any controller.
    pub fn is_blind(self) -> bool {
        self == Reaction::Scripted
    }

    /// What a report says of it; `None` where there is nothing to be said.
    pub fn remark(self) -> Option<&'static str> {
        match self {
            Reaction::Scripted => Some(
                "the joystick was scripted: it did not react to anything, and playback is exact",
            ),
            Reaction::Strokes => Some(
                "the joystick consists of constant strokes: no reaction to the robot can be seen",
            ),
            Reaction::Reacts => None,
        }
    }

    /// The name in machine-readable output.
    pub fn name(self) -> &'static str {
        match self {
            Reaction::Scripted => "scripted",
            Reaction::Strokes => "strokes",
            Reaction::Reacts => "reacts",
        }
    }
}

/// Share of the recorded time in which the joystick is constant, up to its tremor, for at least
/// [`LEAST_BLOCKS`].
fn constant_share(recording: &Recording) -> f64 {
    let tremor = tremor(recording);
    // Differences of block means are normal with the tremor's √(2/5): five deviations of it.
    let tolerance = tremor.map(|sigma| 5.0 * sigma * libm::sqrt(2.0 / BLOCK as f64) + 1e-6);
    let (mut constant, mut count) = (0, 0);
    let mut first: Option<(usize, [f64; 2])> = None;
    // The block in which the stroke changes belongs to neither.
    let stroke = |from: usize, to: usize| if to - from >= LEAST_BLOCKS { to - from + 1 } else { 0 };
    for (end, mean) in means(recording).enumerate() {
        count = end + 1;
        let holds =
            |of: &[f64; 2]| (0..2).all(|axis| (mean[axis] - of[axis]).abs() <= tolerance[axis]);
        if !first.as_ref().is_some_and(|(_, of)| holds(of)) {
            constant += first.map_or(0, |(from, _)| stroke(from, end));
            first = Some((end, mean));
        }
    }
    constant += first.map_or(0, |(from, _)| stroke(from, count));
    if count == 0 { 0.0 } else { constant as f64 / count as f64 }
}

/// What was asked for, tick by tick, [m/s, rad/s].
fn asked(recording: &Recording) -> impl Iterator<Item = [f64; 2]> {
    recording
        .look()
        .all()
        .filter_map(|moment| moment.request)
        .map(|request| [request.v_mps, request.omega_radps])
        .filter(|asked| asked.iter().all(|number| number.is_finite()))
}

/// The means of its blocks.
fn means(recording: &Recording) -> impl Iterator<Item = [f64; 2]> {
    let mut asked = asked(recording);
    std::iter::from_fn(move || {
        let mut block = [[0.0; 2]; BLOCK];
        for place in &mut block {
            *place = asked.next()?;
        }
        Some([0, 1].map(|axis| block.iter().map(|asked| asked[axis]).sum::<f64>() / BLOCK as f64))
    })
}

/// The deviation of what changes from one sample to the next: the median of the magnitudes of second
/// differences, to which a steady drift adds nothing and a stroke's change hardly anything.
fn tremor(recording: &Recording) -> [f64; 2] {
    let bends = |see: &mut dyn FnMut(usize, f64)| {
        let mut last = [None; 2];
        for now in asked(recording) {
            if let [Some(first), Some(second)] = last {
                let (first, second): ([f64; 2], [f64; 2]) = (first, second);
                for axis in 0..2 {
                    see(axis, (first[axis] - 2.0 * second[axis] + now[axis]).abs());
                }
            }
            last = [last[1], Some(now)];
        }
    };
    // A second difference of white noise has √6 of its deviation; the median of |normal| is 0.6745.
    ranked(bends, |_, count| count / 2)
        .map(|median| median.map_or(0.0, |median| median / (0.6745 * libm::sqrt(6.0))))
}
