//! Recordings, asked about in the order that leaves nothing.
//!
//! Only what the fitted recording visits can be learnt from it: a pump's torque up to 35 Hz says little of 60 Hz, and a motor that
//! stands on one load leaves half of its parameters open. Which of two recordings shows more of a thing that nobody knows yet is
//! seen when it was asked for.

use estimation::data::given::{Fitted, Sources};
use estimation::data::question::{Error, Question};
use estimation::data::study::{Study, Trial};
use estimation::proof::accept::{adequate, adequate_in_each, adequate_on_folds};
use motor::MotorFile;

use super::Progress;
use crate::report::types::DifferenceReport;

/// An answer, and the question that it answers.
pub(super) struct Answer<T> {
    /// The recordings as they were asked about.
    pub question: Question,
    /// What was found.
    pub found: T,
    /// Which of them are fitted.
    pub fitted: Fitted,
    /// Where each of two alone is explained with nothing missing, but not both by the same parameters: which differ.
    pub each_alone: Option<Vec<DifferenceReport>>,
}

/// What an answer explains of the recordings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Explains {
    /// Something is left, or nothing is proven.
    Part,
    /// What is proven leaves hardly anything.
    Most,
    /// Nothing provable is left.
    All,
}

/// A question, and the model with its parameters refitted and nothing added.
struct Begun {
    question: Question,
    fitted: Fitted,
    baseline: Trial,
}

/// Asks about the recordings as they are given. Where that leaves something, asks also with the second of two fitted, or the first alone of
/// more, which is the answer if it leaves nothing: those that are fitted together may be of a motor that was cold in the one and hot in the
/// other. Where one of them or all together are explained without anything that is missing, nothing is. What is asked gets the study, and the model with its parameters refitted.
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
    let given = Begun::of(sources, motor, Fitted::AsGiven, progress)?;
    if !given.question.is_of_wholes() {
        return Ok(given.asked(&ask, progress));
    }
    let another = Fitted::another_of(sources.iter().len());
    let begin_other = |progress: &mut Progress<'_>| Begun::of(sources, motor, another, progress);
    let are_unlike = another == Fitted::First && !given.is_adequate();
    let mut other = match given.shows_too_little() || are_unlike {
        true => begin_other(progress).ok(),
        false => None,
    };
    if let Some(begun) = explained_by_more(&given, &mut other) {
        return Ok(begun.asked(&ask, progress));
    }
    let explained = |answer: &Answer<T>| explains(&answer.question.study, &answer.found);
    let alone = other.as_ref().filter(|other| other.shows_too_little());
    let each_alone = alone.filter(|_| another == Fitted::Second);
    let each_alone = each_alone.map(|other| given.differences(other));
    let given = Answer {
        each_alone,
        ..given.asked(&ask, progress)
    };
    let so_far = explained(&given);
    if so_far >= Explains::Most || given.each_alone.is_some() {
        return Ok(given);
    }
    let mut tell =
        |what: &str, share| progress(&format!("{what}, another recording fitted"), share);
    let other = other.or_else(|| begin_other(&mut tell).ok());
    let other = other.map(|other| other.asked(&ask, &mut tell));
    let better = other.filter(|other| explained(other) == Explains::All);
    Ok(better.unwrap_or(given))
}

/// Another recording or all together, where nothing is missing then.
fn explained_by_more(given: &Begun, other: &mut Option<Begun>) -> Option<Begun> {
    let other = other.take_if(|other| other.is_adequate());
    other.or_else(|| given.explained_together())
}

impl Begun {
    fn of(
        sources: Sources<'_>,
        motor: &MotorFile,
        fitted: Fitted,
        progress: &mut Progress<'_>,
    ) -> Result<Self, Error> {
        let question = Question::with(sources, motor, fitted, progress)?;
        progress("refitting the parameters", 0.1);
        Ok(Self::about(question, fitted))
    }

    fn about(question: Question, fitted: Fitted) -> Self {
        Self {
            baseline: question.study.refitted(),
            question,
            fitted,
        }
    }

    /// All recordings fitted together, where nothing is missing in any of them then.
    fn explained_together(&self) -> Option<Self> {
        if !self.shows_too_little() {
            return None;
        }
        let together = Self::about(self.question.together()?, Fitted::All);
        let explains_each =
            adequate_in_each(&self.question.study, &together.baseline.fit.hypothesis);
        (together.is_adequate() && explains_each).then_some(together)
    }

    /// The parameters that this and another recording ask for differently, each fitted alone.
    fn differences(&self, other: &Begun) -> Vec<DifferenceReport> {
        let study = &self.question.study;
        study.differences(&self.baseline, &other.question.study, &other.baseline)
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
        progress: &mut Progress<'_>,
    ) -> Answer<T> {
        Answer {
            found: ask(&self.question.study, self.baseline, progress),
            question: self.question,
            fitted: self.fitted,
            each_alone: None,
        }
    }
}
