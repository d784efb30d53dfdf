//! Bursts of one recording at one place, fitted with the parameters.

use super::pulse::{Pulse, drawn, pulses};
use super::trace::{action, trace};
use crate::laws::sensitivity::Sensitivities;
use estimation::data::case::{Case, Waveform};
use estimation::data::channels::N_CHANNELS;
use estimation::fit::normal_equations::{self, Penalty};
use estimation::fit::output_error::{Effort, Fit, fit};
use estimation::fit::smoother::{Measured, Smoothed, Wander, smooth};
use estimation::model::prior::{Hypothesis, Prior};
use motor::effect::curve::Place;
use motor::effect::tangent::Addition;
use nalgebra::DVector;

/// Rounds in which the free amount is estimated on top of what it was before.
const ROUNDS: usize = 3;
/// Steps of the fit of bursts.
const STEPS: usize = 5;
/// Time over which a free amount forgets, s: bursts have edges.
const MEMORY: f64 = 0.01;
/// Typical sizes that a free amount may have, in those of its place.
const DEVIATIONS: [f64; 3] = [1.0, 5.0, 25.0];
/// Prior standard deviation of a size (typical sizes of its place) ...
const SIZE: f64 = 100.0;
/// ... and of an edge, s.
const EDGE: f64 = 2e-3;
/// Least factor that a resistance keeps.
const LEAST_FACTOR: f64 = 0.05;
/// Bursts whose columns are made together.
const TOGETHER: usize = 10;

/// A recording with the model that explains it but for bursts.
pub(crate) struct Scene<'a> {
    /// The recording, as what is fitted ...
    pub case: &'a Case,
    /// ... and its samples.
    pub waveform: &'a Waveform,
    /// What is believed.
    pub prior: &'a Prior,
    /// The model without bursts: its free parameters are fitted with them.
    pub without: Hypothesis,
}

/// Bursts and the fit with them.
pub(crate) struct Fitted {
    /// The bursts.
    pub pulses: Vec<Pulse>,
    /// The model with them.
    pub fit: Fit,
}

impl Scene<'_> {
    fn t_step(&self) -> f64 {
        self.waveform.t_step()
    }

    fn count(&self) -> usize {
        self.waveform.inputs.u_s.len() / self.waveform.between.stride() + 1
    }

    fn typical(&self, place: Place) -> f64 {
        let quantity = place.quantity(action(place).coordinate);
        quantity.typical * quantity.scale.of(&self.prior.plant.rated)
    }

    /// The model with an amount over time.
    fn with(&self, h: &Hypothesis, place: Place, amount: &[f64]) -> Hypothesis {
        let mut there = self.without.clone();
        there.z.clone_from(&h.z);
        there.with(trace(place, self.t_step(), amount), &self.prior.plant.rated)
    }

    fn fitted(&self, h: &Hypothesis, effort: Effort) -> Fit {
        fit(self.case, self.prior, h, effort)
    }

    /// The likeliest places of something that wanders, best first; empty where nothing comes and goes at any of them.
    ///
    /// Where an amount free to wander takes less than `least` of the squared error, bursts take even less.
    pub fn suspected(&self, places: &[Place], count: usize, least: f64) -> Vec<(Place, Wander)> {
        let fit = self.fitted(&self.without, Effort::NONE);
        let of = Sensitivities::of(self.waveform, self.prior, &fit);
        let ask = |&place: &Place| (place, self.smoothed(&of, place, self.wander(place, 1)));
        let mut all: Vec<(Place, Smoothed)> = places.iter().map(ask).collect();
        all.sort_by(|a, b| b.1.evidence.total_cmp(&a.1.evidence));
        let enough = |(_, found): &&(Place, Smoothed)| found.evidence > least;
        let likeliest: Vec<&(Place, Smoothed)> = all.iter().filter(enough).take(count).collect();
        let comes_and_goes = |found: &Smoothed| !pulses(&found.amount, self.t_step()).is_empty();
        if !likeliest.iter().any(|(_, found)| comes_and_goes(found)) {
            return Vec::new();
        }
        let likeliest = likeliest.into_iter().map(|(place, _)| *place);
        likeliest
            .map(|place| (place, self.suited(&of, place)))
            .collect()
    }

    /// How something wanders at a place, by what suits the recording best.
    pub fn wandering(&self, place: Place) -> Wander {
        let fit = self.fitted(&self.without, Effort::NONE);
        self.suited(&Sensitivities::of(self.waveform, self.prior, &fit), place)
    }

    fn suited(&self, of: &Sensitivities<'_>, place: Place) -> Wander {
        let tried = (0..DEVIATIONS.len()).map(|k| {
            let wander = self.wander(place, k);
            (wander, self.smoothed(of, place, wander).evidence)
        });
        let best = tried.max_by(|a, b| a.1.total_cmp(&b.1));
        best.map_or_else(|| self.wander(place, 1), |(wander, _)| wander)
    }

    fn wander(&self, place: Place, k: usize) -> Wander {
        Wander {
            deviation: DEVIATIONS[k] * self.typical(place),
            memory: MEMORY,
        }
    }

    fn smoothed(&self, of: &Sensitivities<'_>, place: Place, wander: Wander) -> Smoothed {
        let (residual, weight) = measured(self.waveform, of.fit());
        let measured = Measured {
            residual: &residual,
            weight: &weight,
            decimation: self.waveform.decimation,
            t_step: self.t_step(),
        };
        smooth(of.tangent(), &of.push(action(place)), &measured, wander)
    }

    /// Bursts at a place; `None` where what is missing there does not come and go.
    pub fn bursts(&self, place: Place, wander: Wander) -> Option<Fitted> {
        let mut amount = vec![0.0; self.count()];
        let mut h = self.without.clone();
        for round in 0..ROUNDS {
            let there = self.with(&h, place, &amount);
            let effort = Effort {
                iterations: round,
                ..Effort::FULL
            };
            let fit = self.fitted(&there, effort);
            let sensitivities = Sensitivities::of(self.waveform, self.prior, &fit);
            let more = self.smoothed(&sensitivities, place, wander).amount;
            amount.iter_mut().zip(more).for_each(|(a, x)| *a += x);
            amount.iter_mut().for_each(|a| *a = bounded(place, *a));
            h.z.clone_from(&fit.hypothesis.z);
        }
        let pulses = pulses(&amount, self.t_step());
        (!pulses.is_empty()).then(|| self.refined(place, h, pulses))
    }

    /// Sizes and edges of bursts, fitted together with the parameters: Gauss-Newton, each step halved until it helps.
    fn refined(&self, place: Place, h: Hypothesis, pulses: Vec<Pulse>) -> Fitted {
        let at = |h: &Hypothesis, pulses: &[Pulse]| {
            let amount = drawn(pulses, self.t_step(), self.count());
            let fit = self.fitted(&self.with(h, place, &amount), Effort::NONE);
            let pulses = pulses.to_vec();
            Fitted { pulses, fit }
        };
        let mut here = at(&h, &pulses);
        for _ in 0..STEPS {
            let Some(step) = self.step(place, &here) else {
                break;
            };
            let halves = [1.0, 0.5, 0.25].into_iter();
            let mut tried = halves.map(|share| {
                let (h, pulses) = self.moved(place, &here, &step, share);
                at(&h, &pulses)
            });
            let Some(better) = tried.find(|there| there.fit.cost() < here.fit.cost()) else {
                break;
            };
            here = better;
        }
        here
    }

    /// The step of parameters, sizes and edges that the linearised model asks for.
    fn step(&self, place: Place, here: &Fitted) -> Option<DVector<f64>> {
        let fit = &here.fit;
        let columns = self.columns(place, here);
        let rows = self.case.blocks();
        let blocks =
            normal_equations::extended(&fit.blocks, &rows, &fit.residual, &fit.jacobian, &columns);
        let (first, more) = (fit.free.len(), columns.len());
        // Columns are in prior standard deviations.
        let penalty = Penalty {
            weight: fit
                .penalty
                .weight
                .clone()
                .resize_vertically(first + more, 1.0),
            pull: fit
                .penalty
                .pull
                .clone()
                .resize_vertically(first + more, 0.0),
        };
        penalty.solve(&normal_equations::total(&blocks), 1e-6)
    }

    /// What each burst's size, beginning and end do to the outputs, in prior standard deviations.
    fn columns(&self, place: Place, here: &Fitted) -> Vec<Vec<f64>> {
        let sensitivities = Sensitivities::of(self.waveform, self.prior, &here.fit);
        let (push, step) = (sensitivities.push(action(place)), self.t_step());
        let steps = sensitivities.tangent().len();
        let pulses = here.pulses.iter();
        let changes: Vec<_> = pulses
            .flat_map(|p| changes(p, self.typical(place), step, steps))
            .collect();
        let mut columns = Vec::with_capacity(changes.len());
        for together in changes.chunks(TOGETHER) {
            let mut table = vec![[0.0; TOGETHER]; steps];
            for (m, change) in together.iter().enumerate() {
                change.iter().for_each(|&(k, x)| table[k][m] = x);
            }
            let addition = Addition {
                push: &push,
                amounts: table,
            };
            let responses = sensitivities.shown(&[addition]);
            let kept = responses.iter().take(together.len());
            columns.extend(kept.map(|r| sensitivities.weighted(r)));
        }
        columns
    }

    /// Parameters and bursts after a share of a step.
    fn moved(
        &self,
        place: Place,
        here: &Fitted,
        step: &DVector<f64>,
        share: f64,
    ) -> (Hypothesis, Vec<Pulse>) {
        let mut h = self.without.clone();
        h.z.clone_from(&here.fit.hypothesis.z);
        for (i, &k) in here.fit.free.iter().enumerate() {
            let [low, high] = h.bounds(k, self.prior);
            h.z[k] = (h.z[k] + share * step[i]).clamp(low, high);
        }
        let first = here.fit.free.len();
        let typical = self.typical(place);
        let moved = here.pulses.iter().enumerate().map(|(n, pulse)| {
            let by = |k: usize| share * step[first + 3 * n + k];
            let from = pulse.from + EDGE * by(1).clamp(-1.0, 1.0);
            let to = pulse.to + EDGE * by(2).clamp(-1.0, 1.0);
            Pulse {
                from: from.min(to - self.t_step()),
                to,
                size: bounded(place, pulse.size + SIZE * typical * by(0)),
            }
        });
        (h, moved.collect())
    }
}

/// What one prior standard deviation of a burst's size, beginning and end change of its amount, by step.
fn changes(pulse: &Pulse, typical: f64, step: f64, steps: usize) -> [Vec<(usize, f64)>; 3] {
    let near = |t: f64| ((t / step).round().max(0.0) as usize).min(steps - 1);
    let size = (near(pulse.from).saturating_sub(1)..(near(pulse.to) + 2).min(steps))
        .map(|k| (k, SIZE * typical * pulse.share(k as f64 * step, step)))
        .collect();
    let edge = |t: f64, sign: f64| vec![(near(t), sign * pulse.size * EDGE / step)];
    [size, edge(pulse.from, -1.0), edge(pulse.to, 1.0)]
}

/// An amount that leaves a resistance or a reading its sign.
fn bounded(place: Place, amount: f64) -> f64 {
    match place {
        Place::Torque | Place::Friction => amount,
        _ => amount.max(LEAST_FACTOR - 1.0),
    }
}

/// Residual and weights of currents and speed, in their units.
fn measured(waveform: &Waveform, fit: &Fit) -> (Vec<[f64; 4]>, Vec<[f64; 4]>) {
    let row = |(r, w): (&[f64], &[f64; N_CHANNELS])| {
        let in_units = |k: usize| if w[k] > 0.0 { r[k] / w[k] } else { 0.0 };
        (
            core::array::from_fn(in_units),
            core::array::from_fn(|k| w[k]),
        )
    };
    let rows = fit.residual.chunks_exact(N_CHANNELS).zip(&waveform.weight);
    rows.map(row).unzip()
}
