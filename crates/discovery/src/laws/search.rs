//! Which law is missing: screened, refitted, proven as an effect must be.

use crate::bursts::pulse::Pulse;
use crate::laws::formula::prove::Proven;
use crate::laws::menu::menu;
use crate::laws::modes::{self, Modes};
use crate::laws::refine::refined;
use crate::laws::screen::{Screened, best_stiffness, screen};
use crate::laws::sensitivity::Sensitivities;
use crate::search::refit::combined;
use estimation::data::case::Waveform;
use estimation::data::study::{Study, Trial};
use estimation::fit::output_error::{Effort, fit, fit_knowing};
use estimation::model::prediction::SpeedObserver;
use estimation::proof::accept::{adequate, explained, proven, surpasses};
use motor::effect::curve::Action;
use rayon::prelude::*;

/// Laws that are refitted.
const REFITTED: usize = 6;
/// Error over noise above which the fit may have settled in a local minimum: the measured speed leads a second screen.
const ASTRAY: f64 = 3.0;
/// Laws of the second screen that are refitted too.
const REFITTED_ASTRAY: usize = 4;
/// Rate at which the observer of the second screen draws the speed, 1/s.
const OBSERVER: f64 = 15.0;
/// Share of the best law's gain that a tied one reaches.
const TIED: f64 = 0.5;
/// Share of the first law's gain that another one reaches soon, or is given up.
const HOPEFUL: f64 = 0.3;
/// Laws whose knots may go where they are needed, as long as what they leave is ...
const REFINED: usize = 2;
/// ... at most so many times what the best one leaves.
const NEARLY: f64 = 1.5;
/// Times that they may.
const ROUNDS: usize = 3;
/// First refit and the one after the stiffness was chosen anew, iterations.
const ITERATIONS: [usize; 2] = [5, 3];

/// A law that was refitted.
#[derive(Clone, Debug)]
pub(crate) struct Refitted {
    /// Where and over what.
    pub action: Action,
    /// Its refit.
    pub trial: Trial,
    /// Error over noise: geometric mean of folds and proof.
    pub error: f64,
}

/// A law that explains what the library leaves.
#[derive(Clone, Debug)]
pub(crate) struct LawStep {
    /// Where and over what.
    pub action: Action,
    /// The model with it.
    pub trial: Trial,
    /// The model before it.
    pub before: Trial,
    /// Laws that explain the recordings as well.
    pub rivals: Vec<Refitted>,
    /// Whether it is proven on a recording that was not fitted.
    pub proven: bool,
    /// Formulas that explain the recordings as well as the curve, simplest first.
    pub formulas: Vec<Proven>,
    /// Bursts of each recording, the fitted one first, where the law comes and goes; empty for a curve.
    pub bursts: Vec<Vec<Pulse>>,
}

/// Laws on top of a model, screened.
pub(crate) struct LawSearch<'a> {
    study: &'a Study,
    waveform: &'a Waveform,
    base: &'a Trial,
    sensitivities: Sensitivities<'a>,
    screened: Vec<Screened>,
}

/// The likeliest laws, refitted, best first.
#[derive(Debug)]
pub(crate) struct Laws {
    /// The refits.
    pub refitted: Vec<Refitted>,
    /// Error over noise (folds) that the screen promised of the best one.
    pub promised: f64,
}

impl<'a> LawSearch<'a> {
    /// Screens all laws on top of a model; `None` of a load table, which shows no samples.
    pub fn new(study: &'a Study, base: &'a Trial, tell: &mut dyn FnMut(&str)) -> Option<Self> {
        let case = &study.fitted.case;
        let waveform = case.waveform()?;
        tell("screening laws that no library holds");
        let sensitivities = Sensitivities::of(waveform, &study.prior, &base.fit);
        let menu = menu(waveform, sensitivities.plant(), sensitivities.motion());
        Some(Self {
            screened: screen(case, &base.fit, &sensitivities, &menu),
            sensitivities,
            study,
            waveform,
            base,
        })
    }

    /// Error over noise (folds) that the screen promises of the best law.
    pub fn promised(&self) -> f64 {
        let best = self.screened.first();
        best.map_or(f64::INFINITY, |law| self.study.fold_error(&law.held_out))
    }

    /// The likeliest laws; above three times the noise those, too, that a model led by the measured speed shows.
    pub fn refitted(self, tell: &mut dyn FnMut(&str)) -> Laws {
        let mut starts: Vec<&Screened> = self.screened.iter().take(REFITTED).collect();
        let led = self.led();
        for law in &led {
            if !starts.iter().any(|s| action(s) == action(law)) {
                starts.push(law);
            }
        }
        tell("refitting the likeliest laws");
        self.refits(&starts)
    }

    /// The first few laws of the screen, of those that promise less than an error over noise (folds) of `limit`.
    pub fn best_refitted(self, count: usize, limit: f64) -> Laws {
        let promises = |law: &&Screened| self.study.fold_error(&law.held_out) < limit;
        let starts: Vec<&Screened> = self.screened.iter().filter(promises).take(count).collect();
        self.refits(&starts)
    }

    /// The first one to its end; the others as long as they may tie with it.
    fn refits(&self, starts: &[&Screened]) -> Laws {
        let one = |law: &Screened, abandon_above: f64| {
            let columns = self.sensitivities.columns(&law.config)?;
            refit(self.study, self.base, law, columns, abandon_above)
        };
        let (first, others) = starts.split_at(starts.len().min(1));
        let first = first.first().and_then(|law| one(law, f64::INFINITY));
        let sse = |trial: &Trial| signal::dot(&trial.fit.residual, &trial.fit.residual);
        let limit = first.as_ref().map_or(f64::INFINITY, |first| {
            let (best, base) = (sse(&first.trial), sse(self.base));
            base - HOPEFUL * (base - best).max(0.0)
        });
        let rest = others.par_iter().filter_map(|law| one(law, limit));
        let mut refitted: Vec<Refitted> = rest.collect();
        refitted.extend(first);
        refitted.sort_by(|a, b| a.error.total_cmp(&b.error));
        self.refine_the_best(&mut refitted);
        Laws {
            refitted,
            promised: self.promised(),
        }
    }

    /// The best law with knots where they are needed; where that leaves something the next one, too, which may have needed them more.
    fn refine_the_best(&self, refitted: &mut [Refitted]) {
        let limit = refitted.first().map_or(0.0, |best| NEARLY * best.error);
        let finer = |law: &Refitted| refined(self.study, self.base, &law.trial);
        let best = refitted.iter_mut().take(REFINED);
        for law in best.take_while(|law| law.error <= limit) {
            for _ in 0..ROUNDS {
                let Some(trial) = finer(law) else { break };
                law.error = combined(self.study, &trial);
                law.trial = trial;
            }
            if adequate(self.study, &law.trial) {
                break;
            }
        }
        refitted.sort_by(|a, b| a.error.total_cmp(&b.error));
    }

    /// A second screen, on top of a model that the measured speed leads.
    fn led(&self) -> Vec<Screened> {
        let (case, prior) = (&self.study.fitted.case, &self.study.prior);
        let astray = self.study.fold_error(&self.base.folds) > ASTRAY;
        if !astray || !self.waveform.judges_speed() {
            return Vec::new();
        }
        let led = Effort {
            iterations: 8,
            observer: SpeedObserver::On(OBSERVER),
            abandon_above: f64::INFINITY,
        };
        let observed = fit(case, prior, &self.base.fit.hypothesis, led);
        let sensitivities = Sensitivities::of(self.waveform, prior, &observed);
        let menu: Vec<_> = self.screened.iter().map(|s| s.config.clone()).collect();
        let mut all = screen(case, &observed, &sensitivities, &menu);
        all.truncate(REFITTED_ASTRAY);
        all
    }
}

impl Laws {
    /// No laws: none was asked about.
    pub fn none() -> Self {
        Laws {
            refitted: Vec::new(),
            promised: f64::INFINITY,
        }
    }

    /// The law on top of `base`; `None` where no law explains anything.
    pub fn best(&self, study: &Study, base: &Trial) -> Option<LawStep> {
        let best = self.refitted.first()?;
        let is_proven = !study.proofs.is_empty() && proven(study, base, &best.trial);
        let leads = explained(study, base, &best.trial) > 0.0;
        leads.then(|| LawStep {
            action: best.action,
            trial: best.trial.clone(),
            before: base.clone(),
            rivals: tied(study, base, best, &self.refitted),
            proven: is_proven,
            formulas: Vec::new(),
            bursts: Vec::new(),
        })
    }
}

fn action(law: &Screened) -> Option<Action> {
    Modes::of(&law.config).map(|modes| modes.action)
}

/// A law with all parameters free; the stiffness is chosen once more where the fit has arrived. `columns`: what its modes do
/// to the outputs of the base.
fn refit(
    study: &Study,
    base: &Trial,
    law: &Screened,
    columns: Vec<Vec<f64>>,
    abandon_above: f64,
) -> Option<Refitted> {
    let (case, prior) = (&study.fitted.case, &study.prior);
    let effort = |iterations| Effort {
        iterations,
        abandon_above,
        ..Effort::FULL
    };
    let start = base
        .fit
        .hypothesis
        .with(law.config.clone(), &prior.plant.rated);
    let known = [base.fit.jacobian.clone(), columns].concat();
    let first = fit_knowing(case, prior, &start, effort(ITERATIONS[0]), known);
    let modes = Modes::of(&law.config)?;
    let n = modes::count(modes.action.coordinate);
    let (stiffness, _) = best_stiffness(
        first.free.len() - n,
        &first.penalty,
        &law.config,
        &first.blocks,
    );
    let mut again = first.hypothesis.clone();
    modes::stiffen(again.effects.last_mut()?, stiffness);
    let effort = effort(ITERATIONS[1]);
    let trial = study.measured(fit_knowing(case, prior, &again, effort, first.jacobian));
    Some(Refitted {
        action: modes.action,
        error: combined(study, &trial),
        trial,
    })
}

/// Laws that the best one does not beat and that gain at least half as much.
fn tied(study: &Study, base: &Trial, best: &Refitted, all: &[Refitted]) -> Vec<Refitted> {
    let gain = |t: &Trial| {
        let fold = study.fold_error(&base.folds) - study.fold_error(&t.folds);
        let proof = study.proof_error(base) - study.proof_error(t);
        (fold, proof)
    };
    let most = gain(&best.trial);
    let equal = |law: &&Refitted| {
        let (fold, proof) = gain(&law.trial);
        law.action != best.action
            && fold > TIED * most.0
            && proof > TIED * most.1
            && !surpasses(study, &best.trial, &law.trial)
    };
    all.iter().filter(equal).cloned().collect()
}
