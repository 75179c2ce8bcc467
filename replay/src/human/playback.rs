//! The recorded joystick as a function of time.

use std::io::Read;

use schemas::log::{LogError, LogReader, Topic};
use schemas::{Event, JoystickSample, Sample};
use simulator::{Human, HumanView, Request};

use crate::ReplayError;

/// Plays the log's `/joystick` again. Where the recording has no sample, there is none here either.
pub(crate) struct Playback<R> {
    log: LogReader<R>,
    next: Option<JoystickSample>,
}

impl<R: Read> Playback<R> {
    pub(crate) fn new(log: LogReader<R>) -> Result<Playback<R>, ReplayError> {
        let mut playback = Playback { log: log.only(&[Topic::Joystick]), next: None };
        playback.read()?;
        if playback.next.is_none() {
            return Err(ReplayError::NoJoystick);
        }
        Ok(playback)
    }

    fn read(&mut self) -> Result<(), LogError> {
        self.next = None;
        while let Some(event) = self.log.next_event()? {
            if let Event::Sample(Sample::Joystick(sample)) = event.value {
                self.next = Some(sample);
                break;
            }
        }
        Ok(())
    }
}

impl<R: Read> Human for Playback<R> {
    fn joystick(&mut self, view: &HumanView) -> Option<Request> {
        let mut newest = None;
        while let Some(sample) = self.next.take_if(|sample| sample.stamp <= view.stamp) {
            newest = Some(sample);
            // Damage ends the joystick here; the reader beside this one reports it.
            if self.read().is_err() {
                break;
            }
        }
        newest.map(|sample| Request {
            v_mps: sample.v_mps,
            omega_radps: sample.omega_radps,
            dead_man: sample.dead_man,
        })
    }
}
