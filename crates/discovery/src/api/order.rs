//! Two recordings, asked about in the order that explains more.
//!
//! Only what the fitted recording visits can be learnt from it: a pump's torque up to 35 Hz says little of 60 Hz, and a motor that
//! stands on one load leaves half of its parameters open. Which of two recordings shows more of a thing that nobody knows yet is
//! seen when it was asked for.

use estimation::data::given::{One, Sources};
use estimation::data::question::{Error, Question};
use estimation::data::study::{Study, Trial};
use estimation::fit::output_error::Effort;
use estimation::proof::accept::{adequate, adequate_on_folds};
use motor::MotorFile;

use super::Progress;

/// An answer, and the question that it answers.
pub(super) struct Answer<T> {
    /// The recordings as they were asked about.
    pub question: Question,
    /// What was found.
    pub found: T,
    /// Whether the second of the two recordings is the fitted one.
    pub other_order: bool,
}

/// What an answer explains of the recordings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Explains {
    /// Nothing is proven.
    Nothing,
    /// What is proven leaves something.
    Part,
    /// Nothing provable is left.
    All,
}

/// A question, and the model with its parameters refitted and nothing added.
struct Begun {
    question: Question,
    baseline: Trial,
}

/// Asks about the recordings as they are given. Where that leaves something of two whole ones, asks also with the second one fitted,
/// which is the answer if it explains more; it is so without asking where the first one shows nothing but too little of the parameters.
/// What is asked gets the study, and the model with its parameters refitted.
///
/// # Errors
/// As [`Question::new`] of the recordings as they are given.
pub(super) fn in_either_order<T>(
    sources: Sources<'_>,
    motor: &MotorFile,
    ask: impl Fn(&Study, Trial, &mut Progress<'_>) -> T,
    explains: impl Fn(&Study, &T) -> Explains,
    progress: &mut Progress<'_>,
) -> Result<Answer<T>, Error> {
    let given = Begun::of(sources, motor, progress)?;
    if !are_two_wholes(&given.question) {
        return Ok(given.asked(&ask, false, progress));
    }
    let turned: Vec<One<'_>> = sources.iter().rev().collect();
    let mut other = None;
    if given.shows_too_little() {
        other = Begun::of(Sources::Listed(&turned), motor, progress).ok();
        if let Some(other) = other.take_if(|other| other.is_adequate()) {
            return Ok(other.asked(&ask, true, progress));
        }
    }
    let explained = |answer: &Answer<T>| explains(&answer.question.study, &answer.found);
    let given = given.asked(&ask, false, progress);
    let so_far = explained(&given);
    if so_far == Explains::All {
        return Ok(given);
    }
    let mut tell =
        |what: &str, share| progress(&format!("{what}, the second recording fitted"), share);
    let other = match other {
        Some(other) => Some(other),
        None => Begun::of(Sources::Listed(&turned), motor, &mut tell).ok(),
    };
    let other = other.map(|other| other.asked(&ask, true, &mut tell));
    let better = other.filter(|other| explained(other) > so_far);
    Ok(better.unwrap_or(given))
}

impl Begun {
    fn of(
        sources: Sources<'_>,
        motor: &MotorFile,
        progress: &mut Progress<'_>,
    ) -> Result<Self, Error> {
        let question = Question::new(sources, motor, progress)?;
        progress("refitting the parameters", 0.1);
        let study = &question.study;
        Ok(Self {
            baseline: study.trial(&study.at_prior(), Effort::FULL),
            question,
        })
    }

    /// Whether nothing is missing.
    fn is_adequate(&self) -> bool {
        adequate(&self.question.study, &self.baseline)
    }

    /// Whether nothing is missing in the fitted recording, and its parameters do not explain the other one.
    fn shows_too_little(&self) -> bool {
        !self.is_adequate() && adequate_on_folds(&self.question.study, &self.baseline.folds)
    }

    fn asked<T>(
        self,
        ask: &impl Fn(&Study, Trial, &mut Progress<'_>) -> T,
        other_order: bool,
        progress: &mut Progress<'_>,
    ) -> Answer<T> {
        Answer {
            found: ask(&self.question.study, self.baseline, progress),
            question: self.question,
            other_order,
        }
    }
}

/// Two recordings over time, neither too long to be taken whole.
fn are_two_wholes(question: &Question) -> bool {
    let study = &question.study;
    let fitted = study.fitted.case.waveform();
    let is_whole = fitted.is_some_and(|waveform| waveform.timeline.cuts.is_empty());
    is_whole && study.proofs.len() == 1 && question.stretches.is_empty()
}
