//! Controllers that are wrong on purpose, to see whether a comparison notices.
//!
//! In: the quantities of a step, stage by stage. Out: the same, one of them wrong. Everything that a
//! mutant does wrong is in this file; the runner only passes its quantities by. A mutant is made by
//! [`Runner::mutant`](crate::Runner::mutant) and in no other way: neither a parameter, a file, a log
//! nor a version's name can ask for one.

use schemas::{Node, Region, Sample, Step};

use crate::estimation::Estimate;
use crate::plan::Scene;
use crate::target::Target;

/// The sonar that [`Mutation::SonarDropped`] does without: the one that looks 30° to the right.
const DROPPED: u8 = 5;

/// What is done wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mutation {
    /// The estimate is that of the step before.
    EstimateLags,
    /// The readings of one sonar never reach the map.
    SonarDropped,
    /// Left and right are mixed up: d2l is d2r.
    SidesMixedUp,
    /// The target is taken to stand still.
    TargetStands,
    /// The feedback law turns the wrong way.
    FeedbackSign,
    /// The feedback law says what it said a step before.
    FeedbackLags,
    /// There is no hysteresis: what is not dangerous is safe.
    NoHysteresis,
    /// The command turns the wrong way.
    CommandSign,
    /// The command is that of the step before.
    CommandLags,
}

impl Mutation {
    /// All of them, in the order of the data flow.
    pub const ALL: [Mutation; 9] = [
        Mutation::EstimateLags,
        Mutation::SonarDropped,
        Mutation::SidesMixedUp,
        Mutation::TargetStands,
        Mutation::FeedbackSign,
        Mutation::FeedbackLags,
        Mutation::NoHysteresis,
        Mutation::CommandSign,
        Mutation::CommandLags,
    ];

    /// A name for reports.
    pub fn name(self) -> &'static str {
        match self {
            Mutation::EstimateLags => "estimate one step late",
            Mutation::SonarDropped => "sonar 5 dropped",
            Mutation::SidesMixedUp => "left and right mixed up",
            Mutation::TargetStands => "target taken to stand still",
            Mutation::FeedbackSign => "feedback turns the wrong way",
            Mutation::FeedbackLags => "feedback one step late",
            Mutation::NoHysteresis => "no hysteresis",
            Mutation::CommandSign => "command turns the wrong way",
            Mutation::CommandLags => "command one step late",
        }
    }

    /// The stage of the data flow that is wrong.
    pub fn node(self) -> Node {
        match self {
            Mutation::EstimateLags => Node::Estimate,
            Mutation::SonarDropped | Mutation::SidesMixedUp => Node::Distances,
            Mutation::TargetStands => Node::Reference,
            Mutation::FeedbackSign | Mutation::FeedbackLags => Node::Law,
            Mutation::NoHysteresis => Node::Sharing,
            Mutation::CommandSign | Mutation::CommandLags => Node::Command,
        }
    }
}

/// What a runner does wrong: nothing, unless it was made a mutant.
#[derive(Clone, Debug, Default)]
pub(crate) struct Planted {
    mutation: Option<Mutation>,
    /// Of the step before, for what comes late.
    estimate: Option<Estimate>,
    input: Option<[f64; 2]>,
}

impl Planted {
    pub(crate) fn new(mutation: Mutation) -> Planted {
        Planted { mutation: Some(mutation), ..Planted::default() }
    }

    /// A sample on its way to the senses; `None` where it goes there as it is.
    pub(crate) fn sample(&self, sample: &Sample) -> Option<Sample> {
        match (self.mutation, sample) {
            (Some(Mutation::SonarDropped), Sample::Sonar(scan)) => {
                let mut scan = scan.clone();
                scan.echoes.retain(|echo| echo.id != DROPPED);
                Some(Sample::Sonar(scan))
            }
            _ => None,
        }
    }

    pub(crate) fn estimate(&mut self, now: Estimate) -> Estimate {
        if self.mutation != Some(Mutation::EstimateLags) {
            return now;
        }
        let before = self.estimate.replace(now).unwrap_or(now);
        // It comes late, and does not know: the stamps are those of the newest.
        Estimate { reached: now.reached, stamp: now.stamp, ..before }
    }

    pub(crate) fn target(&self, target: &mut Target) {
        if self.mutation == Some(Mutation::TargetStands) {
            target.velocity_mps = [0.0; 2];
        }
    }

    pub(crate) fn scene(&self, scene: &mut Scene) {
        if self.mutation == Some(Mutation::SidesMixedUp) {
            std::mem::swap(&mut scene.d2l_m, &mut scene.d2r_m);
        }
    }

    /// The feedback input.
    pub(crate) fn feedback(&mut self, u: [f64; 2]) -> [f64; 2] {
        match self.mutation {
            Some(Mutation::FeedbackSign) => [u[0], -u[1]],
            Some(Mutation::FeedbackLags) => self.input.replace(u).unwrap_or(u),
            _ => u,
        }
    }

    /// The class of the state that the switch is told.
    pub(crate) fn region(&self, region: Region) -> Region {
        match (self.mutation, region) {
            (Some(Mutation::NoHysteresis), Region::Hysteresis) => Region::Safe,
            _ => region,
        }
    }

    /// The input that is applied.
    pub(crate) fn command(&mut self, step: &mut Step) {
        match self.mutation {
            Some(Mutation::CommandSign) => step.u_s[1] = -step.u_s[1],
            Some(Mutation::CommandLags) => {
                step.u_s = self.input.replace(step.u_s).unwrap_or(step.u_s);
            }
            _ => {}
        }
    }
}
