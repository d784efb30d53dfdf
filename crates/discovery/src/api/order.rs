//! Recordings, asked about in the order that leaves nothing.
//!
//! Only what the fitted recording visits can be learnt from it: a pump's torque up to 35 Hz says little of 60 Hz, and a motor that
//! stands on one load leaves half of its parameters open. Which of two recordings shows more of a thing that nobody knows yet is
//! seen when it was asked for.

use estimation::data::given::{Fitted, One, Sources};
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
    baseline: Trial,
}

/// Asks about the recordings as they are given. Where that leaves something of two, asks also with the second one fitted, which is the
/// answer if it leaves nothing: two recordings of a motor that was cold in the one and hot in the other are explained by neither.
/// Where the fitted recording shows too little of the parameters, and the second one or all together are explained without anything
/// that is missing, nothing is. What is asked gets the study, and the model with its parameters refitted.
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
    if !given.question.is_of_wholes() {
        return Ok(given.asked(&ask, Fitted::AsGiven, progress));
    }
    let turned: Vec<One<'_>> = sources.iter().rev().collect();
    let begin_other = |progress: &mut Progress<'_>| match turned.len() {
        2 => Begun::of(Sources::Listed(&turned), motor, progress).ok(),
        _ => None,
    };
    let mut other = match given.shows_too_little() {
        true => begin_other(progress),
        false => None,
    };
    if let Some((begun, fitted)) = explained_by_more(&given, &mut other) {
        return Ok(begun.asked(&ask, fitted, progress));
    }
    let explained = |answer: &Answer<T>| explains(&answer.question.study, &answer.found);
    let alone = other.as_ref().filter(|other| other.shows_too_little());
    let each_alone = alone.map(|other| given.differences(other));
    let given = Answer {
        each_alone,
        ..given.asked(&ask, Fitted::AsGiven, progress)
    };
    let so_far = explained(&given);
    if so_far >= Explains::Most || given.each_alone.is_some() {
        return Ok(given);
    }
    let mut tell =
        |what: &str, share| progress(&format!("{what}, the second recording fitted"), share);
    let other = other.or_else(|| begin_other(&mut tell));
    let other = other.map(|other| other.asked(&ask, Fitted::Second, &mut tell));
    let better = other.filter(|other| explained(other) == Explains::All);
    Ok(better.unwrap_or(given))
}

/// The second recording or all together, where the first one shows too little and nothing is missing then.
fn explained_by_more(given: &Begun, other: &mut Option<Begun>) -> Option<(Begun, Fitted)> {
    if !given.shows_too_little() {
        return None;
    }
    let second = other.take_if(|other| other.is_adequate());
    let second = second.map(|second| (second, Fitted::Second));
    second.or_else(|| Some((given.explained_together()?, Fitted::All)))
}

impl Begun {
    fn of(
        sources: Sources<'_>,
        motor: &MotorFile,
        progress: &mut Progress<'_>,
    ) -> Result<Self, Error> {
        let question = Question::new(sources, motor, progress)?;
        progress("refitting the parameters", 0.1);
        Ok(Self::about(question))
    }

    fn about(question: Question) -> Self {
        Self {
            baseline: question.study.refitted(),
            question,
        }
    }

    /// All recordings fitted together, where nothing is missing in any of them then.
    fn explained_together(&self) -> Option<Self> {
        let together = Self::about(self.question.together()?);
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
        fitted: Fitted,
        progress: &mut Progress<'_>,
    ) -> Answer<T> {
        Answer {
            found: ask(&self.question.study, self.baseline, progress),
            question: self.question,
            fitted,
            each_alone: None,
        }
    }
}
