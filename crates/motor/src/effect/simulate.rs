//! A motor with effects, driven by measured signals.

use crate::dynamic::{Dynamic, DynamicState, Hooks, NoEffects, phases};
use crate::effect::{
    Cut, EffectConfig, EffectStack, Hook, Inputs, MAX_FILE_STATES, Outputs, Rated, Timeline,
    extra_states,
};
use crate::{Mechanics, TParams};
use num_complex::Complex64;
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
    /// Speed at the first sample after each cut of the timeline, rad/s: the motor runs there.
    pub running_at_cuts: &'a [f64],
    /// Input samples at which the terminals are open: no current flows, the rotor flux decays alone.
    pub open: &'a [Range<usize>],
}

impl DynamicState {
    /// Steady state of the linear motor on voltage `u` (V, at this instant), at `omega_mech` (rad/s).
    pub fn running(
        motor: &TParams<f64>,
        n_p: f64,
        u: Complex64,
        omega_sync: f64,
        omega_mech: f64,
    ) -> Self {
        let j_omega = Complex64::new(0.0, omega_sync);
        let j_slip = Complex64::new(0.0, omega_sync - n_p * omega_mech);
        // Rotor: 0 = R_r i_r + j w_slip (L_m i_s + L_r i_r).
        let ratio = -(j_slip * motor.l_m) / (motor.r_r + j_slip * motor.l_r());
        let l_seen = motor.l_s() + ratio * motor.l_m;
        let i_s = u / (motor.r_s + j_omega * l_seen);
        Self {
            psi_s: l_seen * i_s,
            psi_r: (motor.l_m + ratio * motor.l_r()) * i_s,
            omega_mech,
            ..Self::rest()
        }
    }
}

/// Simulates a plant and returns what the instruments would show, one row per integration step.
///
/// # Panics
/// If the effects need more than eight extra states or the input signals differ in length.
pub fn simulate(plant: &Plant, run: &Run<'_>) -> Outputs {
    let uses = |hook: Hook| {
        let all = plant.effects.iter();
        all.filter(move |e| e.effect.hooks().contains(&hook))
    };
    let mut corrected = None;
    for e in uses(Hook::Inputs) {
        let inputs = corrected.get_or_insert_with(|| run.inputs.clone());
        e.effect.inputs(&e.values, &plant.rated, inputs);
    }
    let inputs = corrected.as_ref().unwrap_or(run.inputs);
    let mut motor = plant.motor;
    for e in uses(Hook::Motor) {
        e.effect.motor(&e.values, &plant.rated, &mut motor);
    }
    let mut outputs = run_with_hooks(plant, &motor, run, inputs);
    outputs.u_zero = vec![0.0; outputs.omega_mech.len()];
    for e in uses(Hook::Outputs) {
        let prepared = e.effect.prepared(&e.values, &plant.rated);
        e.effect.outputs(&prepared, &plant.rated, &mut outputs);
    }
    outputs
}

/// Chooses the cheapest set of hooks that holds the plant's effects.
fn run_with_hooks(plant: &Plant, motor: &TParams<f64>, run: &Run<'_>, inputs: &Inputs) -> Outputs {
    let inside = |e: &EffectConfig| {
        let outer = [Hook::Inputs, Hook::Motor, Hook::Outputs];
        e.effect.hooks().iter().any(|h| !outer.contains(h))
    };
    let start = start_state(plant, motor, run, inputs);
    let restarts = restarts(plant, motor, run, inputs);
    // Stator inductance while the rotor flux stands still.
    let transient = motor.l_ls + motor.l_lr * motor.l_m / motor.l_r();
    if !plant.effects.iter().any(inside) {
        let model = Dynamic::with_effects(motor, &plant.mechanics, NoEffects);
        return integrate(&model, start, &restarts, run, inputs, transient);
    }
    let at = Course {
        start,
        restarts,
        transient,
    };
    // Each state is carried through every step: one effect's few cost less than room for all of the library.
    match extra_states(&plant.effects) {
        0 => run_with_states::<0>(plant, motor, run, inputs, &at),
        1..=FEW_STATES => run_with_states::<FEW_STATES>(plant, motor, run, inputs, &at),
        // Those of a motor file, and the library's once more: what `explain` may add to them.
        _ => run_with_states::<{ 2 * MAX_FILE_STATES }>(plant, motor, run, inputs, &at),
    }
}

/// As many extra states as any one effect has.
const FEW_STATES: usize = 4;

/// Where a simulation begins, and begins again.
struct Course {
    start: DynamicState,
    restarts: Vec<(usize, DynamicState)>,
    /// Stator inductance while the rotor flux stands still, H.
    transient: f64,
}

/// Simulates with room for so many extra states.
fn run_with_states<const N: usize>(
    plant: &Plant,
    motor: &TParams<f64>,
    run: &Run<'_>,
    inputs: &Inputs,
    at: &Course,
) -> Outputs {
    let stack = EffectStack::<N>::new(&plant.effects, motor, &plant.rated, run.timeline.clone());
    let model = Dynamic::with_effects(motor, &plant.mechanics, stack);
    let start = DynamicState::with_extra(&at.start);
    integrate(&model, start, &at.restarts, run, inputs, at.transient)
}

fn start_state(
    plant: &Plant,
    motor: &TParams<f64>,
    run: &Run<'_>,
    inputs: &Inputs,
) -> DynamicState {
    let at_speed = |omega_mech| running(plant, motor, run, inputs, 0, omega_mech);
    run.running_at.map_or_else(DynamicState::rest, at_speed)
}

/// Steady state at sample `k` and this speed (rad/s).
fn running(
    plant: &Plant,
    motor: &TParams<f64>,
    run: &Run<'_>,
    inputs: &Inputs,
    k: usize,
    omega_mech: f64,
) -> DynamicState {
    let omega_sync = run.timeline.omega_sync[k];
    let n_p = plant.mechanics.n_p;
    DynamicState::running(motor, n_p, inputs.u_s[k], omega_sync, omega_mech)
}

/// The samples after the cuts of a recording, and the state of the motor there.
fn restarts(
    plant: &Plant,
    motor: &TParams<f64>,
    run: &Run<'_>,
    inputs: &Inputs,
) -> Vec<(usize, DynamicState)> {
    let cuts = run.timeline.cuts.iter().zip(run.running_at_cuts);
    let at = |(cut, &omega): (&Cut, &f64)| {
        let state = running(plant, motor, run, inputs, cut.sample, omega);
        (cut.sample, state)
    };
    cuts.map(at).collect()
}

/// Integrates over all inputs and records every step.
fn integrate<H: Hooks>(
    model: &Dynamic<H>,
    mut state: DynamicState<H::Extra>,
    restarts: &[(usize, DynamicState)],
    run: &Run<'_>,
    inputs: &Inputs,
    transient: f64,
) -> Outputs {
    let stride = run.between.stride();
    let h = inputs.t_sample * stride as f64;
    let steps = inputs.u_s.len().saturating_sub(1) / stride;
    let mut out = Outputs {
        t_sample: h,
        ..Outputs::default()
    };
    out.i_s_abc.reserve(steps + 1);
    out.omega_mech.reserve(steps + 1);
    out.theta_mech.reserve(steps + 1);
    let mut restarts = restarts.iter().peekable();
    for step in 0..=steps {
        let k = step * stride;
        let t = inputs.t_sample * k as f64;
        if let Some((_, there)) = restarts.next_if(|(sample, _)| *sample <= k) {
            // Angle and extra states go on: nothing tells them better than the last stretch.
            (state.psi_s, state.psi_r) = (there.psi_s, there.psi_r);
            state.omega_mech = there.omega_mech;
        }
        steer(&mut state, run.speed, k, h);
        if run.open.iter().any(|open| open.contains(&k)) {
            interrupt(model, &mut state, t, inputs.u_s[k], transient);
        }
        let i = model.current(t, &state, inputs.u_s[k]);
        out.i_s_abc.push(phases(i));
        out.omega_mech.push(state.omega_mech);
        let theta = run.timeline.theta_at(t, state.theta_mech);
        out.theta_mech.push(theta);
        if step < steps {
            advance(model, &mut state, run.between, inputs, k);
        }
    }
    out.u_measured = (0..=steps).map(|k| run.inputs.u_s[k * stride]).collect();
    out
}

/// Takes the current out of the stator: its flux jumps by the leakage flux, the rotor's stays.
///
/// Newton's steps with the unsaturated inductance; saturation and losses at the terminals need the second one.
fn interrupt<H: Hooks>(
    model: &Dynamic<H>,
    state: &mut DynamicState<H::Extra>,
    t: f64,
    u: Complex64,
    transient: f64,
) {
    for _ in 0..2 {
        state.psi_s -= model.current(t, state, u) * transient;
    }
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

/// One integration step from input sample `k`.
#[inline(always)]
fn advance<H: Hooks>(
    model: &Dynamic<H>,
    state: &mut DynamicState<H::Extra>,
    between: Between,
    inputs: &Inputs,
    k: usize,
) {
    let (u, tau) = (&inputs.u_s, &inputs.tau_load);
    let t = inputs.t_sample * k as f64;
    match between {
        Between::Held => {
            model.step(state, t, inputs.t_sample, |_| u[k], |_, _| tau[k]);
        }
        Between::Smooth => {
            let h = 2.0 * inputs.t_sample;
            let (first, middle, last) = (u[k], u[k + 1], u[k + 2]);
            let supply = |x: f64| {
                if x <= t {
                    first
                } else if x >= t + h {
                    last
                } else {
                    middle
                }
            };
            let mean = 0.5 * (tau[k] + tau[k + 1]);
            model.step(state, t, h, supply, |_, _| mean);
        }
    }
}
