//! Recordings, asked about in the order that leaves nothing.
//!
//! Only what the fitted recording visits can be learnt from it: a pump's torque up to 35 Hz says little of 60 Hz, and a motor that
//! stands on one load leaves half of its parameters open. Which of two recordings shows more of a thing that nobody knows yet is
//! seen when it was asked for.

use crate::data::given::{Fitted, Sources};
use crate::data::question::{Error, Question};
use crate::data::study::{Study, Trial};
use crate::fit::readings::DifferenceReport;
use crate::proof::accept::{adequate, adequate_in_each, adequate_on_folds};
use motor::MotorFile;

/// Hears what is being done, and how much of it is done, 0 to 1.
type Progress<'a> = dyn FnMut(&str, f64) + 'a;

/// What is asked about recordings.
pub trait Ask {
    /// What is found.
    type Found;

    /// Asks a study, from the model with its parameters refitted on.
    fn ask(&self, study: &Study, baseline: Trial, progress: &mut Progress<'_>) -> Self::Found;

    /// Looks further where something is left, which takes long.
    fn go_on(
        &self,
        _study: &Study,
        found: Self::Found,
        _progress: &mut Progress<'_>,
    ) -> Self::Found {
        found
    }

    /// The best model so far, proven or not, where something is left.
    fn best<'a>(&self, _study: &Study, _found: &'a Self::Found) -> Option<&'a Trial> {
        None
    }

    /// What the answer explains.
    fn explains(&self, study: &Study, found: &Self::Found) -> Explains;
}

/// An answer, and the question that it answers.
pub struct Answer<T> {
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
pub enum Explains {
    /// There is no answer: what was asked cannot be asked of the recordings.
    Nothing,
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

/// Asks about the recordings as they are given. Where that leaves something, asks beside what the recorder's channels are off by, and with the second of two fitted, or the first alone of
/// more, which is the answer if it leaves nothing: those that are fitted together may be of a motor that was cold in the one and hot in the
/// other. Only where both leave something is looked further. Where one of them or all together are explained without anything that is
/// missing, nothing is.
///
/// # Errors
/// As [`Question::new`] of the recordings as they are given.
pub fn in_either_order<A: Ask>(
    asked: &A,
    sources: Sources<'_>,
    motor: &MotorFile,
    progress: &mut Progress<'_>,
) -> Result<Answer<A::Found>, Error> {
    let given = Begun::of(sources, motor, Fitted::AsGiven, progress)?;
    if !given.question.is_of_wholes() {
        let baseline = given.baseline.clone();
        let given = given.asked(asked, progress);
        let given = given.or_beside_channels(&baseline, asked, progress);
        return Ok(given.further(asked, progress));
    }
    let another = Fitted::another_of(sources.iter().len());
    let begin_other = |progress: &mut Progress<'_>| Begun::of(sources, motor, another, progress);
    let may_be_unlike = another == Fitted::First && !given.is_adequate();
    let mut other = match given.shows_too_little() || may_be_unlike {
        true => begin_other(progress).ok(),
        false => None,
    };
    if let Some(begun) = explained_by_more(&given, &mut other) {
        return Ok(begun.asked(asked, progress));
    }
    let alone = other.as_ref().filter(|other| other.shows_too_little());
    let each_alone = alone.filter(|_| another == Fitted::Second);
    let each_alone = each_alone.map(|other| given.differences(other));
    let baseline = given.baseline.clone();
    let given = Answer {
        each_alone,
        ..given.asked(asked, progress)
    };
    if given.each_alone.is_some() {
        return Ok(given);
    }
    let given = given.or_beside_channels(&baseline, asked, progress);
    if given.explains(asked) >= Explains::Most {
        return Ok(given);
    }
    let other = other.or_else(|| begin_other(&mut of_another(progress)).ok());
    let other = other.map(|other| {
        let (baseline, progress) = (other.baseline.clone(), &mut of_another(progress));
        let other = other.asked(asked, progress);
        other.or_beside_channels(&baseline, asked, progress)
    });
    let is_answer = |other: &Answer<A::Found>| other.explains(asked) == Explains::All;
    let other = match other {
        Some(other) if is_answer(&other) => return Ok(other),
        other => other,
    };
    let given = given.further(asked, progress);
    if given.explains(asked) >= Explains::Most {
        return Ok(given);
    }
    let other = other.map(|other| other.further(asked, &mut of_another(progress)));
    Ok(other.filter(is_answer).unwrap_or(given))
}

/// Progress of a question with another recording fitted.
fn of_another(progress: &mut Progress<'_>) -> impl FnMut(&str, f64) {
    move |what, share| progress(&format!("{what}, another recording fitted"), share)
}

impl<T> Answer<T> {
    fn explains(&self, asked: &impl Ask<Found = T>) -> Explains {
        asked.explains(&self.question.study, &self.found)
    }

    /// The answer, or the one beside what the recorder's channels are off by: where that explains more, or the channels alone most of what
    /// is left.
    fn or_beside_channels(
        self,
        baseline: &Trial,
        asked: &impl Ask<Found = T>,
        progress: &mut Progress<'_>,
    ) -> Self {
        let here = self.explains(asked);
        if here == Explains::All {
            return self;
        }
        progress("asking what the channels are off by", 0.8);
        let study = &self.question.study;
        let best = asked.best(study, &self.found).unwrap_or(baseline);
        let beside = study.beside_channels(baseline, best);
        let beside = beside.or_else(|| study.beside_channels(baseline, baseline));
        let Some((study, refitted)) = beside else {
            return self;
        };
        let explain_much = study.channels_explain_most(&refitted);
        let begun = Begun {
            question: self.question.about_study(study),
            fitted: self.fitted,
            baseline: refitted,
        };
        let beside = begun.asked(asked, progress);
        let there = beside.explains(asked);
        match there > here || there == here && explain_much {
            true => beside,
            false => self,
        }
    }

    fn further(self, asked: &impl Ask<Found = T>, progress: &mut Progress<'_>) -> Self {
        Self {
            found: asked.go_on(&self.question.study, self.found, progress),
            ..self
        }
    }
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

    fn asked<A: Ask>(self, asked: &A, progress: &mut Progress<'_>) -> Answer<A::Found> {
        Answer {
            found: asked.ask(&self.question.study, self.baseline, progress),
            question: self.question,
            fitted: self.fitted,
            each_alone: None,
        }
    }
}
