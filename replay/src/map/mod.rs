//! A map from a log: what its sonars heard, from where it believed to be.
//!
//! An echo tells how far away something is, not where in the cone. Which point of its arc it came from
//! is decided by the other echoes: the points where arcs from many places meet are where something
//! stands. From there on every echo is a point and a free line of sight to it.
//!
//! 1. [`views`]: echoes with the poses at which they were fired; repetitions from one place are one.
//! 2. [`votes`]: each arc chooses the point that most other arcs agree with, and that fewest look past.
//! 3. [`walls`]: points that enough others confirm become straight faces.
//! 4. [`grid`]: lines of sight and the body's own way make space free; what was never looked at stays
//!    unknown.
//! 5. [`moving`]: points that stand where it is free at other times have moved: they become walkers.
//!
//! The map is in the frame of the estimate, and drifts with it.

mod grid;
mod moving;
#[cfg(test)]
mod tests;
mod views;
mod votes;
mod walls;

use std::io::Read;

use schemas::log::{LogReader, Topic};
use schemas::{Event, Explored, Header, Sample, Scenario, World};

use crate::{PlantEstimate, ReplayError};
use views::Views;

/// What a log tells about its surroundings.
#[derive(Clone, Debug)]
pub struct Map {
    header: Header,
    faces: Vec<walls::Face>,
    /// Faces as thin obstacles, walkers along their paths.
    world: World,
    explored: Explored,
}

impl Map {
    /// Reads a log to its end, or as far as it goes, and maps it. What the log shows of its plant tells
    /// how much of the way that the wheels turned was lost.
    ///
    /// # Errors
    /// The log holds no echo of a sonar, or no pose to hear it from.
    pub fn of_log<R: Read>(log: LogReader<R>, plant: &PlantEstimate) -> Result<Map, ReplayError> {
        let header = log.header().clone();
        let slip = plant.slip.map_or(0.0, |slip| slip.value);
        let mut log = log.only(&[Topic::Sonar, Topic::Step]);
        let mut views = Views::new(&header, slip);
        loop {
            match log.next_event() {
                Ok(Some(event)) => match event.value {
                    Event::Sample(Sample::Sonar(scan)) => views.hear(&scan),
                    Event::Step(step) => views.stand(step.stamp, &step.pose),
                    _ => {}
                },
                // A log that ends early is mapped as far as it goes.
                Err(error) if views.is_empty() => return Err(error.into()),
                Ok(None) | Err(_) => break,
            }
        }
        let views = views.finish();
        if views.is_empty() {
            return Err(ReplayError::NoEcho);
        }
        let hits = votes::choose(&views);
        let seen = grid::Evidence::gather(&views, &hits);
        let faces = walls::faces(&hits, &views, &seen);
        let walkers = moving::walkers(&hits, &faces);
        let explored = seen.explored(&faces);
        let obstacles = faces.iter().map(walls::Face::obstacle).collect();
        Ok(Map {
            world: World { obstacles, paths: walkers, ..World::default() },
            explored,
            faces,
            header,
        })
    }

    /// The world as far as it is known: what stands and what walked. Nothing stands where nothing was
    /// seen; [`Map::explored`] says where that is.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// What is free, taken, and unknown.
    pub fn explored(&self) -> &Explored {
        &self.explored
    }

    /// The faces, each from one end to the other, metres.
    pub fn faces_m(&self) -> impl Iterator<Item = [[f64; 2]; 2]> + '_ {
        self.faces.iter().map(|face| [face.from_m, face.to_m])
    }

    /// Length of all faces, metres.
    pub fn walls_m(&self) -> f64 {
        self.faces.iter().map(walls::Face::length_m).sum()
    }

    /// The log's scenario in this world.
    pub fn scenario(&self) -> Scenario {
        Scenario {
            summary: format!("Mapped from a log of {}", self.header.scenario.name),
            world: self.world.clone(),
            explored: Some(self.explored.clone()),
            ..self.header.scenario.clone()
        }
    }
}
