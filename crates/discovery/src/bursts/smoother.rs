//! The amount of an addition over time, from what it does to the outputs: a Kalman filter and a backward pass.
//!
//! The amount is a state of its own that wanders about zero (Ornstein and Uhlenbeck). Forwards the filter gives the
//! likelihood of the recording, by which places compete; backwards (Bierman, 1973, doi:10.1016/0005-1098(73)90033-9)
//! comes the smoothed amount.

use motor::effect::tangent::{Push, Tangent};

/// How an amount wanders.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Wander {
    /// Its standard deviation, in the unit of its place.
    pub deviation: f64,
    /// Time over which it forgets, s.
    pub memory: f64,
}

/// What is measured beside a linearised run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measured<'a> {
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
pub(crate) struct Smoothed {
    /// Smoothed amount at the beginning of each step.
    pub amount: Vec<f64>,
    /// Twice the logarithm of the likelihood over that of a run without the addition.
    pub evidence: f64,
}

/// One scalar measurement on its way back.
struct Update {
    step: usize,
    /// Row of the output matrix, then the gain, `m` numbers each.
    rows: Vec<f64>,
    /// Surprise over its variance.
    surprise: f64,
}

/// Filters and smooths.
pub(crate) fn smooth(
    tangent: &Tangent,
    push: &Push,
    measured: &Measured<'_>,
    wander: Wander,
) -> Smoothed {
    let mut filter = Filter::new(tangent, push, measured, wander);
    let (mut updates, mut evidence) = (Vec::new(), 0.0);
    // Amount and its covariance with all states, before each step.
    let mut before = Vec::with_capacity(tangent.len() * (filter.m + 1));
    for step in 0..tangent.len() {
        before.push(filter.x[filter.m - 1]);
        before.extend_from_slice(filter.row(filter.m - 1));
        if step % measured.decimation == 0 {
            evidence += filter.update(step, &mut updates);
        }
        filter.predict(step);
    }
    let amount = backwards(&filter, &before, &updates, tangent.len());
    Smoothed { amount, evidence }
}

/// State and covariance: those of the motor, and the amount.
struct Filter<'a> {
    tangent: &'a Tangent,
    push: &'a Push,
    measured: &'a Measured<'a>,
    /// Number of states.
    m: usize,
    x: Vec<f64>,
    p: Vec<f64>,
    keeps: f64,
    stirred: f64,
}

impl<'a> Filter<'a> {
    fn new(
        tangent: &'a Tangent,
        push: &'a Push,
        measured: &'a Measured<'a>,
        wander: Wander,
    ) -> Self {
        let m = tangent.states() + 1;
        let keeps = (-measured.t_step / wander.memory).exp();
        let variance = wander.deviation * wander.deviation;
        let mut p = vec![0.0; m * m];
        p[m * m - 1] = variance;
        Self {
            tangent,
            push,
            measured,
            m,
            x: vec![0.0; m],
            p,
            keeps,
            stirred: variance * (1.0 - keeps * keeps),
        }
    }

    fn row(&self, k: usize) -> &[f64] {
        &self.p[k * self.m..(k + 1) * self.m]
    }

    /// Takes the channels of a row one after the other; what this adds to the evidence.
    fn update(&mut self, step: usize, updates: &mut Vec<Update>) -> f64 {
        let row = step / self.measured.decimation;
        let (Some(residual), Some(weight)) = (
            self.measured.residual.get(row),
            self.measured.weight.get(row),
        ) else {
            return 0.0;
        };
        let (gain, seen) = (self.tangent.gain(step), self.push.to_seen(step));
        let mut evidence = 0.0;
        for channel in 0..4 {
            if weight[channel] == 0.0 {
                continue;
            }
            let noise = weight[channel].powi(-2);
            let mut rows = gain[channel].to_vec();
            rows.push(seen[channel]);
            let surprise = residual[channel] - dot(&rows, &self.x);
            let across: Vec<f64> = (0..self.m).map(|k| dot(self.row(k), &rows)).collect();
            let variance = dot(&rows, &across) + noise;
            evidence += residual[channel] * residual[channel] / noise
                - surprise * surprise / variance
                - (variance / noise).ln();
            self.x
                .iter_mut()
                .zip(&across)
                .for_each(|(x, c)| *x += c * surprise / variance);
            for k in 0..self.m {
                for j in 0..self.m {
                    self.p[k * self.m + j] -= across[k] * across[j] / variance;
                }
            }
            rows.extend(across.iter().map(|c| c / variance));
            updates.push(Update {
                step,
                rows,
                surprise: surprise / variance,
            });
        }
        evidence
    }

    /// One step forwards.
    fn predict(&mut self, step: usize) {
        let m = self.m;
        self.x = self.through(step, &self.x);
        // F P, then its product with F'.
        let columns: Vec<Vec<f64>> = (0..m)
            .map(|k| self.through(step, &(0..m).map(|j| self.p[j * m + k]).collect::<Vec<_>>()))
            .collect();
        for j in 0..m {
            let row: Vec<f64> = (0..m).map(|k| columns[k][j]).collect();
            let row = self.through(step, &row);
            self.p[j * m..(j + 1) * m].copy_from_slice(&row);
        }
        self.p[m * m - 1] += self.stirred;
    }

    /// The transition of a step times a vector.
    fn through(&self, step: usize, x: &[f64]) -> Vec<f64> {
        let n = self.m - 1;
        let push = self.push.to_state(step);
        let rows = self.tangent.phi(step).chunks_exact(n).zip(push);
        let mut next: Vec<f64> = rows.map(|(row, d)| dot(row, &x[..n]) + d * x[n]).collect();
        next.push(self.keeps * x[n]);
        next
    }

    /// Its transpose times a vector.
    fn back(&self, step: usize, x: &[f64]) -> Vec<f64> {
        let n = self.m - 1;
        let mut before = vec![0.0; self.m];
        for (row, factor) in self.tangent.phi(step).chunks_exact(n).zip(x) {
            for (b, phi) in before.iter_mut().zip(row) {
                *b += phi * factor;
            }
        }
        before[n] = dot(self.push.to_state(step), &x[..n]) + self.keeps * x[n];
        before
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The smoothed amounts.
fn backwards(filter: &Filter<'_>, before: &[f64], updates: &[Update], steps: usize) -> Vec<f64> {
    let m = filter.m;
    let mut adjoint = vec![0.0; m];
    let mut left = updates.len();
    let mut amount = vec![0.0; steps];
    for step in (0..steps).rev() {
        adjoint = filter.back(step, &adjoint);
        while left > 0 && updates[left - 1].step == step {
            left -= 1;
            let update = &updates[left];
            let (row, gain) = update.rows.split_at(m);
            let pulled = dot(gain, &adjoint) + update.surprise;
            adjoint
                .iter_mut()
                .zip(row)
                .for_each(|(a, h)| *a -= h * pulled);
        }
        let known = &before[step * (m + 1)..(step + 1) * (m + 1)];
        amount[step] = known[0] - dot(&known[1..], &adjoint);
    }
    amount
}
