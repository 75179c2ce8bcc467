//! What was asked of the world a moment ago, and the answers.
//!
//! Two runs of one session that move alike, as both arms of an open-loop comparison do, ask the same
//! things a few events apart; whoever comes second finds them answered.

use std::sync::{Arc, Mutex, PoisonError};

/// How many answers are kept: those of about a control period.
const KEPT: usize = 32;

/// The newest answers, shared by those who ask the same.
#[derive(Debug)]
pub(super) struct Answers<const N: usize, A> {
    newest: Arc<Mutex<Newest<N, A>>>,
}

#[derive(Debug)]
struct Newest<const N: usize, A> {
    /// The bits of each question, and the answer.
    kept: Vec<([u64; N], A)>,
    /// Which one is the oldest.
    oldest: usize,
}

impl<const N: usize, A> Clone for Answers<N, A> {
    /// The same answers, not a copy of them.
    fn clone(&self) -> Self {
        Answers { newest: Arc::clone(&self.newest) }
    }
}

impl<const N: usize, A> Default for Answers<N, A> {
    fn default() -> Self {
        let newest = Newest { kept: Vec::with_capacity(KEPT), oldest: 0 };
        Answers { newest: Arc::new(Mutex::new(newest)) }
    }
}

impl<const N: usize, A: Copy> Answers<N, A> {
    /// The answer to a question whose every bit counts, thought up if nobody asked lately.
    pub(super) fn of(&self, question: [f64; N], think: impl FnOnce() -> A) -> A {
        let question = question.map(f64::to_bits);
        let newest = || self.newest.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, answer)) = newest().kept.iter().find(|(asked, _)| *asked == question) {
            return *answer;
        }
        let answer = think();
        let mut newest = newest();
        if newest.kept.len() < KEPT {
            newest.kept.push((question, answer));
        } else {
            let oldest = newest.oldest;
            newest.kept[oldest] = (question, answer);
            newest.oldest = (oldest + 1) % KEPT;
        }
        answer
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_question_is_answered_once_while_it_is_new() {
        let answers = Answers::default();
        let other = answers.clone();
        assert_eq!(answers.of([1.0, f64::NAN], || 7), 7);
        assert_eq!(other.of([1.0, f64::NAN], || unreachable!("answered")), 7);
        // Zeros of different sign are different questions.
        assert_eq!(other.of([0.0, 1.0], || 8), 8);
        assert_eq!(other.of([-0.0, 1.0], || 9), 9);
        assert_eq!(answers.of([0.0, 1.0], || unreachable!("answered")), 8);
        for i in 0..KEPT {
            answers.of([2.0, i as f64], || 0);
        }
        assert_eq!(answers.of([1.0, f64::NAN], || 10), 10);
    }

    /// Who is asked for two things more than there is room for has forgotten the first two, and no other.
    #[test]
    fn the_oldest_answers_go_first() {
        let answers = Answers::default();
        for i in 0..KEPT + 2 {
            answers.of([i as f64], || i);
        }
        for i in 2..KEPT + 2 {
            assert_eq!(answers.of([i as f64], || unreachable!("answered")), i);
        }
        assert_eq!([0.0, 1.0].map(|i| answers.of([i], || 100)), [100, 100]);
        assert_eq!(answers.of([4.0], || unreachable!("answered")), 4);
        assert_eq!(answers.newest.lock().expect("no thread panicked").kept.len(), KEPT);
    }
}
