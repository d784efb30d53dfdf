//! A run linearised about itself: what a small addition to the equations does to the outputs.
//!
//! A simulated step maps the state at its beginning to the state at its end. Along a run that map has a derivative
//! `Phi` (n x n), and an addition to the equations pushes the end of the step by `d`:
//!
//! ```text
//! x'(k+1) = Phi(k) x'(k) + d(k) s(k)         y'(k) = C(k) x'(k) + e(k) s(k)
//! ```
//!
//! `s` is the size of the addition at step k. So one linearisation serves every addition at a place, whatever it
//! depends on: an amount that follows a spline of the speed costs some multiplications a step instead of a simulation.

use crate::dynamic::{DynamicState, Extra, Hooks};
use crate::effect::simulate::{Ready, Shown, Task, instruments, with_hooks};
use crate::effect::{Outputs, Plant, Run, extra_states};
use num_complex::Complex64;

/// States of the motor itself: two flux vectors, speed, angle.
const OWN: usize = 6;
/// Most states: those of the motor, and of the effects.
const MOST: usize = OWN + 20;
/// What is seen at a step: three currents, speed, angle.
const SEEN: usize = 5;
/// Relative size of a derivative's step: rounding and curvature cost about the same.
const SMALL: f64 = 1e-6;

/// A run with its derivatives.
#[derive(Clone, Debug)]
pub struct Tangent {
    n: usize,
    /// State before each step, and after the last.
    states: Vec<f64>,
    /// What was seen at each step.
    seen: Vec<[f64; SEEN]>,
    /// `Phi`, row after row, step after step.
    phi: Vec<f64>,
    /// `C`, row after row, step after step.
    gain: Vec<f64>,
}

/// What an addition of size one does within each step.
#[derive(Clone, Debug)]
pub struct Push {
    /// To the state at the end of the step.
    state: Vec<f64>,
    /// To what is seen at its beginning.
    seen: Vec<[f64; SEEN]>,
}

impl Push {
    /// What it adds to the state at the end of a step.
    pub fn to_state(&self, step: usize) -> &[f64] {
        let n = self.state.len() / self.seen.len();
        &self.state[step * n..(step + 1) * n]
    }

    /// What it adds to the three currents and the speed at the beginning of a step.
    pub fn to_seen(&self, step: usize) -> [f64; 4] {
        let [a, b, c, omega, _] = self.seen[step];
        [a, b, c, omega]
    }
}

impl Tangent {
    /// Simulates a plant and its derivatives.
    ///
    /// # Panics
    /// As [`super::simulate`].
    pub fn new(plant: &Plant, run: &Run<'_>) -> Self {
        let scales = scales(plant);
        with_hooks(plant, run, Linearise { scales })
    }

    /// Number of states.
    pub fn states(&self) -> usize {
        self.n
    }

    /// `Phi` of a step, row after row.
    pub fn phi(&self, step: usize) -> &[f64] {
        &self.phi[step * self.n * self.n..(step + 1) * self.n * self.n]
    }

    /// `C` of a step: the rows of the three currents and of the speed.
    pub fn gain(&self, step: usize) -> [&[f64]; 4] {
        let first = step * SEEN * self.n;
        core::array::from_fn(|row| &self.gain[first + row * self.n..first + (row + 1) * self.n])
    }

    /// A relative error of a reading: 0 to 2 the currents, 3 the speed.
    pub fn reading(&self, channel: usize) -> Push {
        let one = |seen: &[f64; SEEN]| {
            let mut push = [0.0; SEEN];
            push[channel] = seen[channel];
            push
        };
        Push {
            state: vec![0.0; self.len() * self.n],
            seen: self.seen.iter().map(one).collect(),
        }
    }

    /// Number of steps at which something is seen.
    pub fn len(&self) -> usize {
        self.seen.len()
    }

    /// Whether there is no step.
    pub fn is_empty(&self) -> bool {
        self.seen.is_empty()
    }

    /// What one more effect does within each step: `with` is the plant of this run with it, `size` how much of it that is.
    /// The effect must not act on inputs, on the motor's constant parameters or on instruments, and have no states.
    ///
    /// # Panics
    /// As [`super::simulate`].
    pub fn push(&self, with: &Plant, run: &Run<'_>, size: f64) -> Push {
        let tangent = self;
        with_hooks(with, run, Pushed { tangent, size })
    }

    /// Stator flux linkage before each step, V s.
    pub fn psi_s(&self) -> impl Iterator<Item = Complex64> + '_ {
        let states = self.states.chunks_exact(self.n).take(self.len());
        states.map(|x| Complex64::new(x[0], x[1]))
    }

    /// The true outputs of the run.
    pub fn outputs(&self, run: &Run<'_>) -> Outputs {
        let stride = run.between.stride();
        Outputs {
            t_start: 0.0,
            t_sample: run.inputs.t_sample * stride as f64,
            i_s_abc: self.seen.iter().map(|y| [y[0], y[1], y[2]]).collect(),
            omega_mech: self.seen.iter().map(|y| y[3]).collect(),
            theta_mech: self.seen.iter().map(|y| y[4]).collect(),
            u_zero: vec![0.0; self.seen.len()],
            u_measured: (0..self.seen.len())
                .map(|k| run.inputs.u_s[k * stride])
                .collect(),
        }
    }
}

/// A response of the outputs: three currents and the speed for each kept step.
pub type Response = Vec<[f64; 4]>;

/// `M` additions at one place.
#[derive(Debug)]
pub struct Addition<'a, const M: usize> {
    /// What one of it does.
    pub push: &'a Push,
    /// How much of it there is at the beginning of each step.
    pub amounts: Vec<[f64; M]>,
}

impl<const M: usize> Addition<'_, M> {
    /// Mean amount within a step.
    #[inline]
    fn within(&self, step: usize) -> [f64; M] {
        let begin = &self.amounts[step];
        let end = &self.amounts[(step + 1).min(self.amounts.len() - 1)];
        core::array::from_fn(|m| 0.5 * (begin[m] + end[m]))
    }
}

/// `to += factor * from`.
#[inline(always)]
fn add<const M: usize>(to: &mut [f64; M], factor: f64, from: &[f64; M]) {
    for m in 0..M {
        to[m] += factor * from[m];
    }
}

impl Tangent {
    /// Responses of the true outputs to the sum of these additions, for each of their `M` amounts, at every `keep`-th step.
    pub fn respond<const M: usize>(
        &self,
        additions: &[Addition<'_, M>],
        keep: usize,
    ) -> Vec<Response> {
        let n = self.n;
        let (mut x, mut next) = ([[0.0; M]; MOST], [[0.0; M]; MOST]);
        let mut responses = vec![Response::with_capacity(self.len() / keep + 1); M];
        for step in 0..self.len() {
            if step % keep == 0 {
                let seen = self.seen_at(step, &x, additions);
                for (m, response) in responses.iter_mut().enumerate() {
                    response.push(core::array::from_fn(|c| seen[c][m]));
                }
            }
            for (row, to) in self.phi(step).chunks_exact(n).zip(&mut next) {
                *to = [0.0; M];
                row.iter().zip(&x).for_each(|(f, from)| add(to, *f, from));
            }
            for addition in additions {
                let within = addition.within(step);
                let push = addition.push.to_state(step).iter();
                push.zip(&mut next).for_each(|(d, to)| add(to, *d, &within));
            }
            core::mem::swap(&mut x, &mut next);
        }
        responses
    }

    fn seen_at<const M: usize>(
        &self,
        step: usize,
        x: &[[f64; M]; MOST],
        additions: &[Addition<'_, M>],
    ) -> [[f64; M]; 4] {
        let n = self.n;
        let gain = &self.gain[step * SEEN * n..(step + 1) * SEEN * n];
        let mut seen = [[0.0; M]; 4];
        for (row, to) in gain.chunks_exact(n).zip(&mut seen) {
            row.iter().zip(x).for_each(|(f, from)| add(to, *f, from));
        }
        for addition in additions {
            let push = addition.push.seen[step].iter().zip(&mut seen);
            push.for_each(|(e, to)| add(to, *e, &addition.amounts[step]));
        }
        seen
    }

    /// What the instruments of a plant make of a response of the true outputs, which holds every step.
    pub fn through_instruments(
        &self,
        plant: &Plant,
        run: &Run<'_>,
        response: &Response,
    ) -> Response {
        let base = self.outputs(run);
        let mut moved = base.clone();
        for (k, dy) in response.iter().enumerate() {
            for (current, change) in moved.i_s_abc[k].iter_mut().zip(dy) {
                *current += change;
            }
            moved.omega_mech[k] += dy[3];
        }
        let shown = |mut outputs: Outputs| {
            instruments(plant, &mut outputs);
            outputs
        };
        let (base, moved) = (shown(base), shown(moved));
        let row = |k: usize| {
            let di = |phase: usize| moved.i_s_abc[k][phase] - base.i_s_abc[k][phase];
            let dw = moved.omega_mech[k] - base.omega_mech[k];
            [di(0), di(1), di(2), dw]
        };
        (0..response.len()).map(row).collect()
    }
}

/// Simulates and differentiates step by step.
struct Linearise {
    scales: Vec<f64>,
}

impl Task for Linearise {
    type Result = Tangent;

    fn on<H: Hooks>(self, ready: &Ready<'_, H>) -> Tangent {
        let n = self.scales.len();
        let steps = ready.steps() + 1;
        let mut tangent = Tangent {
            n,
            states: vec![0.0; (steps + 1) * n],
            seen: Vec::with_capacity(steps),
            phi: vec![0.0; steps * n * n],
            gain: vec![0.0; steps * SEEN * n],
        };
        packed(&ready.start, &mut tangent.states[..n]);
        let mut cuts = 0;
        for step in 0..steps {
            let restart = ready.restart(step, cuts);
            cuts += usize::from(restart.is_some());
            tangent.differentiate(ready, step, restart, &self.scales);
        }
        tangent
    }
}

impl Tangent {
    /// One step with its derivatives by forward differences.
    fn differentiate<H: Hooks>(
        &mut self,
        ready: &Ready<'_, H>,
        step: usize,
        restart: Option<usize>,
        scales: &[f64],
    ) {
        let n = self.n;
        let before = self.states[step * n..(step + 1) * n].to_vec();
        let through = |from: &[f64]| {
            let mut state = unpacked(from);
            let shown = ready.pass(&mut state, step, restart);
            let mut after = [0.0; MOST];
            packed(&state, &mut after[..n]);
            (after, numbers(&shown))
        };
        let (after, seen) = through(&before);
        for (j, scale) in scales.iter().enumerate() {
            let mut from = before.clone();
            from[j] += SMALL * scale;
            let h = from[j] - before[j];
            let (there, shown) = through(&from);
            for i in 0..n {
                self.phi[(step * n + i) * n + j] = (there[i] - after[i]) / h;
            }
            for i in 0..SEEN {
                self.gain[(step * SEEN + i) * n + j] = (shown[i] - seen[i]) / h;
            }
        }
        self.states[(step + 1) * n..(step + 2) * n].copy_from_slice(&after[..n]);
        self.seen.push(seen);
    }
}

/// Passes through each step of a linearised run with another model.
struct Pushed<'t> {
    tangent: &'t Tangent,
    size: f64,
}

impl Task for Pushed<'_> {
    type Result = Push;

    fn on<H: Hooks>(self, ready: &Ready<'_, H>) -> Push {
        let (t, n) = (self.tangent, self.tangent.n);
        let mut push = Push {
            state: Vec::with_capacity(t.len() * n),
            seen: Vec::with_capacity(t.len()),
        };
        let mut cuts = 0;
        for step in 0..t.len() {
            let restart = ready.restart(step, cuts);
            cuts += usize::from(restart.is_some());
            let mut state = unpacked(&t.states[step * n..(step + 1) * n]);
            let shown = numbers(&ready.pass(&mut state, step, restart));
            let mut after = [0.0; MOST];
            packed(&state, &mut after[..n]);
            let without = &t.states[(step + 1) * n..(step + 2) * n];
            let pushed = after.iter().zip(without).map(|(a, b)| (a - b) / self.size);
            push.state.extend(pushed);
            let seen = |c: usize| (shown[c] - t.seen[step][c]) / self.size;
            push.seen.push(core::array::from_fn(seen));
        }
        push
    }
}

fn numbers(shown: &Shown) -> [f64; SEEN] {
    let [a, b, c] = shown.i_s_abc;
    [a, b, c, shown.omega_mech, shown.theta_mech]
}

/// Sizes in which states count.
fn scales(plant: &Plant) -> Vec<f64> {
    let rated = &plant.rated;
    let flux = rated.flux();
    let mut scales = vec![flux, flux, flux, flux, rated.speed(), 1.0];
    scales.resize(OWN + extra_states(&plant.effects), 1.0);
    scales
}

fn packed<X: Extra>(state: &DynamicState<X>, to: &mut [f64]) {
    let own = [
        state.psi_s.re,
        state.psi_s.im,
        state.psi_r.re,
        state.psi_r.im,
        state.omega_mech,
        state.theta_mech,
    ];
    to[..OWN].copy_from_slice(&own);
    let extra = to.len() - OWN;
    to[OWN..].copy_from_slice(&state.extra.numbers()[..extra]);
}

fn unpacked<X: Extra>(from: &[f64]) -> DynamicState<X> {
    let mut state = DynamicState::<X>::rest();
    (state.psi_s.re, state.psi_s.im) = (from[0], from[1]);
    (state.psi_r.re, state.psi_r.im) = (from[2], from[3]);
    (state.omega_mech, state.theta_mech) = (from[4], from[5]);
    state.extra.numbers_mut()[..from.len() - OWN].copy_from_slice(&from[OWN..]);
    state
}
