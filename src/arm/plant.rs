//! The plant that a closed loop drives, and what a log says of it.

use std::path::Path;

use anyhow::Result;
use replay::{PlantClaim, PlantEstimate, Recording, Untold};

use crate::command::replay::PlantName;
use crate::logs;

/// The plant that a closed loop drives.
pub enum DrivenPlant {
    /// The one that the log claims, and how the log stands to that.
    Claimed(PlantClaim),
    /// The one that the log shows, and what it shows of it.
    Identified(PlantEstimate),
}

/// A recording on the plant that was asked for.
pub fn driven(
    path: &Path,
    recording: Recording,
    plant: PlantName,
) -> Result<(Recording, DrivenPlant)> {
    let log = logs::open_raw(path)?;
    Ok(match plant {
        PlantName::Recorded => (recording, DrivenPlant::Claimed(PlantClaim::of_log(log))),
        PlantName::Identified => {
            let found = PlantEstimate::of_log(log);
            let claimed = recording.header().scenario.plant;
            (recording.on_plant(found.applied_to(claimed)), DrivenPlant::Identified(found))
        }
    })
}

/// What a comparison says of a log's plant.
#[derive(Default)]
pub(super) struct PlantWords {
    /// Where the log contradicts the plant that is driven.
    pub(super) doubt: Option<String>,
    /// Why it says nothing of it, where it does not.
    pub(super) untold: Option<String>,
}

impl PlantWords {
    pub(super) fn of(plant: &DrivenPlant) -> PlantWords {
        let untold = |why: Untold| PlantWords { doubt: None, untold: Some(why.to_string()) };
        match plant {
            DrivenPlant::Claimed(PlantClaim::Contradicted(doubt)) => {
                PlantWords { doubt: Some(doubt.to_string()), untold: None }
            }
            DrivenPlant::Claimed(PlantClaim::Untested(why)) => untold(*why),
            DrivenPlant::Claimed(PlantClaim::Stands) => PlantWords::default(),
            DrivenPlant::Identified(found) => found.untold.map(untold).unwrap_or_default(),
        }
    }
}
