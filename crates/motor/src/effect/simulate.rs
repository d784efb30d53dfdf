//! A motor with effects, driven by measured signals.

mod integrate;

use crate::dynamic::{Dynamic, DynamicState, Hooks, NoEffects, Shaft, cycle_components, phases};
use crate::effect::{
    Cut, EffectConfig, EffectStack, Hook, Inputs, MAX_FILE_STATES, Outputs, Rated, Timeline,
    extra_states,
};
use crate::{Mechanics, TParams};
use integrate::Integrate;
use num_complex::Complex64;
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// A motor with its effects: what a simulation is about.
#[derive(Clone, Debug)]
pub struct Plant {
    /// Electrical parameters.
    pub motor: TParams<f64>,
    /// Mechanical parameters.
    pub mechanics: Mechanics<f64>,
    /// Rated quantities.
    pub rated: Rated<f64>,
    /// Effects in force.
    pub effects: Vec<EffectConfig>,
}

/// Extra states that every effect of the library does with, alone.
const FEW_STATES: usize = 4;

/// How the voltage behaves between its samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Between {
    /// Held until the next sample: one step per sample.
    Held,
    /// Smooth: one Runge-Kutta step spans two sampling intervals and uses all three samples.
    Smooth,
}

impl Between {
    /// Samples per integration step.
    pub fn stride(self) -> usize {
        match self {
            Between::Held => 1,
            Between::Smooth => 2,
        }
    }
}

/// What the speed does.
#[derive(Clone, Copy, Debug)]
pub enum SpeedSource<'a> {
    /// Follows from the torques.
    Free,
    /// Follows from the torques and is drawn to these values (rad/s, one per input sample) at a rate in 1/s.
    Observed(&'a [f64], f64),
    /// Is given: one value per input sample, rad/s.
    Imposed(&'a [f64]),
}

/// What is added to the state of the motor at an input sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateOffset {
    /// Input sample; the integration step that holds it.
    pub sample: usize,
    /// Stator flux linkage, V s, stationary frame.
    pub psi_s: Complex64,
    /// Rotor flux linkage, V s, stationary frame.
    pub psi_r: Complex64,
    /// Speed, rad/s.
    pub omega_mech: f64,
}

/// A run of a plant: inputs and how to treat them.
#[derive(Clone, Debug)]
pub struct Run<'a> {
    /// Measured inputs, before any correction by effects.
    pub inputs: &'a Inputs,
    /// Behaviour between samples.
    pub between: Between,
    /// Source of the speed.
    pub speed: SpeedSource<'a>,
    /// Supply frequency and measured shaft angle.
    pub timeline: &'a Arc<Timeline>,
    /// Speed at the first sample, rad/s; `None` starts de-energised from standstill.
    pub running_at: Option<f64>,
    /// The same at the first sample after each cut of the timeline.
    pub running_at_cuts: &'a [Option<f64>],
    /// Input samples at which the terminals are open: no current flows, the rotor flux decays alone.
    pub open: &'a [Range<usize>],
    /// Offsets of the state, none where nobody asks what one would do.
    pub offsets: &'a [StateOffset],
}

/// Simulates a plant and returns what the instruments would show, one row per integration step.
///
/// # Panics
/// If the effects need more than eight extra states or the input signals differ in length.
pub fn simulate(plant: &Plant, run: &Run<'_>) -> Outputs {
    simulate_coarsely(plant, run, 1)
}

/// As [`simulate`], with so many integration steps taken at once (1 or more) and the rows between them interpolated. The difference of
/// two such runs is off by a share of itself only: enough for a derivative. Panics as [`simulate`] does.
pub fn simulate_coarsely(plant: &Plant, run: &Run<'_>, at_once: usize) -> Outputs {
    let mut outputs = with_hooks(plant, run, Integrate { at_once });
    outputs.u_zero = vec![0.0; outputs.omega_mech.len()];
    instruments(plant, &mut outputs);
    outputs
}

fn uses(plant: &Plant, hook: Hook) -> impl Iterator<Item = &EffectConfig> {
    let all = plant.effects.iter();
    all.filter(move |e| e.effect.hooks().contains(&hook))
}

/// What was there, from what was measured.
fn corrected<'a>(plant: &Plant, measured: &'a Inputs) -> Cow<'a, Inputs> {
    let mut inputs = Cow::Borrowed(measured);
    for e in uses(plant, Hook::Inputs) {
        e.effect.inputs(&e.values, &plant.rated, inputs.to_mut());
    }
    inputs
}

/// The shaft's speed, rad/s, where the reading that is imposed is not it: each stretch for itself.
fn shaft_speed(plant: &Plant, run: &Run<'_>) -> Option<Vec<f64>> {
    let SpeedSource::Imposed(shown) = run.speed else {
        return None;
    };
    let cuts = run.timeline.cuts.iter().map(|cut| cut.sample);
    let bounds: Vec<usize> = [0].into_iter().chain(cuts).chain([shown.len()]).collect();
    let undone = |e: &EffectConfig, shown: &[f64]| {
        let t_sample = run.inputs.t_sample;
        let part = |r: &[usize]| {
            e.effect
                .shaft_speed(&e.values, t_sample, &shown[r[0]..r[1]])
        };
        let parts: Option<Vec<Vec<f64>>> = bounds.windows(2).map(part).collect();
        parts.map(|parts| parts.concat())
    };
    // The last instrument in the chain is undone first.
    let mut speed = None;
    for e in plant.effects.iter().rev() {
        speed = undone(e, speed.as_deref().unwrap_or(shown)).or(speed);
    }
    speed
}

/// The motor's constant parameters with its effects.
fn constant_motor(plant: &Plant) -> TParams<f64> {
    let mut motor = plant.motor;
    for e in uses(plant, Hook::Motor) {
        e.effect.motor(&e.values, &plant.rated, &mut motor);
    }
    motor
}

/// What the instruments make of true outputs.
pub(super) fn instruments(plant: &Plant, outputs: &mut Outputs) {
    for e in uses(plant, Hook::Outputs) {
        let prepared = e.effect.prepared(&e.values, &plant.rated);
        e.effect.outputs(&prepared, &plant.rated, outputs);
    }
}

/// What is done with a prepared model, whatever hooks it has.
pub(super) trait Task {
    /// What comes out.
    type Result;

    /// Integration steps that are taken at once.
    fn at_once(&self) -> usize {
        1
    }

    /// Does it.
    fn on<H: Hooks>(self, ready: &Ready<'_, H>) -> Self::Result;
}

/// A model with everything that a run needs.
pub(super) struct Ready<'a, H: Hooks> {
    model: Dynamic<H>,
    /// State at the first sample.
    pub start: DynamicState<H::Extra>,
    restarts: Vec<Restart>,
    run: &'a Run<'a>,
    inputs: &'a Inputs,
    /// Samples per step.
    stride: usize,
}

/// What a run is about, its plant and its inputs as they are without the instruments.
#[derive(Clone, Copy)]
struct Scene<'a> {
    plant: &'a Plant,
    motor: &'a TParams<f64>,
    run: &'a Run<'a>,
    inputs: &'a Inputs,
    /// Samples per step.
    stride: usize,
}

/// Chooses the cheapest set of hooks that holds the plant's effects.
pub(super) fn with_hooks<T: Task>(plant: &Plant, run: &Run<'_>, task: T) -> T::Result {
    let inside = |e: &EffectConfig| {
        let outer = [Hook::Inputs, Hook::Motor, Hook::Outputs];
        e.effect.hooks().iter().any(|h| !outer.contains(h))
    };
    let speed = shaft_speed(plant, run);
    let run = &Run {
        speed: speed.as_deref().map_or(run.speed, SpeedSource::Imposed),
        ..run.clone()
    };
    let scene = Scene {
        plant,
        motor: &constant_motor(plant),
        run,
        inputs: &corrected(plant, run.inputs),
        stride: task.at_once() * run.between.stride(),
    };
    if !plant.effects.iter().any(inside) {
        return task.on(&Ready::new(scene, NoEffects));
    }
    match extra_states(&plant.effects) {
        0 => task.on(&stacked::<0>(scene)),
        1..=FEW_STATES => task.on(&stacked::<FEW_STATES>(scene)),
        // Those of a motor file, and the library's once more: what `explain` may add to them.
        _ => task.on(&stacked::<{ 2 * MAX_FILE_STATES }>(scene)),
    }
}

fn stacked<const N: usize>(scene: Scene<'_>) -> Ready<'_, EffectStack<N>> {
    let (plant, timeline) = (scene.plant, scene.run.timeline.clone());
    let stack = EffectStack::new(&plant.effects, scene.motor, &plant.rated, timeline);
    Ready::new(scene, stack)
}

/// One pass through a step: what the instruments show at its beginning.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shown {
    /// Phase currents, A.
    pub i_s_abc: [f64; 3],
    /// Speed, rad/s.
    pub omega_mech: f64,
    /// Shaft angle, rad.
    pub theta_mech: f64,
}

impl<'a, H: Hooks> Ready<'a, H> {
    fn new(scene: Scene<'a>, effects: H) -> Self {
        let Scene {
            plant,
            run,
            inputs,
            stride,
            ..
        } = scene;
        let shaft = match run.speed {
            SpeedSource::Imposed(_) => Shaft::Imposed,
            SpeedSource::Free | SpeedSource::Observed(..) => Shaft::Free,
        };
        let model = Dynamic::with_effects(scene.motor, &plant.mechanics, effects);
        Self {
            model: model.with_shaft(shaft),
            start: DynamicState::with_extra(&begins(&scene, 0, run.running_at)),
            restarts: restarts(&scene),
            run,
            inputs,
            stride,
        }
    }

    /// Time of a step, s.
    pub fn t_step(&self) -> f64 {
        self.inputs.t_sample * self.stride as f64
    }

    /// Integration steps.
    pub fn steps(&self) -> usize {
        self.inputs.u_s.len().saturating_sub(1) / self.stride
    }

    /// What happens to the state at the beginning of a step, before anything is seen of it; `restart`: the cut that falls
    /// there.
    #[inline(always)]
    fn begin(&self, state: &mut DynamicState<H::Extra>, step: usize, restart: Option<usize>) {
        let k = step * self.stride;
        if let Some(restart) = restart.map(|cut| &self.restarts[cut]) {
            if restart.is_new {
                *state = DynamicState::rest();
            }
            // Within a recording angle and extra states go on: nothing tells them better than the last stretch.
            let there = &restart.state;
            (state.psi_s, state.psi_r) = (there.psi_s, there.psi_r);
            state.omega_mech = there.omega_mech;
        }
        let step = k..k + self.stride;
        for offset in self.run.offsets.iter().filter(|x| step.contains(&x.sample)) {
            state.psi_s += offset.psi_s;
            state.psi_r += offset.psi_r;
            state.omega_mech += offset.omega_mech;
        }
        steer(state, self.run.speed, k, self.t_step());
        if self.run.open.iter().any(|open| open.contains(&k)) {
            let t = self.inputs.t_sample * k as f64;
            self.model.interrupt(state, t, self.inputs.u_s[k]);
        }
    }

    /// One step: what is seen at its beginning, and the state at its end (the last step has none: it stays).
    #[inline(always)]
    pub fn pass(
        &self,
        state: &mut DynamicState<H::Extra>,
        step: usize,
        restart: Option<usize>,
    ) -> Shown {
        self.begin(state, step, restart);
        let k = step * self.stride;
        let t = self.inputs.t_sample * k as f64;
        let (omega_mech, theta_mech) = (state.omega_mech, state.theta_mech);
        let i = match step < self.steps() {
            true => {
                self.turn(state, k);
                self.advance(state, k)
            }
            false => self.model.current(t, state, self.inputs.u_s[k]),
        };
        Shown {
            i_s_abc: phases(i),
            omega_mech,
            theta_mech: self.run.timeline.theta_at(t, theta_mech),
        }
    }

    /// One integration step from input sample `k`; the current at its beginning, A.
    #[inline(always)]
    fn advance(&self, state: &mut DynamicState<H::Extra>, k: usize) -> Complex64 {
        let (u, tau) = (&self.inputs.u_s, &self.inputs.tau_load);
        let (t, h) = (self.inputs.t_sample * k as f64, self.t_step());
        let end = k + self.stride;
        match self.run.between {
            Between::Held => {
                let n = self.stride as f64;
                let mean_u = u[k..end].iter().sum::<Complex64>() / n;
                let mean_tau = tau[k..end].iter().sum::<f64>() / n;
                self.model.step(state, t, h, |_| mean_u, |_, _| mean_tau)
            }
            Between::Smooth => {
                let half = k + self.stride / 2;
                let (first, middle, last) = (u[k], u[half], u[end]);
                let supply = |x: f64| {
                    if x <= t {
                        first
                    } else if x >= t + h {
                        last
                    } else {
                        middle
                    }
                };
                let mean = 0.5 * (tau[k] + tau[half]);
                self.model.step(state, t, h, supply, |_, _| mean)
            }
        }
    }

    /// An imposed speed during the step from sample `k`: the mean of its ends, off by the square of the step.
    #[inline(always)]
    fn turn(&self, state: &mut DynamicState<H::Extra>, k: usize) {
        if let SpeedSource::Imposed(omega) = self.run.speed {
            state.omega_mech = 0.5 * (omega[k] + omega[k + self.stride]);
        }
    }

    /// The cut that falls on a step, if it is the next one.
    #[inline(always)]
    pub fn restart(&self, step: usize, next: usize) -> Option<usize> {
        let k = step * self.stride;
        let restart = self.restarts.get(next)?;
        (restart.sample <= k).then_some(next)
    }
}

/// The state with which a motor begins at sample `k`: settled at this speed (rad/s) on its supply, or at rest.
fn begins(scene: &Scene<'_>, k: usize, running_at: Option<f64>) -> DynamicState {
    let Some(omega_mech) = running_at else {
        return DynamicState::rest();
    };
    let (inputs, omega_sync) = (scene.inputs, scene.run.timeline.omega_sync[k]);
    let voltages = cycle_components(&inputs.u_s[k..], omega_sync, inputs.t_sample);
    let n_p = scene.plant.mechanics.n_p;
    DynamicState::settled(scene.motor, n_p, omega_mech, &voltages)
}

/// The motor at the first sample after a cut.
struct Restart {
    sample: usize,
    state: DynamicState,
    is_new: bool,
}

/// The samples after the cuts of a recording, and the state of the motor there.
fn restarts(scene: &Scene<'_>) -> Vec<Restart> {
    let run = scene.run;
    let cuts = run.timeline.cuts.iter().zip(run.running_at_cuts);
    let at = |(cut, running_at): (&Cut, &Option<f64>)| Restart {
        sample: cut.sample,
        state: begins(scene, cut.sample, *running_at),
        is_new: cut.is_new,
    };
    cuts.map(at).collect()
}

/// Imposes or draws the speed.
#[inline(always)]
fn steer<X>(state: &mut DynamicState<X>, speed: SpeedSource<'_>, k: usize, h: f64) {
    match speed {
        SpeedSource::Free => {}
        SpeedSource::Imposed(omega) => state.omega_mech = omega[k],
        SpeedSource::Observed(omega, rate) => {
            state.omega_mech += (rate * h).min(1.0) * (omega[k] - state.omega_mech);
        }
    }
}
