//! An arm with its meter: walked beside another, measured on its own.

use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;

use anyhow::{Context as _, Result};
use compare::{Measured, Meter};
use controller::Spec;
use schemas::{Event, Header, Reason, Scenario, Stamped, Step, Time};

use super::{Arm, caught};
use crate::controller_choice::ControllerChoice;
use crate::explain::trace;

/// An arm with its meter.
pub(super) struct Side {
    arm: RefCell<Arm>,
    /// The controller that is replayed; `None` for a recorded arm.
    spec: Option<Spec>,
    scenario: Scenario,
    /// Who drove in the step before: k, and whether the safety layer altered the input.
    drove: Cell<Option<(f64, bool)>>,
    meter: RefCell<Meter>,
    failed: RefCell<Option<anyhow::Error>>,
    start: Time,
    /// The newest event, seconds from the start.
    last_s: Cell<f64>,
}

impl Side {
    /// An arm that is walked alone, or beside another.
    pub(super) fn new(
        header: &Header,
        choice: &ControllerChoice,
        arm: Arm,
        other: Option<&Side>,
    ) -> Side {
        let spec = match choice {
            ControllerChoice::Recorded => None,
            version @ ControllerChoice::Version { .. } => version.for_log(header).ok(),
        };
        // The recording's own parameters are those of another controller.
        let params_toml =
            spec.as_ref().map_or_else(|| header.params_toml.clone(), Spec::params_toml);
        let header = &Header { params_toml, ..header.clone() };
        let meter = match other {
            Some(other) => other.meter.borrow().beside(header),
            None => Meter::new(header),
        };
        Side {
            meter: RefCell::new(meter),
            arm: RefCell::new(arm),
            spec,
            scenario: header.scenario.clone(),
            drove: Cell::new(None),
            failed: RefCell::new(None),
            start: header.run.start,
            last_s: Cell::new(0.0),
        }
    }

    /// The next event. A failure ends this side alone: the other is measured to its end.
    pub(super) fn next_event(&self) -> Option<Stamped<Event>> {
        let next = self.arm.borrow_mut().next_event();
        let asked = next.and_then(|event| {
            if let Some(event) = &event {
                self.meter.borrow_mut().observe(event);
                self.last_s.set(event.at.seconds_since(self.start));
                if let Event::Step(step) = &event.value {
                    self.ask(step)?;
                }
            }
            Ok(event)
        });
        asked.unwrap_or_else(|error| {
            *self.failed.borrow_mut() = Some(error);
            None
        })
    }

    /// Asks the controller, where another drives than in the step before, which echo that hangs on: the
    /// one that ends D, or that the safety layer looks at.
    fn ask(&self, step: &Step) -> Result<()> {
        let drives = (step.k, step.projected);
        if self.drove.replace(Some(drives)).is_none_or(|before| before == drives) {
            return Ok(());
        }
        let arm = self.arm.borrow();
        let (Arm::Replayed(replay), Some(spec)) = (&*arm, &self.spec) else { return Ok(()) };
        let kept_back = step.reason == Reason::WouldBeProjected || step.projected;
        // What a controller says of itself it may get wrong like all the rest.
        let ray = caught(|| {
            let look = replay.runner().look()?;
            if kept_back {
                return look.shielded(step.u_h, false)?.ray;
            }
            let (requested, present) = trace::travel_rays(&look, step, spec, &self.scenario);
            // Asked about both speeds, D is that of the one that is nearer to danger.
            let present = present.filter(|ray| ray.free_m == step.distance_human_m);
            Some(present.unwrap_or(requested))
        })?;
        if let Some(echo) = ray.and_then(|ray| ray.echo) {
            self.meter.borrow_mut().ended_by(echo.fired, echo.range_m);
        }
        Ok(())
    }

    /// When the arm parted from the recording, or where it ended without; `None` in open loop.
    pub(super) fn horizon_s(&self) -> Option<f64> {
        match &*self.arm.borrow() {
            Arm::Recorded(_) => None,
            Arm::Replayed(replay) => {
                let horizon = replay.horizon()?;
                Some(horizon.first_s().unwrap_or(self.last_s.get()))
            }
        }
    }

    pub(super) fn finish(self, unmet: &mut BTreeSet<String>) -> Result<Measured> {
        if let Some(error) = self.failed.into_inner() {
            return Err(error);
        }
        let finished = self.arm.into_inner().finish(unmet);
        finished.context("only part of the log could be replayed")?;
        Ok(self.meter.into_inner().finish()?)
    }
}
