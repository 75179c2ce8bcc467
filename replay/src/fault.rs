//! Faults put into a replay: named, seeded, and the same for every controller.
//!
//! A fault alters what the controller hears between the source, a log or a simulation, and the
//! session; it never alters what happened. What is random about it depends on the seed, the fault and
//! the number of the reading alone, so that two controllers meet the same faults.

mod delayed;
mod name;
mod silence;

use schemas::{Command, Event, Gap, Pulled, Sample, Source, Stamped, Time};
use simulator::{Purpose, Stream};

use delayed::Delayed;
pub use name::{BadFault, FAULTS, Fault};
use silence::Silence;

/// Farthest range that cross-talk makes up, metres.
const CROSS_TALK_M: f64 = 3.0;

/// Does to whoever steps at `t_s` what a broken controller does: never comes back, or panics.
#[expect(clippy::panic, reason = "asked for, to show what becomes of the others")]
fn break_down(faults: &[Fault], t_s: f64) {
    for fault in faults.iter().filter(|fault| fault.breaks_down_at(t_s)) {
        match fault {
            Fault::ControllerHang(_) => loop {
                std::thread::park();
            },
            Fault::ControllerPanic(at_s) => {
                panic!("as --fault controller-panic={at_s} has it");
            }
            _ => {}
        }
    }
}

/// Faults with the seed of what is random about them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Faults {
    faults: Vec<Fault>,
    seed: u64,
}

impl Faults {
    /// These faults, with this seed.
    ///
    /// # Errors
    /// One of them is there twice: whether that is to be twice as much, nobody can tell.
    pub fn new(faults: Vec<Fault>, seed: u64) -> Result<Faults, BadFault> {
        for (number, fault) in faults.iter().enumerate() {
            if faults[..number].iter().any(|before| before.clashes(fault)) {
                return Err(BadFault::Twice(fault.to_string()));
            }
        }
        Ok(Faults { faults, seed })
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.faults.is_empty()
    }

    /// Their names with their values, as they are asked for.
    pub fn names(&self) -> Vec<String> {
        self.faults.iter().map(Fault::to_string).collect()
    }

    /// The seed of what is random about them.
    pub fn seed(&self) -> u64 {
        self.seed
    }
}

/// A source whose samples are faulty.
pub(crate) struct Faulty<S> {
    source: S,
    faults: Faults,
    /// When which streams were silent.
    silence: Silence,
    start: Time,
    /// Samples so far, by kind: the numbers that noise goes by.
    counts: [u64; 5],
    /// What the joystick said when it froze, while it is frozen.
    stuck: Option<[f64; 2]>,
    delayed: Delayed,
    /// By fault, whether there was anything for it to change.
    met: Vec<bool>,
}

impl<S: Source> Faulty<S> {
    pub(crate) fn new(source: S, start: Time) -> Faulty<S> {
        Faulty {
            source,
            faults: Faults::default(),
            silence: Silence::default(),
            start,
            counts: [0; 5],
            stuck: None,
            delayed: Delayed::default(),
            met: Vec::new(),
        }
    }

    pub(crate) fn put(&mut self, faults: Faults) {
        self.met = vec![false; faults.faults.len()];
        self.faults = faults;
    }

    /// The faults that have met nothing that they could change.
    pub(crate) fn unmet(&self) -> Vec<Fault> {
        let faults = self.faults.faults.iter().zip(&self.met);
        faults.filter(|(_, met)| !**met).map(|(fault, _)| *fault).collect()
    }

    /// Lets streams fall silent as they did in a recording.
    pub(crate) fn silence(&mut self, gaps: &[Gap]) {
        self.silence = Silence::of(gaps);
    }

    /// The next thing of the source that was not lost in a gap.
    fn next_heard(&mut self) -> Result<Option<Pulled>, S::Error> {
        loop {
            let next = self.source.pull()?;
            match &next {
                Some(Pulled::Event(event)) if self.silence.swallows(&event.value) => {}
                _ => return Ok(next),
            }
        }
    }

    pub(crate) fn source_mut(&mut self) -> &mut S {
        &mut self.source
    }

    /// Alters a sample, and says how much later it arrives, seconds.
    fn alter(&mut self, sample: &mut Sample) -> f64 {
        let kind = match sample {
            Sample::Sonar(_) => 0,
            Sample::Imu(_) => 1,
            Sample::Encoders(_) => 2,
            Sample::Joystick(_) => 3,
            Sample::Exact(_) => 4,
        };
        let index = self.counts[kind];
        self.counts[kind] += 1;
        let mut late_s = 0.0;
        for (number, fault) in self.faults.faults.iter().enumerate() {
            if !self.met[number] {
                self.met[number] = fault.meets(sample, self.start);
            }
            let draw = Stream::new(self.faults.seed, Purpose::Fault(number as u8)).reading(index);
            match (fault, &mut *sample) {
                (Fault::SonarDropout(share), Sample::Sonar(scan)) => {
                    for echo in &mut scan.echoes {
                        echo.echo &= !draw.happens(u64::from(echo.id), *share);
                    }
                }
                (Fault::CrossTalk(share), Sample::Sonar(scan)) => {
                    for echo in &mut scan.echoes {
                        let id = u64::from(echo.id);
                        if draw.happens(id, *share) {
                            let most_m = if echo.echo { echo.range_m } else { CROSS_TALK_M };
                            echo.range_m = draw.between(100 + id, schemas::SONAR_BLIND_M, most_m);
                            echo.echo = true;
                        }
                    }
                }
                (Fault::SonarBias(bias_m), Sample::Sonar(scan)) => {
                    for echo in &mut scan.echoes {
                        echo.range_m = (echo.range_m + bias_m).max(schemas::SONAR_BLIND_M);
                    }
                }
                (Fault::SonarDead(id), Sample::Sonar(scan)) => {
                    for echo in scan.echoes.iter_mut().filter(|echo| echo.id == *id) {
                        echo.echo = false;
                    }
                }
                (Fault::GyroBias(bias_radps), Sample::Imu(imu)) => imu.gyro_radps[2] += bias_radps,
                (Fault::EncoderSlip(share), Sample::Encoders(encoders)) => {
                    encoders.left_m *= 1.0 + share;
                    encoders.left_mps *= 1.0 + share;
                }
                // Below: it may freeze several times.
                (_, Sample::Joystick(_)) => {}
                (Fault::Latency(latency_s), _) => late_s += latency_s,
                (Fault::Jitter(jitter_s), _) => late_s += draw.between(kind as u64, 0.0, *jitter_s),
                _ => {}
            }
        }
        if let Sample::Joystick(joystick) = sample {
            let t_s = joystick.stamp.seconds_since(self.start);
            if self.faults.faults.iter().any(|fault| fault.freezes_at(t_s)) {
                let now = [joystick.v_mps, joystick.omega_radps];
                [joystick.v_mps, joystick.omega_radps] = *self.stuck.get_or_insert(now);
            } else {
                self.stuck = None;
            }
        }
        late_s
    }
}

impl<S: Source> Source for Faulty<S> {
    type Error = S::Error;

    fn pull(&mut self) -> Result<Option<Pulled>, S::Error> {
        if self.faults.faults.is_empty() {
            return self.next_heard();
        }
        loop {
            if !self.delayed.knows_next() {
                let mut next = self.next_heard()?;
                if let Some(Pulled::Event(Stamped { at, value: Event::Sample(sample) })) = &mut next
                {
                    let late_s = self.alter(sample);
                    if late_s > 0.0 {
                        let (at, sample) = (*at, sample.clone());
                        self.delayed.hold(at + schemas::Span::from_seconds(late_s), sample);
                        continue;
                    }
                }
                self.delayed.next(next);
            }
            let next = self.delayed.take();
            if let Some(Pulled::StepDue { now, .. }) = &next {
                let t_s = now.seconds_since(self.start);
                for (fault, met) in self.faults.faults.iter().zip(&mut self.met) {
                    *met |= fault.breaks_down_at(t_s);
                }
                break_down(&self.faults.faults, t_s);
            }
            return Ok(next);
        }
    }

    fn actuate(&mut self, command: &Command) {
        self.source.actuate(command);
    }
}

#[cfg(test)]
mod tests;
