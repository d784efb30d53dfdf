//! Recordings, asked about in the order that leaves nothing.
//!
//! Only what the fitted recording visits can be learnt from it: a pump's torque up to 35 Hz says little of 60 Hz, and a motor that
//! stands on one load leaves half of its parameters open. Which of two recordings shows more of a thing that nobody knows yet is
//! seen when it was asked for.

use crate::data::given::{Fitted, Sources};
use crate::data::question::{Error, Question};
use crate::data::study::{Study, Trial};
use crate::fit::output_error::Effort;
use crate::fit::readings::DifferenceReport;
use crate::model::instruments::is_unnoticed;
use crate::proof::accept::{adequate, adequate_in_each, adequate_on_folds};
use motor::MotorFile;
use motor::effect::EffectConfig;

/// Ratio of two errors over noise that are alike.
const NO_MORE: f64 = 1.02;

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

    /// What the answer explains.
    fn explains(&self, study: &Study, found: &Self::Found) -> Explains;

    /// Whether an instrument is what is asked about: then none is taken as unknown.
    fn is_of_instruments(&self) -> bool {
        false
    }

    /// The model with everything that is named.
    fn model<'a>(&self, _found: &'a Self::Found) -> Option<&'a Trial> {
        None
    }

    /// What is named of the motor and of the instruments.
    fn named(&self, _study: &Study, _found: &Self::Found) -> NamedCounts {
        NamedCounts::default()
    }
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

/// How many things an answer names.
#[derive(Clone, Copy, Debug, Default)]
pub struct NamedCounts {
    /// That are missing in the model of the motor.
    pub of_the_motor: usize,
    /// That an instrument in good order may be off by.
    pub of_instruments: usize,
}

impl NamedCounts {
    /// Of these effects and so many laws.
    pub fn of(effects: &[EffectConfig], laws: usize) -> Self {
        let unnoticed = effects.iter().filter(|e| is_unnoticed(e.effect));
        let of_instruments = unnoticed.count();
        Self {
            of_the_motor: effects.len() - of_instruments + laws,
            of_instruments,
        }
    }
}

/// A question, and the model with its parameters refitted and nothing added.
struct Begun {
    question: Question,
    fitted: Fitted,
    baseline: Trial,
}

/// Asks about the recordings as they are given: with the instruments taken as they are and, where that leaves something, with what they may
/// be off by taken as unknown. Where both leave something, asks with the second of two fitted, or the first alone of more, which is the
/// answer if it leaves nothing: those that are fitted together may be of a motor that was cold in the one and hot in the other. Only where
/// both leave something is looked further. Where one of them or all together are explained without anything that is missing, nothing is.
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
        let given = given.asked_of_instruments_too(asked, progress);
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
    if each_alone.is_some() {
        return Ok(Answer {
            each_alone,
            ..given.asked(asked, progress)
        });
    }
    let given = given.asked_of_instruments_too(asked, progress);
    if given.explains(asked) >= Explains::Most {
        return Ok(given);
    }
    let other = other.or_else(|| begin_other(&mut of_another(progress)).ok());
    let other = other.map(|other| other.asked_of_instruments_too(asked, &mut of_another(progress)));
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

/// Progress of a question with unknown instruments.
fn beside_instruments(progress: &mut Progress<'_>) -> impl FnMut(&str, f64) {
    move |what, share| progress(&format!("{what}, instruments unknown"), share)
}

/// Progress of a question with another recording fitted.
fn of_another(progress: &mut Progress<'_>) -> impl FnMut(&str, f64) {
    move |what, share| progress(&format!("{what}, another recording fitted"), share)
}

impl<T> Answer<T> {
    fn explains(&self, asked: &impl Ask<Found = T>) -> Explains {
        asked.explains(&self.question.study, &self.found)
    }

    fn named(&self, asked: &impl Ask<Found = T>) -> NamedCounts {
        asked.named(&self.question.study, &self.found)
    }

    /// Whether the instruments are exact beside everything that is named: what is missing looked like their errors.
    fn needs_no_instrument(&self, asked: &impl Ask<Found = T>) -> bool {
        let model = asked.model(&self.found);
        model.is_some_and(|model| self.question.study.instruments_are_exact_beside(model))
    }

    /// Whether a channel is out of order beside everything that is named.
    fn blames_a_channel(&self, asked: &impl Ask<Found = T>) -> bool {
        let model = asked.model(&self.found);
        model.is_some_and(|model| self.question.study.has_a_channel_out_of_order(model))
    }

    /// Whether this answer, with the instruments as they are, names the one channel that is out of order beside another answer with unknown
    /// instruments, and leaves no more.
    fn names_the_channel_instead_of(&self, unknown: &Self, asked: &impl Ask<Found = T>) -> bool {
        let error = |answer: &Self| {
            let model = asked.model(&answer.found)?;
            Some(answer.question.study.proof_error(model))
        };
        let leaves_no_more = match (error(self), error(unknown)) {
            (Some(plain), Some(unknown)) => plain < NO_MORE * unknown,
            _ => false,
        };
        self.explains(asked) == Explains::All
            && self.named(asked).of_instruments == 1
            && leaves_no_more
            && unknown.blames_a_channel(asked)
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
        let begun = Self {
            baseline: question.study.refitted(),
            question,
            fitted,
        };
        match begun.is_adequate() {
            true => begun,
            false => begun.with_angles_in_time(),
        }
    }

    /// The same with the angles as the shaft had them: the measured speed may be late.
    fn with_angles_in_time(self) -> Self {
        let found = &self.baseline.fit.hypothesis;
        let Some(study) = self.question.study.with_angles_in_time(found) else {
            return self;
        };
        let nearby = &self.baseline.fit.jacobian;
        let baseline = match study.prior.plant.effects.is_empty() {
            true => self.baseline.clone(),
            false => study.trial_near(found, Effort::FULL, nearby),
        };
        Self {
            question: self.question.about_study(study),
            fitted: self.fitted,
            baseline,
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

    /// Asks with the instruments taken as they are, and with what they may be off by taken as unknown: that first where it explains most of
    /// what is left with nothing added.
    fn asked_of_instruments_too<A: Ask>(
        self,
        asked: &A,
        progress: &mut Progress<'_>,
    ) -> Answer<A::Found> {
        match self.with_unknown_instruments(asked, progress) {
            None => self.asked(asked, progress),
            Some(unknown) if unknown.explains_most() => self.asked_after(unknown, asked, progress),
            Some(unknown) => self.asked_before(unknown, asked, progress),
        }
    }

    /// `None` where nothing is missing, or the instruments cannot be asked about.
    fn with_unknown_instruments(
        &self,
        asked: &impl Ask,
        progress: &mut Progress<'_>,
    ) -> Option<Self> {
        if self.is_adequate() || asked.is_of_instruments() {
            return None;
        }
        progress("refitting the parameters, instruments unknown", 0.12);
        let study = &self.question.study;
        let (study, baseline) = study.with_unknown_instruments(&self.baseline)?;
        Some(Self {
            question: self.question.about_study(study),
            fitted: self.fitted,
            baseline,
        })
    }

    /// Whether what the instruments are off by explains most of what is left without.
    fn explains_most(&self) -> bool {
        self.question.study.instruments_explain_most(&self.baseline)
    }

    /// The instruments' errors explain most: what is missing beside them is the answer, unless it needs none of them. Where nothing is, an answer without them that names
    /// one of them, or that names the motor where the instruments would have to be out of order.
    fn asked_after<A: Ask>(
        self,
        unknown: Self,
        asked: &A,
        progress: &mut Progress<'_>,
    ) -> Answer<A::Found> {
        let study = &unknown.question.study;
        let in_order = study.gains_are_plausible(&unknown.baseline);
        let unknown = unknown.asked(asked, &mut beside_instruments(progress));
        let there = unknown.explains(asked);
        let is_answer = there == Explains::All && unknown.named(asked).of_the_motor > 0;
        let needs_none = is_answer && unknown.needs_no_instrument(asked);
        if is_answer && !needs_none && !unknown.blames_a_channel(asked) {
            return unknown;
        }
        let plain = self.asked(asked, progress);
        if is_answer {
            let suffices = needs_none && plain.explains(asked) == Explains::All;
            return match suffices || plain.names_the_channel_instead_of(&unknown, asked) {
                true => plain,
                false => unknown,
            };
        }
        let is_simple = plain.named(asked).of_instruments <= 1;
        match plain.explains(asked) {
            Explains::All if is_simple || !in_order || there < Explains::All => plain,
            here if here > there => plain,
            _ => unknown,
        }
    }

    /// The instruments' errors explain little: they are asked about where something is left, or where the answer needs one of them beside
    /// the motor.
    fn asked_before<A: Ask>(
        self,
        unknown: Self,
        asked: &A,
        progress: &mut Progress<'_>,
    ) -> Answer<A::Found> {
        let plain = self.asked(asked, progress);
        let here = plain.explains(asked);
        let NamedCounts {
            of_the_motor,
            of_instruments,
        } = plain.named(asked);
        let needs_both = of_the_motor > 0 && of_instruments > 0;
        if here == Explains::All && !needs_both {
            return plain;
        }
        let unknown = unknown.asked(asked, &mut beside_instruments(progress));
        match unknown.explains(asked) {
            there if there > here => unknown,
            Explains::All if needs_both => {
                match plain.names_the_channel_instead_of(&unknown, asked) {
                    true => plain,
                    false => unknown,
                }
            }
            _ => plain,
        }
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
