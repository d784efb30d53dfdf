//! What the recordings leave open.

use super::score::{Predicted, Refit, error, known};
use crate::explain::Explanation;
use estimation::data::case::Case;
use estimation::data::study::{Study, Trial};
use estimation::fit::uncertainty::coordinate_error;
use estimation::model::prediction::{SpeedObserver, outputs};
use estimation::model::prior::{Hypothesis, N_NOMINAL, NOMINALS};
use motor::effect::{EffectConfig, Role};
use nalgebra::DMatrix;

/// Gain of error from which explanations are told apart, as proofs ask for.
pub(super) const DECISIVE: f64 = 0.02;
/// Worth of a gain beyond a sure decision: enough to choose between runs that decide all the same.
const BEYOND: f64 = 1e-2;
/// Worth of the mean over all pairs beside that of the hardest one.
const OF_ALL: f64 = 0.1;
/// Standard error of a nominal (its logarithm) from which it counts as wide.
const WIDE: f64 = 0.05;

/// An explanation with what is known about its coordinates.
pub(super) struct Candidate {
    /// Name for a person.
    pub name: String,
    hypothesis: Hypothesis,
    known: DMatrix<f64>,
}

/// What a run is to decide.
pub(super) enum Goal {
    /// Which of these explains the motor.
    Tell(Vec<Candidate>),
    /// Whether one of these is there: the model, and the model with a typical size of each.
    Show(Candidate, Vec<(String, Hypothesis)>),
    /// How large these parameters are: their positions among the free coordinates.
    Narrow(Candidate, Vec<(String, usize)>),
}

/// What a run would decide.
#[derive(Clone, Debug, Default)]
pub(super) struct Verdict {
    /// The larger the better; comparable for one goal.
    pub score: f64,
    /// For each question: its name, and the relative gain of error, or the share of the standard error that goes.
    pub gains: Vec<(String, f64)>,
}

impl Candidate {
    fn of(name: String, trial: &Trial) -> Self {
        Self {
            name,
            hypothesis: trial.fit.hypothesis.clone(),
            known: known(trial),
        }
    }
}

impl Goal {
    /// What an explanation leaves open, ties first.
    pub fn of(study: &Study, found: &Explanation) -> Option<Self> {
        let rivals = rivals(found);
        if rivals.len() > 1 {
            return Some(Self::Tell(rivals));
        }
        show(study, found).or_else(|| narrow(study, found))
    }

    /// What a run would decide.
    pub fn judge(&self, study: &Study, case: &Case) -> Verdict {
        let predicted = |c: &Candidate| Predicted::of(study, case, &c.hypothesis, &c.known);
        match self {
            Self::Tell(all) => {
                let runs: Vec<Predicted> = all.iter().map(predicted).collect();
                tells(study, case, all, &runs)
            }
            Self::Show(base, effects) => shows(study, case, &predicted(base), effects),
            Self::Narrow(base, parameters) => {
                let left = predicted(base).shares_left(study.fitted.case.judged().sqrt());
                let gain = |(name, at): &(String, usize)| (name.clone(), 1.0 - left[*at].sqrt());
                let gains: Vec<(String, f64)> = parameters.iter().map(gain).collect();
                Verdict {
                    score: gains.iter().map(|g| g.1).sum(),
                    gains,
                }
            }
        }
    }
}

/// Relative gain of error when what is wrong by `missed` goes.
fn gain_of(study: &Study, case: &Case, missed: f64) -> f64 {
    1.0 - 1.0 / error(study, case, missed)
}

/// What is gained beyond a sure decision counts for little.
fn worth(gain: f64) -> f64 {
    gain.min(2.0 * DECISIVE) + BEYOND * gain
}

/// How well a run tells each pair apart, whichever of the two is true.
fn tells(study: &Study, case: &Case, all: &[Candidate], runs: &[Predicted]) -> Verdict {
    let missed = |wrong: usize, truth: usize| runs[wrong].misses_of(&runs[truth]);
    let pairs = (0..all.len()).flat_map(|i| (0..i).map(move |j| (j, i)));
    let gains: Vec<(String, f64)> = pairs
        .map(|(j, i)| {
            let less = missed(i, j).min(missed(j, i));
            let name = format!("{} from {}", all[j].name, all[i].name);
            (name, gain_of(study, case, less))
        })
        .collect();
    // The hardest pair counts; between equals, all of them.
    let least = gains
        .iter()
        .map(|g| worth(g.1))
        .fold(f64::INFINITY, f64::min);
    let mean = gains.iter().map(|g| worth(g.1)).sum::<f64>() / gains.len().max(1) as f64;
    Verdict {
        score: least + OF_ALL * mean,
        gains,
    }
}

/// How well a run shows effects that the model `without` them lacks.
fn shows(
    study: &Study,
    case: &Case,
    without: &Predicted,
    effects: &[(String, Hypothesis)],
) -> Verdict {
    let gain = |(name, h): &(String, Hypothesis)| {
        let there = outputs(case, &study.prior, h, SpeedObserver::Off);
        (name.clone(), gain_of(study, case, without.misses(&there)))
    };
    let gains: Vec<(String, f64)> = effects.iter().map(gain).collect();
    Verdict {
        score: gains.iter().map(|g| worth(g.1)).sum(),
        gains,
    }
}

/// Explanations that the recordings cannot tell apart.
fn rivals(found: &Explanation) -> Vec<Candidate> {
    if let Some(law) = found.laws.last().filter(|law| law.bursts.is_empty()) {
        let named = |action: motor::effect::curve::Action| {
            format!("{} over {}", action.place.name(), action.coordinate.name())
        };
        let mut all = vec![Candidate::of(named(law.action), &law.trial)];
        let tied = law.rivals.iter();
        all.extend(tied.map(|rival| Candidate::of(named(rival.action), &rival.trial)));
        if all.len() == 1 && !law.proven {
            all.push(Candidate::of("no law".to_owned(), &law.before));
        }
        return all;
    }
    let last = found.last();
    if let Some(step) = found.steps.iter().find(|step| !step.rivals.is_empty()) {
        let own = step.trial.fit.hypothesis.effects.last();
        let name = own.map_or("", |config| config.effect.descriptor().name);
        let mut all = vec![Candidate::of(name.to_owned(), &step.trial)];
        let rivals = step.rivals.iter();
        all.extend(rivals.map(|rival| Candidate::of(rival.name.to_owned(), &rival.trial)));
        return all;
    }
    if let Some((k, candidates)) = found.contests.iter().find(|(_, c)| !c.is_empty()) {
        let mut all = vec![Candidate::of(NOMINALS[*k].name.to_owned(), last)];
        let rivals = candidates.iter();
        all.extend(rivals.map(|rival| Candidate::of(rival.name.to_owned(), &rival.trial)));
        return all;
    }
    Vec::new()
}

/// Effects that the recordings could not show, at a typical size.
fn show(study: &Study, found: &Explanation) -> Option<Goal> {
    let last = found.last();
    let rated = &study.prior.plant.rated;
    let refit = Refit::of(study, last);
    let mut effects: Vec<(String, Hypothesis, f64)> = Vec::new();
    for screened in &found.first.screened {
        let seen = study.visibility(screened.visible);
        let name = screened.config.effect.descriptor().name;
        let known = effects.iter().any(|(known, ..)| known == name);
        if seen < Study::VISIBLE && !known {
            let typical = typical(&screened.config, rated);
            effects.push((
                name.to_owned(),
                refit.hidden(study, last, last.fit.hypothesis.with(typical, rated)),
                seen,
            ));
        }
    }
    // Those that were nearly visible are the ones that another run may show.
    effects.sort_by(|a, b| b.2.total_cmp(&a.2));
    let effects: Vec<(String, Hypothesis)> = effects.into_iter().map(|(n, h, _)| (n, h)).collect();
    (!effects.is_empty()).then(|| Goal::Show(Candidate::of("the model".to_owned(), last), effects))
}

/// An effect at a typical size.
fn typical(config: &EffectConfig, rated: &motor::effect::Rated<f64>) -> EffectConfig {
    let mut typical = config.clone();
    let parameters = config.effect.descriptor().parameters.iter().enumerate();
    for (k, p) in parameters.filter(|(_, p)| p.role == Role::Size) {
        typical.values[k] = p.typical * p.scale.of(rated);
    }
    typical
}

/// Parameters that the recordings leave wide.
fn narrow(study: &Study, found: &Explanation) -> Option<Goal> {
    let last = found.last();
    let covariance = study.covariance(last);
    let wide = |(at, &k): (usize, &usize)| {
        let is_wide = k < N_NOMINAL && coordinate_error(last, covariance, k) > WIDE;
        is_wide.then(|| (NOMINALS[k].name.to_owned(), at))
    };
    let all: Vec<(String, usize)> = last.fit.free.iter().enumerate().filter_map(wide).collect();
    (!all.is_empty()).then(|| Goal::Narrow(Candidate::of("the model".to_owned(), last), all))
}
