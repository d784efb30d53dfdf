//! Where something comes and goes: the place that the bursts of all recordings have in common.

use super::fit::{Fitted, Scene};
use super::pulse::{Pulse, have_one_sign};
use super::trace::{action, places};
use crate::laws::search::{LawStep, Refitted};
use crate::search::refit::combined;
use estimation::data::case::Waveform;
use estimation::data::study::{Study, Subject, Trial};
use estimation::data::subject::{warmth_of, with_free_windings};
use estimation::fit::normal_equations;
use estimation::fit::smoother::Wander;
use estimation::model::prior::Hypothesis;
use estimation::proof::accept::{adequate, beats, explained, may_explain};
use motor::effect::curve::Place;
use rayon::prelude::*;

/// Places whose bursts are fitted.
const FITTED: usize = 3;
/// Share of the excess that bursts explain of every recording, at least.
const EXPLAINED: f64 = 0.85;

/// Share of the excess that an amount free to wander explains at a place of bursts, at least.
const WANDERS: f64 = 0.6;

/// Bursts at one place in all recordings.
struct Candidate {
    place: Place,
    trial: Trial,
    pulses: Vec<Vec<Pulse>>,
}

impl Candidate {
    fn as_law(&self, study: &Study) -> Refitted {
        Refitted {
            action: action(self.place),
            trial: self.trial.clone(),
            error: combined(study, &self.trial),
        }
    }
}

/// What comes and goes on top of a model; `None` where nothing does, or where it is not the same in all recordings.
pub(crate) fn bursts(study: &Study, base: &Trial) -> Option<LawStep> {
    let waveform = study.fitted.case.waveform()?;
    if !waveform.timeline.cuts.is_empty() {
        return None;
    }
    let scene = scene(study, &study.fitted, &base.fit.hypothesis)?;
    let asked: Vec<Place> = places()
        .filter(|place| is_judged(waveform, *place))
        .collect();
    let one = |(place, wander): &(Place, Wander)| {
        let fitted = scene.bursts(*place, *wander)?;
        let folds = fitted.fit.held_out();
        may_explain(study, base, &folds, EXPLAINED).then(|| everywhere(study, *place, fitted))?
    };
    let least = WANDERS * study.excess(&base.fit);
    let suspected = scene.suspected(&asked, FITTED, least);
    let mut all: Vec<Candidate> = suspected.par_iter().filter_map(one).collect();
    all.retain(|candidate| have_one_sign(candidate.pulses.iter().flatten()));
    let error = |c: &Candidate| study.fold_error(&c.trial.folds) * study.proof_error(&c.trial);
    all.sort_by(|a, b| error(a).total_cmp(&error(b)));
    let best = all.first()?;
    let enough = adequate(study, &best.trial) || explained(study, base, &best.trial) > EXPLAINED;
    if !enough || !beats(&best.trial, base) {
        return None;
    }
    let rivals = all.iter().skip(1);
    let tied = rivals.filter(|c| !beats(&best.trial, &c.trial));
    Some(LawStep {
        action: action(best.place),
        rivals: tied.map(|c| c.as_law(study)).collect(),
        trial: best.trial.clone(),
        before: base.clone(),
        proven: !study.proofs.is_empty(),
        formulas: Vec::new(),
        bursts: best.pulses.clone(),
    })
}

/// A recording with a model; `None` of a load table.
fn scene<'a>(study: &'a Study, of: &'a Subject, h: &Hypothesis) -> Option<Scene<'a>> {
    Some(Scene {
        case: &of.case,
        waveform: of.case.waveform()?,
        prior: &study.prior,
        without: h.clone(),
    })
}

fn is_judged(waveform: &Waveform, place: Place) -> bool {
    match place {
        Place::Torque | Place::Friction | Place::SensorSpeed => waveform.judges_speed(),
        _ => true,
    }
}

/// The same place in the recordings that prove: the parameters are those of the fitted one, bursts and resistances their own.
fn everywhere(study: &Study, place: Place, fitted: Fitted) -> Option<Candidate> {
    let mut parameters = fitted.fit.hypothesis.clone();
    parameters.effects.pop();
    let mut pulses = vec![fitted.pulses];
    let (mut proof, mut warmth) = (Vec::new(), Vec::new());
    for subject in &study.proofs {
        let as_warm = subject.proof_of(&study.prior, &parameters).warmth;
        let scene = scene(study, subject, &with_free_windings(&parameters, as_warm))?;
        let there = scene.bursts(place, scene.wandering(place))?;
        warmth.push(warmth_of(&there.fit.hypothesis, &parameters)?);
        let rows = subject.case.blocks();
        let blocks = normal_equations::blocks(&rows, &there.fit.residual, &[]);
        proof.extend(blocks.iter().map(|block| block.sse));
        pulses.push(there.pulses);
    }
    let mut trial = study.measured(fitted.fit);
    (trial.proof, trial.warmth) = (proof, warmth);
    Some(Candidate {
        place,
        trial,
        pulses,
    })
}
