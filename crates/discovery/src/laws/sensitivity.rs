//! What a little of each mode of a law does to the outputs of a fitted model.
//!
//! One linearised run of the model serves all laws: at each place the amount of a law follows its modes along the run.

use crate::laws::modes::{Modes, SPLINES, TURN_MODES, harmonics, spline_modes};
use crate::laws::motion::Motion;
use estimation::data::case::Waveform;
use estimation::data::channels::N_CHANNELS;
use estimation::fit::output_error::Fit;
use estimation::model::prediction::{Drive, driven};
use estimation::model::prior::Prior;
use motor::effect::curve::{Action, Coordinate, Place};
use motor::effect::tangent::{Addition, Push, Response, Tangent};
use motor::effect::{EffectConfig, Hook, Plant};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Amount of a law that shows what one does, typical sizes: small against the curvature, large against rounding.
const AMOUNT: f64 = 0.05;
/// Passes through the run that a linearised one takes, counted as simulations.
const PASSES: u64 = 7;

/// A fitted model, linearised.
pub(crate) struct Sensitivities<'a> {
    waveform: &'a Waveform,
    fit: &'a Fit,
    plant: Plant,
    drive: Drive<'a>,
    tangent: Tangent,
    motion: Motion,
    pushes: Mutex<BTreeMap<(Place, bool), Arc<Push>>>,
}

impl<'a> Sensitivities<'a> {
    /// Linearises the model of a fit.
    pub fn of(waveform: &'a Waveform, prior: &Prior, fit: &'a Fit) -> Self {
        let plant = fit.hypothesis.plant(prior);
        let drive = Drive::of(waveform);
        let (tangent, outputs) = driven(waveform, &plant, &drive, fit.observer, PASSES, |run| {
            let tangent = Tangent::new(&plant, run);
            let outputs = tangent.outputs(run);
            (tangent, outputs)
        });
        let motion = Motion::of(waveform, &plant, &tangent, &outputs);
        Self {
            waveform,
            fit,
            plant,
            drive,
            tangent,
            motion,
            pushes: Mutex::default(),
        }
    }

    /// What the run visits.
    pub fn motion(&self) -> &Motion {
        &self.motion
    }

    /// What the run visits, without the run.
    pub fn into_motion(self) -> Motion {
        self.motion
    }

    /// The fit that was linearised.
    pub fn fit(&self) -> &Fit {
        self.fit
    }

    /// The model that was linearised.
    pub fn plant(&self) -> &Plant {
        &self.plant
    }

    /// Change of the weighted outputs by a typical size of each mode; `None` for a law that the model cannot bear.
    pub fn columns(&self, law: &EffectConfig) -> Option<Vec<Vec<f64>>> {
        let modes = Modes::of(law)?;
        let columns = match modes.action.coordinate.is_angle() {
            true => self.along::<TURN_MODES>(modes, harmonics),
            false => self.along::<SPLINES>(modes, |x| spline_modes(&law.values, x)),
        };
        let finite = columns.iter().flatten().all(|x| x.is_finite());
        finite.then_some(columns)
    }

    fn along<const M: usize>(
        &self,
        modes: &Modes,
        shares: impl Fn(f64) -> [f64; M],
    ) -> Vec<Vec<f64>> {
        let quantity = modes.action.place.quantity(modes.action.coordinate);
        let typical = quantity.typical * quantity.scale.of(&self.plant.rated);
        let parts = parts(modes.action).into_iter();
        let pushes: Vec<_> = parts.map(|part| (self.push(part), part)).collect();
        let additions = pushes.iter().map(|(push, part)| {
            let along = self.motion.values(part.place, part.coordinate);
            let amount = |x: &f64| shares(*x).map(|share| share * typical);
            Addition {
                push,
                amounts: along.iter().map(amount).collect(),
            }
        });
        let additions: Vec<Addition<'_, M>> = additions.collect();
        let responses = self.shown(&additions);
        responses.iter().map(|r| self.weighted(r)).collect()
    }

    /// Responses of what is recorded, one row of the case after the other.
    pub fn shown<const M: usize>(&self, additions: &[Addition<'_, M>]) -> Vec<Response> {
        let sees = |e: &EffectConfig| e.effect.hooks().contains(&Hook::Outputs);
        let keep = self.waveform.decimation;
        if !self.plant.effects.iter().any(sees) {
            return self.tangent.respond(additions, keep);
        }
        let (waveform, plant) = (self.waveform, &self.plant);
        let every = self.tangent.respond(additions, 1);
        let seen = |response: &Response| {
            driven(waveform, plant, &self.drive, self.fit.observer, 0, |run| {
                let response = self.tangent.through_instruments(plant, run, response);
                response.into_iter().step_by(keep).collect()
            })
        };
        every.iter().map(seen).collect()
    }

    /// A response as rows of the case.
    pub fn weighted(&self, response: &Response) -> Vec<f64> {
        let mut column = Vec::with_capacity(response.len() * N_CHANNELS);
        for ([a, b, c, omega], w) in response.iter().zip(&self.waveform.weight) {
            column.extend([a * w[0], b * w[1], c * w[2], omega * w[3], 0.0]);
        }
        self.waveform.nuisance.project_out(&mut column);
        column
    }

    /// The linearised run.
    pub fn tangent(&self) -> &Tangent {
        &self.tangent
    }

    /// What one of a place's quantity does within each step.
    pub fn push(&self, part: Action) -> Arc<Push> {
        if let Some(channel) = part.place.reading() {
            return Arc::new(self.tangent.reading(channel));
        }
        let key = (part.place, part.coordinate == Coordinate::PhaseCurrent);
        let mut known = self.pushes.lock().unwrap_or_else(PoisonError::into_inner);
        let push = known.entry(key).or_insert_with(|| {
            let quantity = part.place.quantity(part.coordinate);
            let size = AMOUNT * quantity.typical * quantity.scale.of(&self.plant.rated);
            let mut with = self.plant.clone();
            let range = self.motion.range(part.place, part.coordinate);
            with.effects.push(Modes::constant(part, range, size));
            let observer = self.fit.observer;
            let push = driven(self.waveform, &with, &self.drive, observer, 1, |run| {
                self.tangent.push(&with, run, size)
            });
            Arc::new(push)
        });
        push.clone()
    }
}

/// A law as laws whose amounts are one number each: a drop over each phase's own current is three.
fn parts(action: Action) -> Vec<Action> {
    let of_phases = [
        Place::StatorPhaseA,
        Place::StatorPhaseB,
        Place::StatorPhaseC,
    ];
    match (action.place, action.coordinate) {
        (Place::Stator, coordinate @ Coordinate::PhaseCurrent) => {
            of_phases.map(|place| Action { place, coordinate }).to_vec()
        }
        _ => vec![action],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::menu::menu;
    use crate::laws::modes::sizes;
    use estimation::fit::output_error::{Effort, fit};
    use estimation::model::prediction::outputs;
    use estimation::specimen;

    /// A simulation with a little of a mode, held against the linearised run: for every law that the recording asks about.
    ///
    /// Within a step the amount of a law is taken as a straight line; the narrow modes about the zeros of a phase current bend.
    #[test]
    fn columns_are_what_simulations_of_a_little_of_each_mode_show() {
        let study = specimen::study(1.0, |_| 1.0);
        let (case, prior) = (&study.fitted.case, &study.prior);
        let fit = fit(case, prior, &study.at_prior(), Effort::NONE);
        let waveform = specimen::waveform_of(&study);
        let sensitivities = Sensitivities::of(waveform, prior, &fit);
        let laws = menu(waveform, sensitivities.plant(), sensitivities.motion());
        assert!(laws.len() > 20, "{}", laws.len());
        let rated = &prior.plant.rated;
        for law in &laws {
            let columns = sensitivities.columns(law).expect("bearable");
            let mut missed = 0.0;
            let mut all = 0.0;
            for (column, k) in columns.iter().zip(sizes(law)) {
                let mut there = law.clone();
                let p = &law.effect.descriptor().parameters[k];
                there.values[k] = 0.01 * p.typical * p.scale.of(rated);
                let h = fit.hypothesis.with(there, rated);
                let shown = outputs(case, prior, &h, fit.observer);
                for ((x, base), column) in shown.iter().zip(&fit.outputs).zip(column) {
                    let secant = (x - base) / 0.01;
                    missed += (secant - column).powi(2);
                    all += secant.powi(2);
                }
            }
            let share = (missed / all).sqrt();
            let form = law.effect.descriptor().form;
            assert!(share < 0.08, "{form}: {share}");
        }
    }
}
