//! The moments of a recording: the newest in memory, the older ones in a file without a name.
//!
//! Models of the person and the horizon go through them more than once, and each at its own pace. A file
//! keeps memory the same for a minute and for hours; it takes [`WIRE`] bytes a tick, ten megabytes an hour,
//! where the system keeps temporary files, and is gone with the recording. Where no such file can be made
//! or filled, the moments stay in memory.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use schemas::Pose;
use schemas::log::LogError;
use simulator::Request;

use super::{Moment, State};

/// Moments that always stay in memory: what a late sample may still change, 80 s of it.
pub(super) const KEPT: usize = 4096;

/// Bytes of a moment in the file: what is known, and seven numbers.
const WIRE: usize = 57;

/// Moments that are read at once.
const AT_ONCE: usize = 256;

/// Moments before the one asked for that are read with it: reaction times look back.
const BEHIND: usize = 32;

const REQUEST: u8 = 1;
const DEAD_MAN: u8 = 2;
const STATE: u8 = 4;

/// The moments of a recording, by their number.
#[derive(Debug)]
pub(crate) struct Moments {
    old: Option<Mutex<File>>,
    /// How many are in the file.
    filed: usize,
    recent: Vec<Moment>,
    /// How many stay in memory.
    kept: usize,
    /// Whether there is no more room in the file.
    full: bool,
    /// Why the file could not be read back.
    unreadable: OnceLock<Arc<LogError>>,
}

impl Moments {
    /// None yet; so many, one at least, will stay in memory.
    pub(super) fn new(kept: usize) -> Moments {
        let unreadable = OnceLock::new();
        Moments { old: None, filed: 0, recent: Vec::new(), kept, full: false, unreadable }
    }

    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.filed + self.recent.len()
    }

    /// What went wrong with the file, where something did: moments are missing then.
    pub(super) fn unreadable(&self) -> Option<Arc<LogError>> {
        self.unreadable.get().cloned()
    }

    /// Changes the moment of a number; those before it that are not there yet come to be, empty.
    pub(super) fn change(&mut self, index: usize, change: impl FnOnce(&mut Moment)) {
        while self.len() <= index {
            self.recent.push(Moment::default());
            self.put_away();
        }
        if let Some(moment) = index.checked_sub(self.filed).and_then(|at| self.recent.get_mut(at)) {
            return change(moment);
        }
        let mut held = [Moment::default()];
        self.file(|file| {
            read_at(file, index, &mut held)?;
            change(&mut held[0]);
            write_at(file, index, &held)
        });
    }

    /// Makes every state unknown.
    pub(super) fn forget_states(&mut self) {
        self.recent.iter_mut().for_each(|moment| moment.state = None);
        let filed = self.filed;
        self.file(|file| {
            let mut held = Vec::new();
            for first in (0..filed).step_by(AT_ONCE) {
                held.resize(AT_ONCE.min(filed - first), Moment::default());
                read_at(file, first, &mut held)?;
                for moment in &mut held {
                    moment.state = None;
                }
                write_at(file, first, &held)?;
            }
            Ok(())
        });
    }

    /// Puts the older half of what is in memory into the file, once there is twice what is to stay.
    fn put_away(&mut self) {
        if self.full || self.recent.len() < 2 * self.kept {
            return;
        }
        if self.old.is_none() {
            self.old = tempfile::tempfile().ok().map(Mutex::new);
        }
        let older = self.recent.len() - self.kept;
        let put = self.old.as_mut().is_some_and(|file| {
            let file = file.get_mut().unwrap_or_else(PoisonError::into_inner);
            write_at(file, self.filed, &self.recent[..older]).is_ok()
        });
        if put {
            self.recent.drain(..older);
            self.filed += older;
        }
        self.full = !put;
    }

    /// Works on the file; what goes wrong is kept to be told.
    fn file(&self, work: impl FnOnce(&mut File) -> io::Result<()>) {
        let Some(file) = &self.old else { return };
        let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
        if let Err(error) = work(&mut file) {
            let _ = self.unreadable.set(Arc::new(LogError::Io(error)));
        }
    }
}

impl From<Vec<Moment>> for Moments {
    fn from(recent: Vec<Moment>) -> Moments {
        Moments { recent, ..Moments::new(KEPT) }
    }
}

/// Someone who looks at the moments of a recording, mostly from one to the next.
#[derive(Clone, Debug)]
pub(crate) struct Look {
    moments: Arc<Moments>,
    /// Number of the first that is held.
    first: usize,
    held: Vec<Moment>,
}

impl Look {
    pub(super) fn new(moments: &Arc<Moments>) -> Look {
        Look { moments: Arc::clone(moments), first: 0, held: Vec::new() }
    }

    /// How many moments there are.
    pub(crate) fn len(&self) -> usize {
        self.moments.len()
    }

    /// The moment of that number; `None` after the last.
    pub(crate) fn at(&mut self, index: usize) -> Option<Moment> {
        if let Some(recent) = index.checked_sub(self.moments.filed) {
            return self.moments.recent.get(recent).copied();
        }
        let held = index.checked_sub(self.first).and_then(|at| self.held.get(at));
        if let Some(moment) = held {
            return Some(*moment);
        }
        self.first = index.saturating_sub(BEHIND);
        self.held.resize(AT_ONCE.min(self.moments.filed - self.first), Moment::default());
        let (first, held) = (self.first, &mut self.held);
        self.moments.file(|file| read_at(file, first, held));
        if self.moments.unreadable.get().is_some() {
            self.held.clear();
        }
        self.held.get(index - self.first).copied()
    }

    /// All of them, from the first to the last.
    pub(crate) fn all(mut self) -> impl Iterator<Item = Moment> {
        (0..self.len()).map_while(move |index| self.at(index))
    }
}

fn place(index: usize) -> SeekFrom {
    SeekFrom::Start((index * WIRE) as u64)
}

fn read_at(file: &mut File, first: usize, moments: &mut [Moment]) -> io::Result<()> {
    file.seek(place(first))?;
    let mut bytes = [0; AT_ONCE * WIRE];
    for some in moments.chunks_mut(AT_ONCE) {
        let bytes = &mut bytes[..some.len() * WIRE];
        file.read_exact(bytes)?;
        for (moment, bytes) in some.iter_mut().zip(bytes.as_chunks().0) {
            *moment = from_wire(bytes);
        }
    }
    Ok(())
}

fn write_at(file: &mut File, first: usize, moments: &[Moment]) -> io::Result<()> {
    file.seek(place(first))?;
    let mut bytes = Vec::with_capacity(AT_ONCE * WIRE);
    for some in moments.chunks(AT_ONCE) {
        bytes.clear();
        for moment in some {
            bytes.extend_from_slice(&to_wire(moment));
        }
        file.write_all(&bytes)?;
    }
    Ok(())
}

fn to_wire(moment: &Moment) -> [u8; WIRE] {
    let mut known = 0;
    let mut numbers = [0.0; 7];
    if let Some(Request { v_mps, omega_radps, dead_man }) = moment.request {
        known |= REQUEST | if dead_man { DEAD_MAN } else { 0 };
        numbers[..2].copy_from_slice(&[v_mps, omega_radps]);
    }
    if let Some(State { pose: Pose { x_m, y_m, theta_rad }, v_mps, omega_radps }) = moment.state {
        known |= STATE;
        numbers[2..].copy_from_slice(&[x_m, y_m, theta_rad, v_mps, omega_radps]);
    }
    let mut bytes = [known; WIRE];
    for (bytes, number) in bytes[1..].chunks_exact_mut(8).zip(numbers) {
        bytes.copy_from_slice(&number.to_le_bytes());
    }
    bytes
}

fn from_wire(bytes: &[u8; WIRE]) -> Moment {
    let [known, numbers @ ..] = bytes;
    let (numbers, _) = numbers.as_chunks::<8>();
    let number = |index: usize| f64::from_le_bytes(numbers[index]);
    let has = |what: u8| known & what != 0;
    Moment {
        request: has(REQUEST).then(|| Request {
            v_mps: number(0),
            omega_radps: number(1),
            dead_man: has(DEAD_MAN),
        }),
        state: has(STATE).then(|| State {
            pose: Pose { x_m: number(2), y_m: number(3), theta_rad: number(4) },
            v_mps: number(5),
            omega_radps: number(6),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn bits(moment: &Moment) -> impl PartialEq + std::fmt::Debug + use<> {
        let request =
            moment.request.map(|r| (r.v_mps.to_bits(), r.omega_radps.to_bits(), r.dead_man));
        let state = moment.state.map(|s| {
            [s.pose.x_m, s.pose.y_m, s.pose.theta_rad, s.v_mps, s.omega_radps].map(f64::to_bits)
        });
        (request, state)
    }

    fn number() -> impl Strategy<Value = f64> {
        prop_oneof![any::<f64>(), Just(f64::NAN), Just(-0.0)]
    }

    fn moment() -> impl Strategy<Value = Moment> {
        let request = (number(), number(), any::<bool>())
            .prop_map(|(v_mps, omega_radps, dead_man)| Request { v_mps, omega_radps, dead_man });
        let state = (number(), number(), number(), number(), number()).prop_map(
            |(x_m, y_m, theta_rad, v_mps, omega_radps)| State {
                pose: Pose { x_m, y_m, theta_rad },
                v_mps,
                omega_radps,
            },
        );
        (prop::option::of(request), prop::option::of(state))
            .prop_map(|(request, state)| Moment { request, state })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// In whatever order they come and are looked at, few or many in memory, the moments are those
        /// of a plain list, to the bit.
        #[test]
        fn moments_are_those_that_came(
            changes in prop::collection::vec((0..700_usize, moment()), 1..60),
            forgets in prop::option::of(0..60_usize),
            kept in 1..40_usize,
            looks in prop::collection::vec(0..720_usize, 40),
        ) {
            let (mut moments, mut list) = (Moments::new(kept), Vec::new());
            for (turn, (index, moment)) in changes.iter().enumerate() {
                if list.len() <= *index {
                    list.resize(index + 1, Moment::default());
                }
                list[*index] = *moment;
                moments.change(*index, |changed| *changed = *moment);
                if forgets == Some(turn) {
                    for moment in &mut list {
                        moment.state = None;
                    }
                    moments.forget_states();
                }
            }
            prop_assert!(moments.recent.len() <= 2 * kept);
            prop_assert_eq!(moments.len(), list.len());
            let moments = Arc::new(moments);
            let all: Vec<_> = Look::new(&moments).all().map(|moment| bits(&moment)).collect();
            prop_assert_eq!(all, list.iter().map(bits).collect::<Vec<_>>());
            let mut look = Look::new(&moments);
            for index in looks {
                prop_assert_eq!(look.at(index).as_ref().map(bits), list.get(index).map(bits));
            }
            prop_assert!(moments.unreadable().is_none());
        }
    }

    /// A file that lost its content is told of, and what it held is missing rather than made up.
    #[test]
    fn a_file_that_cannot_be_read_is_told_of() {
        let mut moments = Moments::new(4);
        let asked = Request { v_mps: 1.0, omega_radps: 0.0, dead_man: true };
        for index in 0..50 {
            moments.change(index, |moment| moment.request = Some(asked));
        }
        moments.old.as_ref().expect("filled").lock().expect("free").set_len(100).expect("shrinks");
        let moments = Arc::new(moments);
        let mut look = Look::new(&moments);
        assert!(look.at(49).is_some());
        assert!(moments.unreadable().is_none());
        assert_eq!(look.at(0), None);
        assert!(moments.unreadable().is_some());
        assert_eq!(Look::new(&moments).all().count(), 0);
    }
}
