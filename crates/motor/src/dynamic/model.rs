//! Right-hand side and Runge-Kutta step.

use super::{DynamicState, Hooks, Linear, NoEffects, Terminal, Winding};
use crate::{Mechanics, TParams};
use num_complex::Complex64;

/// Everything that flows in the motor at one instant; what hooks may look at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flow {
    /// Time, s.
    pub t: f64,
    /// Winding currents and resistances.
    pub winding: Winding,
    /// Terminal voltage and current.
    pub terminal: Terminal,
    /// Electromagnetic torque, N m.
    pub tau_em: f64,
    /// Load torque, N m.
    pub tau_load: f64,
    /// Total viscous friction, N m s.
    pub friction: f64,
    /// Moment of inertia, kg m2.
    pub inertia: f64,
    /// Pole pairs.
    pub n_p: f64,
}

/// Configuration of the dynamic model: parameters, mechanics and effects. Holds no state.
#[derive(Clone, Debug)]
pub struct Dynamic<H = NoEffects> {
    linear: Linear,
    mechanics: Mechanics<f64>,
    friction: f64,
    inv_inertia: f64,
    shaft: Shaft,
    hooks: H,
}

/// What moves the shaft.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shaft {
    /// The torques on it.
    Free,
    /// Whatever turns it at the speed of the state: torques do not accelerate it.
    Imposed,
}

impl Dynamic<NoEffects> {
    /// The motor without effects.
    pub fn new(params: &TParams<f64>, mechanics: &Mechanics<f64>) -> Self {
        Self::with_effects(params, mechanics, NoEffects)
    }
}

impl<H: Hooks> Dynamic<H> {
    /// The motor with effects.
    pub fn with_effects(params: &TParams<f64>, mechanics: &Mechanics<f64>, hooks: H) -> Self {
        Self {
            linear: Linear::new(params),
            mechanics: *mechanics,
            friction: mechanics.total_friction(),
            inv_inertia: 1.0 / mechanics.inertia,
            shaft: Shaft::Free,
            hooks,
        }
    }

    /// The same motor with a shaft that something else moves.
    #[must_use]
    pub fn with_shaft(self, shaft: Shaft) -> Self {
        Self { shaft, ..self }
    }

    /// The effects in force.
    pub fn hooks(&self) -> &H {
        &self.hooks
    }

    /// Everything that flows at one instant, for supply voltage `u` (V) and load torque `tau_load` (N m).
    #[inline(always)]
    pub fn flow(
        &self,
        t: f64,
        state: &DynamicState<H::Extra>,
        u: Complex64,
        tau_load: f64,
    ) -> Flow {
        let moment = self.hooks.moment(t, state);
        self.flow_at(&moment, t, state, u, tau_load)
    }

    #[inline(always)]
    fn flow_at(
        &self,
        moment: &H::Moment,
        t: f64,
        state: &DynamicState<H::Extra>,
        u: Complex64,
        tau_load: f64,
    ) -> Flow {
        let winding = self.hooks.winding(&self.linear, moment, state);
        let terminal = self.hooks.terminal(moment, state, &winding, u);
        let tau_em = 1.5 * self.mechanics.n_p * (state.psi_s.conj() * winding.i_s).im;
        Flow {
            t,
            winding,
            terminal,
            tau_em,
            tau_load,
            friction: self.friction,
            inertia: self.mechanics.inertia,
            n_p: self.mechanics.n_p,
        }
    }

    /// Rate of change of the state, per second.
    #[inline(always)]
    pub fn rate(
        &self,
        t: f64,
        state: &DynamicState<H::Extra>,
        u: Complex64,
        tau_load: f64,
    ) -> DynamicState<H::Extra> {
        let moment = self.hooks.moment(t, state);
        let flow = self.flow_at(&moment, t, state, u, tau_load);
        self.rate_of(&moment, &flow, state)
    }

    /// Rate of change of the state where this flows, per second.
    #[inline(always)]
    fn rate_of(
        &self,
        moment: &H::Moment,
        flow: &Flow,
        state: &DynamicState<H::Extra>,
    ) -> DynamicState<H::Extra> {
        let omega_el = self.mechanics.n_p * state.omega_mech;
        let spin = Complex64::new(-omega_el * state.psi_r.im, omega_el * state.psi_r.re);
        let tau = flow.tau_em - self.friction * state.omega_mech - flow.tau_load;
        let mut rate = DynamicState {
            psi_s: flow.terminal.u - flow.terminal.i * flow.winding.r_s,
            psi_r: spin - flow.winding.i_r * flow.winding.r_r,
            omega_mech: tau * self.inv_inertia,
            theta_mech: state.omega_mech,
            extra: super::Extra::ZERO,
        };
        self.hooks.finish(moment, flow, state, &mut rate);
        if self.shaft == Shaft::Imposed {
            rate.omega_mech = 0.0;
        }
        rate
    }

    /// One classical Runge-Kutta step of length `h` (s) from time `t` (s); returns the current that an ammeter in the supply line
    /// reads at its beginning, A, stationary frame.
    ///
    /// `supply(t)` is the stator voltage vector in V; `load(t, omega_mech)` the load torque in N m. Both are
    /// asked at `t`, `t + h/2` and `t + h`: a held voltage is a closure that ignores its argument.
    #[inline(always)]
    pub fn step(
        &self,
        state: &mut DynamicState<H::Extra>,
        t: f64,
        h: f64,
        supply: impl Fn(f64) -> Complex64,
        load: impl Fn(f64, f64) -> f64,
    ) -> Complex64 {
        let moment = self.hooks.moment(t, state);
        let (u, tau) = (supply(t), load(t, state.omega_mech));
        let shown = self.flow_at(&moment, t, state, u, tau);
        let held = self.hooks.held_voltage(&self.linear, &moment, state);
        let driven = |u: Complex64| if H::HOLDS { u + held } else { u };
        let begin = match H::HOLDS && held != Complex64::ZERO {
            true => self.flow_at(&moment, t, state, driven(u), tau),
            false => shown,
        };
        let (t_mid, t_end) = (t + 0.5 * h, t + h);
        let (u_mid, u_end) = (driven(supply(t_mid)), driven(supply(t_end)));
        let k1 = self.rate_of(&moment, &begin, state);
        let x = state.advanced(0.5 * h, &k1);
        let k2 = self.rate(t_mid, &x, u_mid, load(t_mid, x.omega_mech));
        let x = state.advanced(0.5 * h, &k2);
        let k3 = self.rate(t_mid, &x, u_mid, load(t_mid, x.omega_mech));
        let x = state.advanced(h, &k3);
        let k4 = self.rate(t_end, &x, u_end, load(t_end, x.omega_mech));
        let inner = k1.advanced(2.0, &k2).advanced(2.0, &k3).advanced(1.0, &k4);
        *state = state.advanced(h / 6.0, &inner);
        shown.terminal.i
    }

    /// Current that an ammeter in the supply line reads, A, stationary frame.
    #[inline(always)]
    pub fn current(&self, t: f64, state: &DynamicState<H::Extra>, u: Complex64) -> Complex64 {
        self.flow(t, state, u, 0.0).terminal.i
    }

    /// Takes the current out of the stator, whose terminals are open: its flux jumps by the leakage flux, the rotor's
    /// stays.
    ///
    /// Newton's steps with the unsaturated inductance; saturation and losses at the terminals need the second one.
    pub fn interrupt(&self, state: &mut DynamicState<H::Extra>, t: f64, u: Complex64) {
        let p = &self.linear.params;
        let transient = p.l_ls + p.l_lr * p.l_m / p.l_r();
        for _ in 0..2 {
            state.psi_s -= self.current(t, state, u) * transient;
        }
    }

    /// Voltage at open terminals, V, stationary frame: what the decaying flux of the rotor induces (unsaturated).
    pub fn open_voltage(&self, t: f64, state: &DynamicState<H::Extra>) -> Complex64 {
        let p = &self.linear.params;
        let rate = self.rate(t, state, Complex64::new(0.0, 0.0), 0.0);
        rate.psi_r * (p.l_m / p.l_r())
    }

    /// Electromagnetic torque, N m.
    pub fn torque(&self, t: f64, state: &DynamicState<H::Extra>) -> f64 {
        self.flow(t, state, Complex64::new(0.0, 0.0), 0.0).tau_em
    }
}
