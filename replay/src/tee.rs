//! One reading of a log for several replays that are walked side by side.
//!
//! Whoever comes first reads; what it reads waits for the others. The queues stay as short as the
//! replays keep together, so memory stays bounded.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::io::Read;
use std::rc::Rc;
use std::sync::Arc;

use schemas::log::{LogError, LogReader};
use schemas::{Event, Header, Stamped};

/// The events of a log, from a reader of its own or from a shared one.
pub(crate) enum Events<R> {
    /// A reader of its own.
    Own(Box<LogReader<R>>),
    /// A share of one.
    Shared(Share<R>),
}

impl<R: Read> Events<R> {
    pub(crate) fn header(&self) -> Header {
        match self {
            Events::Own(log) => log.header().clone(),
            Events::Shared(share) => share.tee.borrow().log.header().clone(),
        }
    }

    pub(crate) fn next_event(&mut self) -> Result<Option<Stamped<Event>>, Arc<LogError>> {
        match self {
            Events::Own(log) => log.next_event().map_err(Arc::new),
            Events::Shared(share) => share.next_event(),
        }
    }

    /// Shares one reader between `count` replays.
    pub(crate) fn shared(log: LogReader<R>, count: usize) -> Vec<Events<R>> {
        let queues = (0..count).map(|_| Some(VecDeque::new())).collect();
        let tee = Rc::new(RefCell::new(Tee { log, queues, damage: None }));
        (0..count).map(|own| Events::Shared(Share { tee: Rc::clone(&tee), own })).collect()
    }
}

/// One replay's share of a reader.
pub(crate) struct Share<R> {
    tee: Rc<RefCell<Tee<R>>>,
    own: usize,
}

struct Tee<R> {
    log: LogReader<R>,
    /// What each share has not yet taken; `None` for one that is gone.
    queues: Vec<Option<VecDeque<Rc<Stamped<Event>>>>>,
    /// What ended the log, told to each share once.
    damage: Option<(Arc<LogError>, Vec<bool>)>,
}

impl<R: Read> Share<R> {
    fn next_event(&mut self) -> Result<Option<Stamped<Event>>, Arc<LogError>> {
        let mut tee = self.tee.borrow_mut();
        let tee = &mut *tee;
        if let Some(event) = tee.queues[self.own].as_mut().and_then(VecDeque::pop_front) {
            return Ok(Some(Rc::unwrap_or_clone(event)));
        }
        if tee.damage.is_none() {
            match tee.log.next_event() {
                Ok(None) => return Ok(None),
                Ok(Some(event)) => {
                    let event = Rc::new(event);
                    let others = tee.queues.iter_mut().enumerate().filter(|(i, _)| *i != self.own);
                    for queue in others.filter_map(|(_, queue)| queue.as_mut()) {
                        queue.push_back(Rc::clone(&event));
                    }
                    return Ok(Some(Rc::unwrap_or_clone(event)));
                }
                Err(error) => tee.damage = Some((Arc::new(error), vec![false; tee.queues.len()])),
            }
        }
        let Some((damage, told)) = &mut tee.damage else { return Ok(None) };
        if std::mem::replace(&mut told[self.own], true) {
            Ok(None)
        } else {
            Err(Arc::clone(damage))
        }
    }
}

impl<R> Drop for Share<R> {
    /// Who goes early no longer needs to be waited for.
    fn drop(&mut self) {
        if let Ok(mut tee) = self.tee.try_borrow_mut()
            && let Some(queue) = tee.queues.get_mut(self.own)
        {
            *queue = None;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::{Recorded, record, same, scenario};
    use schemas::SensorSuite;

    fn log() -> Recorded {
        record(&scenario("random:rect:goal:2", 3.0), "human", SensorSuite::Sonar)
    }

    fn queued<R>(events: &Events<R>) -> usize {
        match events {
            Events::Own(_) => 0,
            Events::Shared(share) => {
                share.tee.borrow().queues.iter().flatten().map(VecDeque::len).sum()
            }
        }
    }

    /// In whatever order they read, each gets the whole log; nothing waits for one that is gone.
    #[test]
    fn every_share_gets_the_whole_log() {
        let log = log();
        let mut shares = Events::shared(log.open(), 3);
        let mut got = [const { Vec::new() }; 3];
        // One reads ahead, one follows, one goes home after a while.
        for turn in 0..3 * log.events.len() {
            let (reader, times) = [(0, 3), (1, 1), (2, 1)][turn % 3];
            if reader == 2 && got[2].len() >= 10 {
                if shares.len() == 3 {
                    shares.pop();
                }
                continue;
            }
            for _ in 0..times {
                got[reader].extend(shares[reader].next_event().expect("an undamaged log"));
            }
            assert!(queued(&shares[0]) <= 2 * log.events.len());
        }
        assert!(same(&got[0], &log.events));
        assert!(same(&got[1], &log.events));
        assert!(got[2].len() >= 10 && same(&got[2], &log.events[..got[2].len()]));
        assert_eq!(queued(&shares[0]), 0);
    }

    /// Damage is told to each share once, after all that stands before it.
    #[test]
    fn damage_reaches_every_share() {
        let mut log = log();
        log.bytes.truncate(log.bytes.len() / 2);
        let mut shares = Events::shared(log.open(), 2);
        let counts = [0, 1].map(|share: usize| {
            let mut count = 0;
            loop {
                match shares[share].next_event() {
                    Ok(Some(_)) => count += 1,
                    Ok(None) => panic!("the damage is told first"),
                    Err(_) => break,
                }
            }
            assert!(matches!(shares[share].next_event(), Ok(None)));
            count
        });
        assert_eq!(counts[0], counts[1]);
    }
}
