//! Whether a log is at odds with the plant that it claims.
//!
//! A closed loop drives the claimed plant. Where the recorded robot clearly was another one, everything that
//! is said about it is about the wrong robot, and has to be said so. The claim stands as long as it
//! explains what the wheels did; only where it does not is another plant looked for, and the claim is doubted
//! if that one explains them much better. What neither explains, such as a dead encoder, is no matter of
//! the plant. A log that says nothing of its plant leaves the claim untested.

use std::fmt::{self, Display, Formatter};
use std::io::Read;

use schemas::Plant;
use schemas::log::LogReader;

use super::response::unexplained;
use super::{Estimate, PlantEstimate, Seen, Untold, slip};

/// What a claimed plant may leave unexplained of what the wheels did, and another plant of what wheels or
/// robot did, root mean square, m/s and rad/s. Chosen on random sessions of plants as they are claimed, which
/// stay below half of it.
const MOST_REST: [f64; 2] = [0.05, 0.15];

/// What a claimed plant may leave unexplained with exact rays, which tell of the robot without noise: every
/// difference is one of the plant.
const EXACT_REST: [f64; 2] = [0.02, 0.05];

/// Another plant has to leave no more than this share of what the claimed one leaves, and no more than
/// [`MOST_REST`], with exact rays too: it is fitted on a grid.
const MUCH_BETTER: f64 = 0.25;

/// An effect at the very instant of a sample may be in it or not: a claimed delay is right to within this,
/// seconds.
const BETWEEN_S: f64 = 0.005;

/// How far beyond its range a claimed slip may be, as a share of the wheels' travel.
const SLIP_APART: f64 = 0.03;

/// A claim about one axis that the log is at odds with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisDoubt {
    /// What the claimed plant leaves unexplained of the speed, root mean square, m/s or rad/s.
    pub claimed_rest: f64,
    /// What the identified one does.
    pub found_rest: f64,
}

/// What a log shows where it is at odds with what it claims.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantDoubt {
    /// What is claimed.
    pub claimed: Plant,
    /// What is seen.
    pub found: PlantEstimate,
    /// Forwards.
    pub forwards: Option<AxisDoubt>,
    /// Turning.
    pub turning: Option<AxisDoubt>,
    /// Whether the wheels lose another share of their travel than is claimed.
    pub slip: bool,
    /// Whether the claimed accelerations limit anything.
    limited: bool,
    /// Whether accelerations were commanded: a limit that the law keeps to by itself is not felt.
    accelerations: bool,
}

/// How a log stands to the plant that it claims.
#[derive(Clone, Debug, PartialEq)]
pub enum PlantClaim {
    /// Nothing in it contradicts the claim.
    Stands,
    /// It says nothing that could.
    Untested(Untold),
    /// It is clearly at odds with it.
    Contradicted(Box<PlantDoubt>),
}

impl PlantClaim {
    /// Tests what a log claims of its plant. What comes after damage is not looked at.
    pub fn of_log<R: Read>(log: LogReader<R>) -> PlantClaim {
        let claimed = log.header().scenario.plant;
        Seen::in_log(log).claim(&claimed)
    }

    /// What the log shows instead, where it contradicts the claim.
    pub fn doubt(self) -> Option<PlantDoubt> {
        match self {
            PlantClaim::Contradicted(doubt) => Some(*doubt),
            PlantClaim::Stands | PlantClaim::Untested(_) => None,
        }
    }
}

impl Seen {
    /// How it stands to a claim.
    fn claim(&self, claimed: &Plant) -> PlantClaim {
        let limited = self.accelerations || claimed.limits_acceleration;
        // With exact rays the robot is seen itself, not its wheels.
        let gain = if self.exact { 1.0 - claimed.slip } else { 1.0 };
        let rest = |axis: usize, limit: f64| {
            let limit = if limited { gain * limit } else { f64::INFINITY };
            let (commands, wheels) = (&self.commands[axis], &self.wheels[axis]);
            let rests = [0.0, -BETWEEN_S, BETWEEN_S].map(|more_s| {
                let claimed = (gain, (claimed.actuator_delay_s + more_s).max(0.0), limit);
                unexplained(commands, wheels, self.accelerations, claimed)
            });
            rests.into_iter().flatten().min_by(f64::total_cmp)
        };
        let rests = [rest(0, claimed.accel_max_mps2), rest(1, claimed.alpha_max_radps2)];
        let strange = |axis: usize, most: f64| rests[axis].filter(|rest| *rest > most);
        let most = if self.exact { EXACT_REST } else { MOST_REST };
        let slips = !self.exact && self.slips_otherwise(claimed);
        if !slips && strange(0, most[0]).is_none() && strange(1, most[1]).is_none() {
            let untested = rests == [None; 2] && (self.exact || slip(&self.turns).is_none());
            return if untested { PlantClaim::Untested(self.untold()) } else { PlantClaim::Stands };
        }
        let fits = self.fits();
        let axis = |axis: usize| {
            let claimed_rest = strange(axis, most[axis])?;
            let found_rest = fits[axis].as_ref()?.rest;
            (found_rest <= MUCH_BETTER * claimed_rest && found_rest <= MOST_REST[axis])
                .then_some(AxisDoubt { claimed_rest, found_rest })
        };
        let (forwards, turning) = (axis(0), axis(1));
        // Wheels that do what no plant makes of their commands are not to be trusted with slip either.
        let trusted = fits[1].as_ref().is_some_and(|fit| fit.rest <= MOST_REST[1]);
        let slip = slips && trusted;
        if forwards.is_none() && turning.is_none() && !slip {
            return PlantClaim::Stands;
        }
        PlantClaim::Contradicted(Box::new(PlantDoubt {
            claimed: *claimed,
            found: self.estimate_of(&fits),
            forwards,
            turning,
            slip,
            limited,
            accelerations: self.accelerations,
        }))
    }

    /// Whether wheels and gyro show another slip than is claimed, in the first half of the log and in the
    /// second: a burst of it is no property of the plant.
    fn slips_otherwise(&self, claimed: &Plant) -> bool {
        let (first, second) = self.turns.split_at(self.turns.len() / 2);
        let slips = [first, second].map(slip);
        let [Some(first), Some(second)] = slips else { return false };
        let both = [first, second];
        both.iter().all(|slip| claimed.slip < slip.low - SLIP_APART)
            || both.iter().all(|slip| claimed.slip > slip.high + SLIP_APART)
    }
}

impl Display for PlantDoubt {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let limit = |limit: f64| if self.limited { limit } else { f64::INFINITY };
        f.write_str("the log contradicts the plant that it claims")?;
        let axes = [("forwards", "m/s", self.forwards), ("turning", "rad/s", self.turning)];
        for (name, unit, doubt) in axes {
            if let Some(AxisDoubt { claimed_rest, found_rest }) = doubt {
                write!(
                    f,
                    "; {name} the claimed one leaves {claimed_rest:.3} {unit} (root mean square) \
                     unexplained, what the log shows {found_rest:.3}"
                )?;
            }
        }
        let Plant { actuator_delay_s, accel_max_mps2, alpha_max_radps2, slip, .. } = self.claimed;
        let rows = [
            ("delay", " s", actuator_delay_s, self.found.delay_s),
            ("acceleration", " m/s²", limit(accel_max_mps2), self.found.accel_mps2),
            ("angular acceleration", " rad/s²", limit(alpha_max_radps2), self.found.alpha_radps2),
            ("slip", "", slip, self.found.slip),
        ];
        for (name, unit, claimed, found) in rows {
            // What the claim is right about, or the log does not tell, is no part of the contradiction.
            let Some(found) = found.filter(|found| claimed < found.low || claimed > found.high)
            else {
                continue;
            };
            let Estimate { value, low, high } = found;
            if self.accelerations && value.is_infinite() {
                continue;
            }
            let told = |x: f64| {
                if x.is_finite() { format!("{x:.3}{unit}") } else { "no limit".to_owned() }
            };
            write!(f, "; {name} {}", told(value))?;
            if value.is_finite() {
                write!(f, " ({} to {})", told(low), told(high))?;
            }
            write!(f, ", claimed {}", told(claimed))?;
        }
        Ok(())
    }
}
