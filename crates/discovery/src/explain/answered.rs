//! What was asked about a model once answers again without a fit.
//!
//! Laws and bursts are asked before the library's effects, where they may decide, and once more where the library leaves
//! something: often on top of the same model.

use crate::bursts::search::bursts;
use crate::laws::search::{LawSearch, LawStep, Laws};
use estimation::data::study::{Study, Trial};
use estimation::model::prior::Hypothesis;
use std::rc::Rc;

/// Share of the excess that the screen of a law leaves at most to be asked before bursts.
const HARDLY_ANY: f64 = 0.15;

/// Answers about the models of one study.
#[derive(Clone, Debug, Default)]
pub(crate) struct Answered {
    laws: Vec<(Hypothesis, Rc<Laws>)>,
    bursts: Vec<(Hypothesis, Option<LawStep>)>,
}

/// The answer about the same model.
fn known<'a, T>(answers: &'a [(Hypothesis, T)], base: &Trial) -> Option<&'a T> {
    let same = |(h, _): &&(Hypothesis, T)| h.is_same(&base.fit.hypothesis);
    answers.iter().find(same).map(|(_, answer)| answer)
}

impl Answered {
    /// The likeliest laws on top of a model, refitted.
    pub fn laws(&mut self, study: &Study, base: &Trial, tell: &mut dyn FnMut(&str)) -> Rc<Laws> {
        match known(&self.laws, base) {
            Some(laws) => laws.clone(),
            None => {
                let search = LawSearch::new(study, base, tell);
                let laws = search.map_or_else(Laws::none, |search| search.refitted(tell));
                self.keep(base, laws)
            }
        }
    }

    /// A law on top of a model, or what comes and goes, that decides. A law is fitted where its screen promises more than a rival explains;
    /// before bursts where that is nearly all, because no curve does as much for what comes and goes.
    pub fn decisive(
        &mut self,
        study: &Study,
        base: &Trial,
        rival: &Trial,
        decides: impl Fn(&LawStep) -> bool,
        tell: &mut dyn FnMut(&str),
    ) -> Option<LawStep> {
        let search = match known(&self.laws, base) {
            None => LawSearch::new(study, base, tell),
            Some(_) => None,
        };
        let promised = match &search {
            None => known(&self.laws, base)?.promised,
            Some(search) => search.promised(),
        };
        let law = |answered: &mut Self, tell: &mut dyn FnMut(&str)| {
            let laws = match search {
                None => known(&answered.laws, base)?.clone(),
                Some(search) => answered.keep(base, search.refitted(tell)),
            };
            laws.best(study, base).filter(&decides)
        };
        let error = |trial: &Trial| study.fold_error(&trial.folds);
        let excess = |error: f64| error * error - 1.0;
        if promised >= error(rival) {
            return self.bursts(study, base, tell).filter(&decides);
        }
        if excess(promised) < HARDLY_ANY * excess(error(base)) {
            return law(self, tell).or_else(|| self.bursts(study, base, tell).filter(&decides));
        }
        let bursts = self.bursts(study, base, tell).filter(&decides);
        bursts.or_else(|| law(self, tell))
    }

    fn keep(&mut self, base: &Trial, laws: Laws) -> Rc<Laws> {
        let laws = Rc::new(laws);
        self.laws.push((base.fit.hypothesis.clone(), laws.clone()));
        laws
    }

    /// What comes and goes on top of a model.
    pub fn bursts(
        &mut self,
        study: &Study,
        base: &Trial,
        tell: &mut dyn FnMut(&str),
    ) -> Option<LawStep> {
        if let Some(law) = known(&self.bursts, base) {
            return law.clone();
        }
        tell("looking for what comes and goes");
        let law = bursts(study, base);
        self.bursts.push((base.fit.hypothesis.clone(), law.clone()));
        law
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimation::specimen;

    #[test]
    fn what_was_asked_of_a_model_is_not_asked_again() {
        let study = specimen::study(1.0, |_| 1.0);
        let base = specimen::trial(&study);
        let mut answered = Answered::default();
        let mut told = 0;
        let mut tell = |_: &str| told += 1;
        let laws = answered.laws(&study, &base, &mut tell);
        let again = answered.laws(&study, &base.clone(), &mut tell);
        assert!(Rc::ptr_eq(&laws, &again));
        // What the screen promised is known with the laws.
        let than = |error: f64| specimen::with_errors(&study, &base, error, error);
        let mut asked_again = |error: f64| {
            answered.decisive(&study, &base, &than(error), |_| false, &mut tell);
        };
        asked_again(0.99 * laws.promised);
        asked_again(1.01 * laws.promised);
        let bursts = answered.bursts(&study, &base, &mut tell).is_some();
        assert_eq!(answered.bursts(&study, &base, &mut tell).is_some(), bursts);
        assert_eq!(told, 3, "screened, refitted, bursts: once each");
        // Another model is another question.
        let mut other = base.clone();
        other.fit.hypothesis.z[0] += 1e-9;
        answered.decisive(&study, &other, &than(0.0), |_| true, &mut |_| told += 1);
        assert_eq!(told, 5, "screened and asked for bursts");
    }
}
