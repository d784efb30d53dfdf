//! Several effects at work in one dynamic model.

mod air_gap;

use crate::TParams;
use crate::dynamic::{DynamicState, Extra, Flow, Hooks, Linear, Terminal, Winding};
use crate::effect::effect::{At, Cage, Effect, Hook, Instantaneous, Rates};
use crate::effect::steady::length;
use crate::effect::{EffectConfig, Rated};
use air_gap::{Solutions, Star};
use num_complex::Complex64;
use std::sync::Arc;

/// An effect with its parameters and the place of its extra states.
#[derive(Clone, Debug)]
struct Active {
    effect: &'static dyn Effect,
    p: Vec<f64>,
    states: core::ops::Range<usize>,
}

impl Active {
    /// Its own states.
    #[inline]
    fn extra<'a, const N: usize>(&self, state: &'a DynamicState<[f64; N]>) -> &'a [f64] {
        &state.extra[self.states.clone()]
    }
}

/// What effects need to know about time: supply frequency (slip) and measured shaft angle (once per turn).
#[derive(Clone, Debug, PartialEq)]
pub struct Timeline {
    /// Time between samples, s.
    pub t_sample: f64,
    /// Supply frequency, rad/s; at least one sample, held beyond the last.
    pub omega_sync: Vec<f64>,
    /// Measured shaft angle, rad; empty: the simulated one counts.
    pub theta_mech: Vec<f64>,
    /// Where the samples were cut out of a longer recording, in their order; empty: they follow one another.
    pub cuts: Vec<Cut>,
}

/// The first sample after a part that was left out of a recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// Its number among the samples that are left.
    pub sample: usize,
    /// Its time since the first sample of its recording, s, the part that was left out counted.
    pub t: f64,
    /// Whether another recording begins here: the angle and the states of effects begin anew.
    pub is_new: bool,
}

impl Timeline {
    /// The same frequency at all times, no measured angle.
    pub fn constant(omega_sync: f64) -> Self {
        Self {
            t_sample: 1.0,
            omega_sync: vec![omega_sync],
            theta_mech: Vec::new(),
            cuts: Vec::new(),
        }
    }

    /// Time since the first sample, s, parts that were left out counted, at `t` (s) of the samples that are left.
    #[inline]
    pub fn clock(&self, t: f64) -> f64 {
        let begins = |cut: &Cut| self.t_sample * cut.sample as f64;
        match self.cuts.iter().rev().find(|cut| begins(cut) <= t) {
            Some(cut) => cut.t + (t - begins(cut)),
            None => t,
        }
    }

    #[inline]
    fn sync_at(&self, t: f64) -> f64 {
        let k = (t / self.t_sample).max(0.0) as usize;
        self.omega_sync[k.min(self.omega_sync.len() - 1)]
    }

    #[inline]
    fn moment(&self, t: f64, theta_mech: f64) -> Moment {
        Moment {
            t: self.clock(t),
            theta_mech: self.theta_at(t, theta_mech),
            omega_sync: self.sync_at(t),
        }
    }

    /// Measured angle at `t`, or `simulated` without one.
    #[inline]
    pub(crate) fn theta_at(&self, t: f64, simulated: f64) -> f64 {
        let Some(last) = self.theta_mech.len().checked_sub(1) else {
            return simulated;
        };
        let x = (t / self.t_sample).max(0.0);
        let k = (x as usize).min(last);
        let next = self.theta_mech[(k + 1).min(last)];
        self.theta_mech[k] + (next - self.theta_mech[k]) * (x - k as f64)
    }
}

/// What the timeline says of an instant.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    t: f64,
    theta_mech: f64,
    omega_sync: f64,
}

/// Effects sorted by the hooks they use, so that a simulation pays only for what is there.
#[derive(Clone, Debug)]
pub struct EffectStack<const N: usize> {
    rated: Rated<f64>,
    motor: TParams<f64>,
    /// One over the leakage inductances of stator and rotor, 1/H.
    admittances: [f64; 2],
    timeline: Arc<Timeline>,
    parameters: Vec<Active>,
    magnetizing: Vec<Active>,
    solutions: Option<Arc<Solutions>>,
    held_voltage: Vec<Active>,
    terminal: Vec<Active>,
    finish: Vec<Active>,
}

/// Extra states that the effects of a motor file may need: as many as the library, each effect once.
pub const MAX_FILE_STATES: usize = 10;

/// Number of extra states that a list of effects needs.
pub fn extra_states(effects: &[EffectConfig]) -> usize {
    effects.iter().map(|e| e.effect.extra_states()).sum()
}

impl<const N: usize> EffectStack<N> {
    /// The effects on a motor whose constant parameters (after [`Effect::motor`]) are `motor`.
    ///
    /// # Panics
    /// If the effects need more than `N` extra states: see [`extra_states`].
    pub fn new(
        effects: &[EffectConfig],
        motor: &TParams<f64>,
        rated: &Rated<f64>,
        timeline: Arc<Timeline>,
    ) -> Self {
        assert!(extra_states(effects) <= N, "too many extra states");
        let mut active = place(effects, rated);
        // Two masses split whatever torque the others leave on the shaft: states come last.
        active.sort_by_key(|a| a.states.len());
        let with = |hook: Hook| -> Vec<Active> {
            let uses = |a: &&Active| a.effect.hooks().contains(&hook);
            active.iter().filter(uses).cloned().collect()
        };
        let magnetizing = with(Hook::Magnetizing);
        let star = Star {
            admittance: 1.0 / motor.l_ls + 1.0 / motor.l_lr,
            l_m: motor.l_m,
            flux_rated: rated.flux(),
        };
        let solutions = (!magnetizing.is_empty())
            .then(|| Arc::new(Solutions::of(&star, |x| factor_of(&magnetizing, x))));
        Self {
            rated: *rated,
            motor: *motor,
            admittances: [1.0 / motor.l_ls, 1.0 / motor.l_lr],
            timeline,
            parameters: with(Hook::Parameters),
            magnetizing,
            solutions,
            held_voltage: with(Hook::HeldVoltage),
            terminal: with(Hook::Terminal),
            finish: with(Hook::Finish),
        }
    }

    /// What all effects see at this instant; each one's own states are [`Active::extra`].
    #[inline(always)]
    fn at<'a>(&'a self, moment: &Moment, state: &'a DynamicState<[f64; N]>) -> At<'a> {
        At {
            t: moment.t,
            psi_s: state.psi_s,
            psi_r: state.psi_r,
            omega_mech: state.omega_mech,
            theta_mech: moment.theta_mech,
            omega_sync: moment.omega_sync,
            extra: &[],
            rated: &self.rated,
            motor: &self.motor,
        }
    }

    /// Parameters at this instant.
    fn instantaneous(
        &self,
        moment: &Moment,
        state: &DynamicState<[f64; N]>,
        i_s: Complex64,
    ) -> Instantaneous {
        let mut now = Instantaneous {
            motor: self.motor,
            cage: None,
        };
        if self.parameters.is_empty() {
            return now;
        }
        let mut at = self.at(moment, state);
        for active in &self.parameters {
            at.extra = active.extra(state);
            active.effect.parameters(&active.p, &at, i_s, &mut now);
        }
        now
    }

    /// Air-gap flux of a star of branches: `psi (a + f(|psi|)/L_m) = sum`, solved for its magnitude.
    fn air_gap_flux(&self, sum: Complex64, admittance: f64, l_m: f64) -> Complex64 {
        let star = Star {
            admittance,
            l_m,
            flux_rated: self.rated.flux(),
        };
        let drive = length(sum);
        let flux = match &self.solutions {
            Some(solutions) => solutions.flux(&star, |x| factor_of(&self.magnetizing, x), drive),
            None => star.linear(drive),
        };
        sum * (flux / drive.max(f64::MIN_POSITIVE))
    }

    /// Currents where parameters change from instant to instant.
    #[inline(never)]
    fn changing(
        &self,
        linear: &Linear,
        moment: &Moment,
        state: &DynamicState<[f64; N]>,
    ) -> Winding {
        let winding = linear.winding(state.psi_s, state.psi_r);
        let now = self.instantaneous(moment, state, winding.i_s);
        if self.magnetizing.is_empty() && now.cage.is_none() {
            return Linear::new(&now.motor).winding(state.psi_s, state.psi_r);
        }
        self.star(state, &now)
    }

    /// Currents where only the magnetizing branch is not linear.
    #[inline(never)]
    fn saturated(&self, solutions: &Solutions, state: &DynamicState<[f64; N]>) -> Winding {
        let [a_s, a_r] = self.admittances;
        let sum = state.psi_s * a_s + state.psi_r * a_r;
        let drive = length(sum);
        let flux = solutions.own_flux(|x| factor_of(&self.magnetizing, x), drive);
        let psi_m = sum * (flux / drive.max(f64::MIN_POSITIVE));
        around(psi_m, state, self.admittances, &self.motor)
    }

    /// Currents of a T model with magnetizing branch, two leakages and perhaps a second cage.
    fn star(&self, state: &DynamicState<[f64; N]>, now: &Instantaneous) -> Winding {
        let m = &now.motor;
        let (a_s, a_r) = (1.0 / m.l_ls, 1.0 / m.l_lr);
        let (a_c, sum_c) = now.cage.map_or((0.0, Complex64::ZERO), cage_share);
        let sum = state.psi_s * a_s + state.psi_r * a_r + sum_c;
        let psi_m = self.air_gap_flux(sum, a_s + a_r + a_c, m.l_m);
        around(psi_m, state, [a_s, a_r], m)
    }
}

/// Currents around the air-gap flux, through leakages of these admittances, 1/H.
#[inline(always)]
fn around<X>(
    psi_m: Complex64,
    state: &DynamicState<X>,
    [a_s, a_r]: [f64; 2],
    motor: &TParams<f64>,
) -> Winding {
    Winding {
        i_s: (state.psi_s - psi_m) * a_s,
        i_r: (state.psi_r - psi_m) * a_r,
        r_s: motor.r_s,
        r_r: motor.r_r,
    }
}

/// Factor on the magnetizing current at air-gap flux `x` (over rated), and its derivative.
fn factor_of(magnetizing: &[Active], x: f64) -> (f64, f64) {
    let add = |(f, slope), active: &Active| {
        let (g, dg) = active.effect.magnetizing(&active.p, x);
        (f + g - 1.0, slope + dg)
    };
    magnetizing.iter().fold((1.0, 0.0), add)
}

fn cage_share(cage: Cage) -> (f64, Complex64) {
    (1.0 / cage.l, cage.psi / cage.l)
}

/// Gives each effect its range of extra states.
fn place(effects: &[EffectConfig], rated: &Rated<f64>) -> Vec<Active> {
    let mut next = 0;
    let mut put = |config: &EffectConfig| {
        let start = next;
        next += config.effect.extra_states();
        Active {
            effect: config.effect,
            p: config.effect.prepared(&config.values, rated),
            states: start..next,
        }
    };
    effects.iter().map(&mut put).collect()
}

impl<const N: usize> Hooks for EffectStack<N> {
    type Extra = [f64; N];
    type Moment = Moment;

    const HOLDS: bool = true;

    #[inline(always)]
    fn moment(&self, t: f64, state: &DynamicState<[f64; N]>) -> Moment {
        self.timeline.moment(t, state.theta_mech)
    }

    #[inline(always)]
    fn held_voltage(
        &self,
        linear: &Linear,
        moment: &Moment,
        state: &DynamicState<[f64; N]>,
    ) -> Complex64 {
        let mut u = Complex64::ZERO;
        if self.held_voltage.is_empty() {
            return u;
        }
        let i_s = self.winding(linear, moment, state).i_s;
        let mut at = self.at(moment, state);
        for active in &self.held_voltage {
            at.extra = active.extra(state);
            u += active.effect.held_voltage(&active.p, &at, i_s);
        }
        u
    }

    #[inline(always)]
    fn winding(&self, linear: &Linear, moment: &Moment, state: &DynamicState<[f64; N]>) -> Winding {
        match (self.parameters.is_empty(), &self.solutions) {
            (true, None) => linear.winding(state.psi_s, state.psi_r),
            (true, Some(solutions)) => self.saturated(solutions, state),
            (false, _) => self.changing(linear, moment, state),
        }
    }

    #[inline(always)]
    fn terminal(
        &self,
        moment: &Moment,
        state: &DynamicState<[f64; N]>,
        winding: &Winding,
        u: Complex64,
    ) -> Terminal {
        let mut terminal = Terminal {
            supply: u,
            u,
            i: winding.i_s,
        };
        if self.terminal.is_empty() {
            return terminal;
        }
        let mut at = self.at(moment, state);
        for active in &self.terminal {
            at.extra = active.extra(state);
            active
                .effect
                .terminal(&active.p, &at, winding, &mut terminal);
        }
        terminal
    }

    #[inline(always)]
    fn finish(
        &self,
        moment: &Moment,
        flow: &Flow,
        state: &DynamicState<[f64; N]>,
        rate: &mut DynamicState<[f64; N]>,
    ) {
        if self.finish.is_empty() {
            return;
        }
        let mut at = self.at(moment, state);
        for active in &self.finish {
            at.extra = active.extra(state);
            let mut rates = Rates {
                psi_s: rate.psi_s,
                psi_r: rate.psi_r,
                omega_mech: rate.omega_mech,
                extra: &mut rate.extra[active.states.clone()],
            };
            active.effect.finish(&active.p, &at, flow, &mut rates);
            (rate.psi_s, rate.psi_r) = (rates.psi_s, rates.psi_r);
            rate.omega_mech = rates.omega_mech;
        }
    }
}

impl<X: Extra> DynamicState<X> {
    /// A plain state with all extra states at rest.
    pub fn with_extra(plain: &DynamicState) -> Self {
        Self {
            psi_s: plain.psi_s,
            psi_r: plain.psi_r,
            omega_mech: plain.omega_mech,
            theta_mech: plain.theta_mech,
            extra: Extra::ZERO,
        }
    }
}
