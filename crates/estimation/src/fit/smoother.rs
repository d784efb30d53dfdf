//! The amount of an addition over time, from what it does to the outputs: a Kalman filter and a backward pass.
//!
//! The amount is a state of its own that wanders about zero (Ornstein and Uhlenbeck). Forwards the filter gives the
//! likelihood of the recording, by which places compete; backwards (Bierman, 1973, doi:10.1016/0005-1098(73)90033-9)
//! comes the smoothed amount.

use motor::effect::tangent::{Push, Tangent};

/// How an amount wanders.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wander {
    /// Its standard deviation, in the unit of its place.
    pub deviation: f64,
    /// Time over which it forgets, s.
    pub memory: f64,
}

/// What is measured beside a linearised run.
#[derive(Clone, Copy, Debug)]
pub struct Measured<'a> {
    /// Measurement minus model of the three currents and of the speed, row after row.
    pub residual: &'a [[f64; 4]],
    /// One over the standard deviation of each; zero where it is not judged.
    pub weight: &'a [[f64; 4]],
    /// Steps per row.
    pub decimation: usize,
    /// Time of a step, s.
    pub t_step: f64,
}

/// The amount of an addition.
#[derive(Clone, Debug)]
pub struct Smoothed {
    /// Smoothed amount at the beginning of each step.
    pub amount: Vec<f64>,
    /// Twice the logarithm of the likelihood over that of a run without the addition.
    pub evidence: f64,
}

/// Filters and smooths.
pub fn smooth(tangent: &Tangent, push: &Push, measured: &Measured<'_>, wander: Wander) -> Smoothed {
    // Widths of the arrays: the motor with its amount, and with the states of any effects.
    match tangent.states() {
        0..8 => Filter::<8>::new(tangent, push, measured, wander).smoothed(),
        8..12 => Filter::<12>::new(tangent, push, measured, wander).smoothed(),
        12..16 => Filter::<16>::new(tangent, push, measured, wander).smoothed(),
        _ => Filter::<32>::new(tangent, push, measured, wander).smoothed(),
    }
}

type Vector<const W: usize> = [f64; W];

/// One scalar measurement on its way back.
struct Update<const W: usize> {
    step: usize,
    /// Row of the output matrix.
    row: Vector<W>,
    gain: Vector<W>,
    /// Surprise over its variance.
    surprise: f64,
}

/// Amount before a step, and its covariance with all states.
struct Before<const W: usize> {
    amount: f64,
    covariance: Vector<W>,
}

/// State and covariance of `m` numbers: those of the motor, and the amount as the last.
struct Filter<'a, const W: usize> {
    tangent: &'a Tangent,
    push: &'a Push,
    measured: &'a Measured<'a>,
    m: usize,
    x: Vector<W>,
    p: [Vector<W>; W],
    keeps: f64,
    stirred: f64,
    before: Vec<Before<W>>,
    updates: Vec<Update<W>>,
}

impl<'a, const W: usize> Filter<'a, W> {
    fn new(
        tangent: &'a Tangent,
        push: &'a Push,
        measured: &'a Measured<'a>,
        wander: Wander,
    ) -> Self {
        let m = tangent.states() + 1;
        let keeps = (-measured.t_step / wander.memory).exp();
        let variance = wander.deviation * wander.deviation;
        let mut p = [[0.0; W]; W];
        p[m - 1][m - 1] = variance;
        Self {
            tangent,
            push,
            measured,
            m,
            x: [0.0; W],
            p,
            keeps,
            stirred: variance * (1.0 - keeps * keeps),
            before: Vec::with_capacity(tangent.len()),
            updates: Vec::with_capacity(4 * measured.residual.len()),
        }
    }

    fn smoothed(mut self) -> Smoothed {
        let mut evidence = 0.0;
        for step in 0..self.tangent.len() {
            self.before.push(Before {
                amount: self.x[self.m - 1],
                covariance: self.p[self.m - 1],
            });
            if step % self.measured.decimation == 0 {
                evidence += self.update(step);
            }
            self.predict(step);
        }
        Smoothed {
            amount: self.backwards(),
            evidence,
        }
    }

    /// Takes the channels of a row one after the other; what this adds to the evidence.
    fn update(&mut self, step: usize) -> f64 {
        let row = step / self.measured.decimation;
        let (residual, weight) = (self.measured.residual, self.measured.weight);
        let (Some(residual), Some(weight)) = (residual.get(row), weight.get(row)) else {
            return 0.0;
        };
        let (gain, seen) = (self.tangent.gain(step), self.push.to_seen(step));
        let mut evidence = 0.0;
        for channel in (0..4).filter(|&channel| weight[channel] > 0.0) {
            let noise = weight[channel].powi(-2);
            let mut row = [0.0; W];
            row[..self.m - 1].copy_from_slice(gain[channel]);
            row[self.m - 1] = seen[channel];
            let surprise = residual[channel] - dot(&row, &self.x);
            let across: Vector<W> = core::array::from_fn(|k| dot(&self.p[k], &row));
            let variance = dot(&row, &across) + noise;
            evidence += residual[channel] * residual[channel] / noise
                - surprise * surprise / variance
                - (variance / noise).ln();
            let gain = across.map(|c| c / variance);
            add(&mut self.x, surprise, &gain);
            for (row, c) in self.p.iter_mut().zip(&across).take(self.m) {
                add(row, -c, &gain);
            }
            self.updates.push(Update {
                step,
                row,
                gain,
                surprise: surprise / variance,
            });
        }
        evidence
    }

    /// One step forwards.
    fn predict(&mut self, step: usize) {
        let transition = self.transition(step);
        let through =
            |x: &Vector<W>| -> Vector<W> { core::array::from_fn(|k| dot(&transition[k], x)) };
        self.x = through(&self.x);
        // P is symmetric: its rows are its columns, so this is (F P)', row after row.
        let left: [Vector<W>; W] = core::array::from_fn(|k| through(&self.p[k]));
        for (k, row) in self.p.iter_mut().enumerate().take(self.m) {
            let mut next = [0.0; W];
            for (column, factor) in left.iter().zip(&transition[k]) {
                add(&mut next, *factor, column);
            }
            *row = next;
        }
        self.p[self.m - 1][self.m - 1] += self.stirred;
    }

    /// The transition of a step: that of the motor, pushed by the amount, which forgets.
    fn transition(&self, step: usize) -> [Vector<W>; W] {
        let n = self.m - 1;
        let mut transition = [[0.0; W]; W];
        let rows = self.tangent.phi(step).chunks_exact(n);
        for ((to, row), d) in transition
            .iter_mut()
            .zip(rows)
            .zip(self.push.to_state(step))
        {
            to[..n].copy_from_slice(row);
            to[n] = *d;
        }
        transition[n][n] = self.keeps;
        transition
    }

    /// The smoothed amounts.
    fn backwards(&self) -> Vec<f64> {
        let mut adjoint = [0.0; W];
        let mut updates = self.updates.iter().rev().peekable();
        let mut amount = vec![0.0; self.before.len()];
        for step in (0..self.before.len()).rev() {
            let mut earlier = [0.0; W];
            for (row, factor) in self.transition(step).iter().zip(&adjoint) {
                add(&mut earlier, *factor, row);
            }
            adjoint = earlier;
            while let Some(update) = updates.next_if(|update| update.step == step) {
                let pulled = dot(&update.gain, &adjoint) + update.surprise;
                add(&mut adjoint, -pulled, &update.row);
            }
            let known = &self.before[step];
            amount[step] = known.amount - dot(&known.covariance, &adjoint);
        }
        amount
    }
}

fn dot<const W: usize>(a: &Vector<W>, b: &Vector<W>) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `to += factor * from`.
fn add<const W: usize>(to: &mut Vector<W>, factor: f64, from: &Vector<W>) {
    to.iter_mut().zip(from).for_each(|(t, f)| *t += factor * f);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::output_error::{Effort, fit};
    use crate::model::prediction::{Drive, driven};
    use crate::specimen;

    /// Wider arrays hold zeros that nothing adds to: the same numbers, bit for bit.
    #[test]
    fn the_width_of_the_arrays_changes_nothing() {
        let study = specimen::study(0.2, |_| 1.0);
        let (case, prior) = (&study.fitted.case, &study.prior);
        let fit = fit(case, prior, &study.at_prior(), Effort::NONE);
        let waveform = specimen::waveform_of(&study);
        let plant = fit.hypothesis.plant(prior);
        let mut with = plant.clone();
        with.effects.push(specimen::effect("coulomb-friction", 1.0));
        let drive = Drive::of(waveform);
        let tangent = driven(waveform, &plant, &drive, fit.observer, 1, |run| {
            Tangent::new(&plant, run)
        });
        let push = driven(waveform, &with, &drive, fit.observer, 1, |run| {
            tangent.push(&with, run, 1.0)
        });
        let rows = waveform.weight.len();
        let residual: Vec<[f64; 4]> = (0..rows).map(|k| [(k as f64).sin(); 4]).collect();
        let measured = Measured {
            residual: &residual,
            weight: &vec![[1.0; 4]; rows],
            decimation: waveform.decimation,
            t_step: waveform.t_step(),
        };
        let wander = Wander {
            deviation: 1.0,
            memory: 0.01,
        };
        let narrow = Filter::<8>::new(&tangent, &push, &measured, wander).smoothed();
        assert!(narrow.amount.iter().any(|amount| amount.abs() > 1e-3));
        let others = [
            Filter::<12>::new(&tangent, &push, &measured, wander).smoothed(),
            Filter::<16>::new(&tangent, &push, &measured, wander).smoothed(),
            Filter::<32>::new(&tangent, &push, &measured, wander).smoothed(),
        ];
        for wide in others {
            assert_eq!(wide.evidence, narrow.evidence);
            assert_eq!(wide.amount, narrow.amount);
        }
    }
}
