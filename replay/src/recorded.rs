//! The recording beside a closed-loop replay: read in step with it, to be compared and to end it.

use std::io::Read;

use controller::{Setup, Spec};
use schemas::log::{LogError, LogReader};
use schemas::{Event, Header, SensorSuite, Stamped, Step, Time};

use crate::ReplayError;

/// The sensor suite that a log was recorded with.
fn sensors_of(header: &Header) -> Result<SensorSuite, ReplayError> {
    match header.run.sensors.as_str() {
        "exact" => Ok(SensorSuite::Exact),
        "sonar" => Ok(SensorSuite::Sonar),
        other => Err(ReplayError::Sensors(other.to_owned())),
    }
}

/// What a controller is built with to be replayed on a log.
///
/// # Errors
/// The log names sensors that are none.
pub fn setup(header: &Header, spec: &Spec) -> Result<Setup, ReplayError> {
    Ok(Setup {
        spec: spec.clone(),
        sensors: sensors_of(header)?,
        scenario: header.scenario.clone(),
        start: header.run.start,
    })
}

/// A recording, walked forward by log time.
pub(crate) struct Recorded<R> {
    log: LogReader<R>,
    next: Option<Stamped<Event>>,
    damage: Option<LogError>,
    /// The recorded step seen last.
    pub(crate) step: Option<Box<Step>>,
}

impl<R: Read> Recorded<R> {
    pub(crate) fn new(log: LogReader<R>) -> Recorded<R> {
        let mut recorded = Recorded { log, next: None, damage: None, step: None };
        recorded.read();
        recorded
    }

    fn read(&mut self) {
        self.next = match self.log.next_event() {
            Ok(event) => event,
            Err(error) => {
                self.damage = Some(error);
                None
            }
        };
    }

    /// Hands every recorded event up to and including `at` to `sink`. Says whether the recording
    /// reaches as far as `at`.
    pub(crate) fn advance(&mut self, at: Time, mut sink: impl FnMut(&Stamped<Event>)) -> bool {
        let mut reached = false;
        while let Some(event) = self.next.take_if(|event| event.at <= at) {
            sink(&event);
            reached = event.at == at;
            if let Event::Step(step) = event.value {
                self.step = Some(step);
            }
            self.read();
        }
        reached || self.next.is_some()
    }

    /// What was wrong with the log, once its end was reached.
    pub(crate) fn damage(&mut self) -> Option<LogError> {
        self.damage.take()
    }
}
