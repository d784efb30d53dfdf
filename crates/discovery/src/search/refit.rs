//! Refits the best candidates with free shapes.

use crate::search::screen::{Screened, ranked, screen};
use estimation::data::case::{Case, Waveform};
use estimation::data::study::{Study, Trial};
use estimation::fit::output_error::{Effort, Fit, fit, fit_near};
use estimation::model::prediction::SpeedObserver;
use estimation::model::prior::Hypothesis;
use estimation::proof::accept::{adequate, explained, proven};
use motor::effect::expression;
use motor::effects::names;
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Candidates that are refitted.
const CONFIRMED: usize = 6;
/// Points of a shape grid from which a refit may start.
const STARTS: usize = 3;
/// A candidate that has not improved the squared error by this factor soon is given up.
const HOPELESS: f64 = 0.97;
/// Error above which a model is poor: hopeless refits are given up, unlikely ones are tried.
const POOR: f64 = 1.1;
/// Error above which a freely running fit may have settled in a local minimum.
const LOCAL_MINIMUM_ERROR: f64 = 1.5;
/// Rate at which the observer draws the modelled speed to the measured one, 1/s.
const OBSERVER: f64 = 200.0;
/// Screened gain of error below which nothing can pass the proofs.
const LEAST_GAIN: f64 = 0.005;

/// Share of the excess that the linearised candidate may leave to be likely.
const LIKELY: f64 = 0.6;
/// Error below which no further candidates are looked for.
const SOLVED: f64 = 1.05;

/// Share of the excess that a candidate explains when no lower minimum is looked for.
const SETTLED_SHARE: f64 = 0.9;

/// A candidate effect, refitted together with everything else.
#[derive(Clone, Debug)]
pub(crate) struct Candidate {
    /// Name of the effect.
    pub name: &'static str,
    /// Its refit.
    pub trial: Trial,
    /// Error over noise: geometric mean of folds and proof.
    pub error: f64,
}

/// Result of one round of screening and confirming.
#[derive(Clone, Debug)]
pub(crate) struct Round {
    /// Every effect at its best grid point (linearised), best first.
    pub screened: Vec<Screened>,
    /// Refitted candidates, best first.
    pub candidates: Vec<Candidate>,
}

impl Round {
    /// Nothing was asked.
    pub fn empty() -> Self {
        Self {
            screened: Vec::new(),
            candidates: Vec::new(),
        }
    }
}

/// Where a refit starts: the fit on top of which it was screened, and the grid points of one effect.
#[derive(Clone, Debug)]
struct Start<'a> {
    fit: &'a Fit,
    group: Vec<Screened>,
}

/// A short refit, to choose between starts.
fn short(observer: SpeedObserver) -> Effort {
    Effort {
        iterations: 3,
        observer,
        abandon_above: f64::INFINITY,
    }
}

/// A round on its way: the likeliest candidates are refitted, the others wait.
pub(crate) struct Begun<'a> {
    study: &'a Study,
    base: &'a Trial,
    excluded: &'a [&'a str],
    groups: Vec<Vec<Screened>>,
    rest: Vec<Start<'a>>,
    candidates: Vec<Candidate>,
    led: bool,
}

/// Screens all effects on top of `base` and refits the most promising; `tell` hears which of the two is being done.
pub(crate) fn begin<'a>(
    study: &'a Study,
    base: &'a Trial,
    excluded: &'a [&'a str],
    tell: &mut dyn FnMut(&str),
) -> Begun<'a> {
    tell("screening all effects");
    let screened = screen(&study.fitted.case, &study.prior, &base.fit, excluded);
    let groups = ranked(&screened, STARTS);
    tell("refitting the likeliest");
    let error = study.fold_error(&base.folds);
    let (likely, rest) = promising(study, &base.fit, &groups, error);
    Begun {
        candidates: confirm(study, base, &likely),
        study,
        base,
        excluded,
        groups,
        rest,
        led: false,
    }
}

impl Begun<'_> {
    /// The best candidate so far that is proven.
    pub fn proven(&self) -> Option<&Candidate> {
        let mut all = self.candidates.iter();
        all.find(|c| proven(self.study, self.base, &c.trial))
    }

    /// Where nothing explains the recording and the base may have settled in a local minimum: candidates from a start that
    /// the measured speed leads, with the nominals at their priors (`nominal`).
    pub fn lead(&mut self, nominal: &Hypothesis) {
        let (study, base) = (self.study, self.base);
        let error = study.fold_error(&base.folds);
        let is_settled = |c: &Candidate| settled(study, base, c);
        if self.led
            || self.candidates.first().is_some_and(is_settled)
            || !may_be_local_minimum(&study.fitted.case, error)
        {
            return;
        }
        self.led = true;
        let led = refitted_with_observer(study, base, nominal, self.excluded);
        self.candidates.extend(led);
        self.candidates.sort_by(|a, b| a.error.total_cmp(&b.error));
    }

    /// The round with what is refitted so far.
    pub fn enough(self) -> Round {
        Round {
            candidates: best_of_each(self.candidates),
            screened: self.groups.into_iter().map(|g| g[0].clone()).collect(),
        }
    }

    /// The whole round: where nothing explains the recording, less likely candidates, and other minima.
    ///
    /// `nominal` is the base with the nominals at their priors, from which a fit that settled in a local minimum starts
    /// again.
    pub fn finish(mut self, nominal: &Hypothesis) -> Round {
        let (study, base) = (self.study, self.base);
        self.lead(nominal);
        let is_settled = |c: &Candidate| settled(study, base, c);
        let open = !self.candidates.first().is_some_and(is_settled);
        if open && self.candidates.iter().all(|c| c.error > SOLVED) {
            self.candidates.extend(confirm(study, base, &self.rest));
        }
        let explains = |c: &Candidate| adequate(study, &c.trial);
        if !adequate(study, base) && !self.candidates.iter().any(explains) {
            let starts = second_chances(&base.fit, &self.groups);
            self.candidates.extend(confirm(study, base, &starts));
        }
        self.enough()
    }
}

/// Whether no lower minimum needs to be looked for.
fn settled(study: &Study, base: &Trial, c: &Candidate) -> bool {
    c.error < SOLVED
        || explained(study, base, &c.trial) > SETTLED_SHARE && c.error < LOCAL_MINIMUM_ERROR
}

/// Whether a fit with this error may have gone astray, and a measured speed can lead it.
fn may_be_local_minimum(case: &Case, error: f64) -> bool {
    error > LOCAL_MINIMUM_ERROR && case.waveform().is_some_and(Waveform::judges_speed)
}

/// Effects whose linear estimate has an impossible sign: from a base in a local minimum that is no verdict.
fn second_chances<'a>(fit: &'a Fit, groups: &[Vec<Screened>]) -> Vec<Start<'a>> {
    let impossible =
        |g: &&Vec<Screened>| !g[0].possible && !g[0].config.effect.descriptor().is_resonance();
    let start = |group: &Vec<Screened>| Start {
        fit,
        group: group.clone(),
    };
    groups.iter().filter(impossible).map(start).collect()
}

/// Screens all effects and refits only those that may explain most of the excess.
pub(crate) fn likely(study: &Study, base: &Trial, excluded: &[&str]) -> Round {
    let groups = ranked(
        &screen(&study.fitted.case, &study.prior, &base.fit, excluded),
        STARTS,
    );
    let (likely, _) = promising(study, &base.fit, &groups, study.fold_error(&base.folds));
    Round {
        candidates: confirm(study, base, &likely),
        screened: groups.into_iter().map(|g| g[0].clone()).collect(),
    }
}

/// Error over noise that a linearised candidate promises at most to be likely on top of a model with the error `own`.
pub(crate) fn likely_below(own: f64) -> f64 {
    (1.0 + LIKELY * (own * own - 1.0).max(0.0)).sqrt()
}

/// The likeliest effects on top of a model that is taken for granted, refitted, of those that promise less than an error over
/// noise of `limit`.
pub(crate) fn seconds(
    study: &Study,
    base: &Trial,
    excluded: &[&str],
    count: usize,
    limit: f64,
) -> Vec<Candidate> {
    let screened = screen(&study.fitted.case, &study.prior, &base.fit, excluded);
    let start = |group: Vec<Screened>| Start {
        fit: &base.fit,
        group,
    };
    let promises = |group: &Vec<Screened>| study.fold_error(&group[0].held_out) < limit;
    let groups = ranked(&screened, STARTS).into_iter().filter(promises);
    let groups = groups.take(count);
    let starts: Vec<Start<'_>> = groups.map(start).collect();
    confirm(study, base, &starts)
}

/// Starts again from the priors with the speed drawn to the measured one.
fn refitted_with_observer(
    study: &Study,
    base: &Trial,
    nominal: &Hypothesis,
    excluded: &[&str],
) -> Vec<Candidate> {
    let (case, prior) = (&study.fitted.case, &study.prior);
    let observed = fit(case, prior, nominal, short(SpeedObserver::On(OBSERVER)));
    let groups = ranked(&screen(case, prior, &observed, excluded), STARTS);
    let (likely, rest) = promising(study, &observed, &groups, f64::INFINITY);
    let mut candidates = confirm(study, base, &likely);
    if candidates.first().is_none_or(|c| c.error > SOLVED) {
        candidates.extend(confirm(study, base, &rest));
    }
    candidates
}

/// The first few groups that can still matter: the likely ones and the rest.
fn promising<'a>(
    study: &Study,
    fit: &'a Fit,
    groups: &[Vec<Screened>],
    error: f64,
) -> (Vec<Start<'a>>, Vec<Start<'a>>) {
    let start = |group: &Vec<Screened>| Start {
        fit,
        group: group.clone(),
    };
    let screened = |s: &Start<'_>| study.fold_error(&s.group[0].held_out);
    // Shapes move during a refit: a bad model may gain more than its secant promises.
    let matters = |s: &Start<'_>| error > POOR || screened(s) < (1.0 - LEAST_GAIN) * error;
    let starts = groups.iter().map(start).filter(matters).take(CONFIRMED);
    let own = study.fold_error(&[signal::dot(&fit.residual, &fit.residual)]);
    let limit = likely_below(own);
    let (mut likely, mut rest) = (Vec::new(), Vec::new());
    for s in starts {
        if likely.is_empty() || screened(&s) < limit {
            likely.push(s);
        } else {
            rest.push(s);
        }
    }
    (likely, rest)
}

fn confirm(study: &Study, base: &Trial, starts: &[Start<'_>]) -> Vec<Candidate> {
    let one = |start: &Start<'_>| candidate(study, base, start);
    best_of_each(starts.par_iter().map(one).collect())
}

/// Several forms and starts of one effect are one answer: the best speaks for it.
fn best_of_each(mut candidates: Vec<Candidate>) -> Vec<Candidate> {
    candidates.sort_by(|a, b| a.error.total_cmp(&b.error));
    let mut seen = BTreeSet::new();
    candidates.retain(|c| seen.insert(c.name));
    candidates
}

fn candidate(study: &Study, base: &Trial, start: &Start<'_>) -> Candidate {
    let chosen = chosen(study, start);
    // On top of a model that already fits nothing improves the error by much: every refit is finished.
    let poor = study.fold_error(&base.folds) > POOR;
    let limit = HOPELESS * signal::dot(&base.fit.residual, &base.fit.residual);
    let effort = Effort {
        abandon_above: if poor { limit } else { f64::INFINITY },
        ..Effort::FULL
    };
    let trial = match chosen.nearby {
        Some(nearby) => study.trial_near(&chosen.hypothesis, effort, &nearby),
        None => study.trial(&chosen.hypothesis, effort),
    };
    Candidate {
        name: start.group[0].config.effect.descriptor().name,
        error: combined(study, &trial),
        trial,
    }
}

/// Where a refit begins, and the derivatives nearby with respect to its first free coordinates, where they are known.
struct Chosen {
    hypothesis: Hypothesis,
    nearby: Option<Vec<Vec<f64>>>,
}

/// The likeliest point of a group; where the screen cannot tell, the one at which a short refit ends best.
fn chosen(study: &Study, start: &Start<'_>) -> Chosen {
    let (case, prior) = (&study.fitted.case, &study.prior);
    let (observer, nearby) = (start.fit.observer, &start.fit.jacobian);
    let runs_freely = observer == SpeedObserver::Off;
    let tries = match start.group[0].config.effect.descriptor().is_resonance() {
        true => start.group.len(),
        false => usize::from(!runs_freely),
    };
    let here = &start.fit.hypothesis;
    let at = |point: &Screened| here.with(point.config.clone(), &prior.plant.rated);
    let tried = |point| fit_near(case, prior, &at(point), short(observer), nearby);
    let sse = |f: &Fit| signal::dot(&f.residual, &f.residual);
    let fits = start.group[..tries].iter().map(tried);
    match fits.min_by(|a, b| sse(a).total_cmp(&sse(b))) {
        Some(best) => Chosen {
            hypothesis: best.hypothesis,
            nearby: runs_freely.then_some(best.jacobian),
        },
        None => Chosen {
            hypothesis: at(&start.group[0]),
            nearby: Some(nearby.clone()),
        },
    }
}

/// Refits one effect, every form of it, from the present nominals and from the priors.
pub(crate) fn only(study: &Study, base: &Trial, effect: &str) -> Vec<Candidate> {
    let (case, prior) = (&study.fitted.case, &study.prior);
    let all = names().into_iter().chain([expression::NAME]);
    let others: Vec<&str> = all.filter(|n| *n != effect).collect();
    let start = |fit| {
        let groups = ranked(&screen(case, prior, fit, &others), STARTS);
        let one = |group: Vec<Screened>| Start { fit, group };
        groups.into_iter().map(one).collect::<Vec<_>>()
    };
    let led = may_be_local_minimum(case, study.fold_error(&base.folds)).then(|| {
        let observer = SpeedObserver::On(OBSERVER);
        fit(case, prior, &study.at_prior(), short(observer))
    });
    let fits = std::iter::once(&base.fit).chain(&led);
    let starts: Vec<Start<'_>> = fits.flat_map(start).collect();
    confirm(study, base, &starts)
}

/// The trial of the best candidate.
pub(crate) fn best_of(candidates: Vec<Candidate>) -> Option<Trial> {
    candidates.into_iter().next().map(|c| c.trial)
}

/// Geometric mean of the error by folds and by proof.
pub(crate) fn combined(study: &Study, trial: &Trial) -> f64 {
    (study.fold_error(&trial.folds) * study.proof_error(trial)).sqrt()
}

#[cfg(test)]
mod tests;
