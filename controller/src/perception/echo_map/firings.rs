//! What all points of one firing have in common, kept once for all of them: few firings have many points.

use schemas::Time;

use super::points::PlacedEcho;

/// Where a firing is in the list of them.
pub(super) type Slot = u16;

/// What a sonar heard when it fired.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Firing {
    /// Which sonar, by id.
    pub(super) sonar: u8,
    /// Range of the echo, metres.
    pub(super) range_m: f64,
    /// When it fired.
    pub(super) fired: Time,
    /// The odometer then, metres.
    pub(super) odometer_m: f64,
}

impl Firing {
    /// Stands where none is: never old, and nobody's.
    const NONE: Firing = Firing { sonar: 0, range_m: 0.0, fired: Time(u64::MAX), odometer_m: 0.0 };

    /// That of an echo.
    pub(super) fn of(echo: &PlacedEcho) -> Firing {
        let PlacedEcho { sonar, range_m, fired, odometer_m, .. } = *echo;
        Firing { sonar, range_m, fired, odometer_m }
    }
}

/// The firings that something is held of. A place that has become free is taken again.
#[derive(Clone, Debug)]
pub(super) struct Firings {
    slots: Vec<Firing>,
    /// How many hold each.
    held: Vec<u16>,
    free: Vec<Slot>,
}

impl Firings {
    /// None yet; room for `most`.
    pub(super) fn new(most: usize) -> Firings {
        Firings {
            slots: Vec::with_capacity(most),
            held: Vec::with_capacity(most),
            free: Vec::with_capacity(most),
        }
    }

    pub(super) fn clear(&mut self) {
        self.slots.clear();
        self.held.clear();
        self.free.clear();
    }

    /// Every slot, in order; some may be free.
    pub(super) fn as_slice(&self) -> &[Firing] {
        &self.slots
    }

    /// Takes a firing, held once.
    pub(super) fn add(&mut self, firing: Firing) -> Slot {
        if let Some(slot) = self.free.pop() {
            self.slots[usize::from(slot)] = firing;
            self.held[usize::from(slot)] = 1;
            return slot;
        }
        self.slots.push(firing);
        self.held.push(1);
        (self.slots.len() - 1) as Slot
    }

    /// Holds it once more.
    pub(super) fn hold(&mut self, slot: Slot) {
        self.held[usize::from(slot)] += 1;
    }

    /// Lets go of it once.
    pub(super) fn release(&mut self, slot: Slot) {
        let held = &mut self.held[usize::from(slot)];
        *held -= 1;
        if *held == 0 {
            self.slots[usize::from(slot)] = Firing::NONE;
            self.free.push(slot);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn firing(number: u64) -> Firing {
        Firing { fired: Time(number), ..Firing::NONE }
    }

    /// A firing stays in its place as long as something of it is held, and then leaves it to the next one.
    #[test]
    fn a_place_is_free_when_nothing_is_held() {
        let mut firings = Firings::new(2);
        let (first, second) = (firings.add(firing(1)), firings.add(firing(2)));
        firings.hold(first);
        firings.release(first);
        assert_eq!(firings.as_slice(), [firing(1), firing(2)]);
        firings.release(first);
        assert_eq!(firings.as_slice(), [Firing::NONE, firing(2)]);
        assert_eq!(firings.add(firing(3)), first);
        firings.release(second);
        assert_eq!(firings.as_slice(), [firing(3), Firing::NONE]);
        assert_eq!(firings.add(firing(4)), second);
    }
}
