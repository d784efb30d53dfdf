//! An effect in the dynamic model.

use crate::TParams;
use crate::dynamic::{Flow, Terminal, Winding};
use crate::effect::{Inputs, Kind, Outputs, Rated, SteadyEffect};
use num_complex::Complex64;

/// A second rotor circuit beside the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cage {
    /// Resistance, ohm.
    pub r: f64,
    /// Leakage inductance, H, > 0.
    pub l: f64,
    /// Flux linkage, V s.
    pub psi: Complex64,
}

/// Parameters of the windings at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instantaneous {
    /// T model at this instant.
    pub motor: TParams<f64>,
    /// A second cage, if there is one.
    pub cage: Option<Cage>,
}

/// What an effect may look at inside the dynamic model.
#[derive(Clone, Copy, Debug)]
pub struct At<'a> {
    /// Time, s.
    pub t: f64,
    /// Stator flux linkage, V s.
    pub psi_s: Complex64,
    /// Rotor flux linkage, V s.
    pub psi_r: Complex64,
    /// Mechanical speed, rad/s.
    pub omega_mech: f64,
    /// Shaft angle, rad.
    pub theta_mech: f64,
    /// Supply frequency, rad/s.
    pub omega_sync: f64,
    /// The effect's own extra states.
    pub extra: &'a [f64],
    /// Rated quantities.
    pub rated: &'a Rated<f64>,
    /// Constant parameters of the motor.
    pub motor: &'a TParams<f64>,
}

impl At<'_> {
    /// Slip, 1 at standstill.
    pub fn slip(&self) -> f64 {
        1.0 - self.rated.n_p * self.omega_mech / self.omega_sync
    }
}

/// What an effect may change in the rates of the state, per second.
#[derive(Debug)]
pub struct Rates<'a> {
    /// Stator flux linkage, V.
    pub psi_s: Complex64,
    /// Rotor flux linkage, V.
    pub psi_r: Complex64,
    /// Speed, rad/s2.
    pub omega_mech: f64,
    /// The effect's own extra states.
    pub extra: &'a mut [f64],
}

/// Places where an effect takes part; a simulation calls nothing else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hook {
    /// [`Effect::inputs`].
    Inputs,
    /// [`Effect::motor`].
    Motor,
    /// [`Effect::parameters`].
    Parameters,
    /// [`Effect::magnetizing`].
    Magnetizing,
    /// [`Effect::held_voltage`].
    HeldVoltage,
    /// [`Effect::terminal`].
    Terminal,
    /// [`Effect::finish`].
    Finish,
    /// [`Effect::outputs`].
    Outputs,
}

/// Instruments whose gain, offset or lag an effect may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instrument {
    /// Each voltage channel; the parameters are those of the phases a, b, c.
    Voltages,
    /// Each current channel; the parameters are those of the phases a, b, c.
    Currents,
    /// The speed channel.
    Speed,
    /// The torque channel.
    Torque,
}

/// Windings whose symmetry may be broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The stator's three phases.
    Stator,
    /// The rotor's bars.
    Rotor,
}

/// Parameters of the motor file that an effect may be taken for, or means otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Nominal {
    /// Leakage inductances.
    Leakage,
    /// Magnetizing inductance.
    Magnetizing,
    /// Moment of inertia.
    Inertia,
    /// Viscous friction.
    Friction,
}

/// A physical effect. Stateless: parameters come as a slice in the order of the descriptor.
pub trait Effect: SteadyEffect {
    /// Hooks in which this effect takes part.
    fn hooks(&self) -> &'static [Hook];

    /// The action and the number of knots of a law; `None` for an effect with parameters.
    #[cfg(feature = "file")]
    fn law(&self) -> Option<(crate::effect::curve::Action, usize)> {
        None
    }

    /// What the hooks get as parameters: computed once before a simulation.
    fn prepared(&self, p: &[f64], _rated: &Rated<f64>) -> Vec<f64> {
        p.to_vec()
    }

    /// Prior standard deviation of a size, in typical sizes, where it is not that of all sizes.
    fn prior_deviation(&self, _p: &[f64], _parameter: usize) -> Option<f64> {
        None
    }

    /// Number of states it adds to the model.
    fn extra_states(&self) -> usize {
        0
    }

    /// Texts that a motor file needs beside the numbers: which form, which formula.
    fn texts(&self) -> Vec<(&'static str, &'static str)> {
        match self.descriptor().form {
            "" => Vec::new(),
            form => vec![("form", form)],
        }
    }

    /// Power that it takes at rated voltage and synchronous speed, W; `None` for an effect that is no loss.
    fn loss_watt(&self, _p: &[f64], _rated: &Rated<f64>) -> Option<f64> {
        None
    }

    /// The speed of the shaft, rad/s, where the instrument's reading `shown` drives the model: what [`Effect::outputs`] makes
    /// of a speed, undone. `None`: the reading is the speed.
    fn shaft_speed(&self, _p: &[f64], _t_sample: f64, _shown: &[f64]) -> Option<Vec<f64>> {
        None
    }

    /// The instrument whose gain this effect is: each parameter is one channel's relative error.
    fn gain_of(&self) -> Option<Instrument> {
        None
    }

    /// The instrument whose offset this effect is: each parameter is a constant that one channel adds.
    fn offset_of(&self) -> Option<Instrument> {
        None
    }

    /// The instrument whose gains no recording tells from this effect.
    fn hides_gain_of(&self) -> Option<Instrument> {
        self.gain_of()
    }

    /// The winding whose broken symmetry this effect is: its parameters are the real and the imaginary part of the asymmetry.
    fn asymmetry_of(&self) -> Option<Side> {
        None
    }

    /// Whether a fit without this effect may move a parameter of the motor file in its place. Friction stands for every
    /// physics that takes power, inertia for what keeps a speed or its reading from moving.
    fn is_taken_for(&self, nominal: Nominal) -> bool {
        match nominal {
            Nominal::Friction => self.descriptor().kind == Kind::Physics,
            Nominal::Inertia => self.descriptor().look_alikes.contains(&"inertia_kg_m2"),
            Nominal::Leakage | Nominal::Magnetizing => false,
        }
    }

    /// The instrument that it makes late by its first parameter, s.
    fn lag_of(&self) -> Option<Instrument> {
        None
    }

    /// Whether it shows the speed as a mean over a window that its first parameter sets (counts of an encoder), and changes nothing else.
    fn averages_speed(&self) -> bool {
        false
    }

    /// The parameter that means something else with this effect than without it.
    fn redefines(&self) -> Option<Nominal> {
        None
    }

    /// Whether it changes what instruments show rather than the motor: a sample-by-sample simulation of the motor leaves it
    /// to the instruments, which need whole signals.
    fn is_of_instruments(&self) -> bool {
        let mut hooks = self.hooks().iter();
        hooks.any(|hook| matches!(hook, Hook::Inputs | Hook::Outputs))
    }

    /// Turns true inputs into what the instruments show, where that is more than a few rounds of [`Effect::inputs`] turn around; `false`:
    /// they do.
    fn shown_inputs(&self, _p: &[f64], _rated: &Rated<f64>, _inputs: &mut Inputs) -> bool {
        false
    }

    /// Turns measured inputs into the true ones.
    fn inputs(&self, _p: &[f64], _rated: &Rated<f64>, _inputs: &mut Inputs) {}

    /// Changes the motor's constant parameters once, before the simulation.
    fn motor(&self, _p: &[f64], _rated: &Rated<f64>, _motor: &mut TParams<f64>) {}

    /// Changes parameters from instant to instant. `i_s` is the stator current of the linear motor, A.
    fn parameters(&self, _p: &[f64], _at: &At<'_>, _i_s: Complex64, _now: &mut Instantaneous) {}

    /// Factor by which the magnetizing current exceeds the linear one at the air-gap flux `x` (over rated
    /// flux), and the factor's derivative.
    fn magnetizing(&self, _p: &[f64], _x: f64) -> (f64, f64) {
        (1.0, 0.0)
    }

    /// Voltage added for a whole step, decided at its beginning, V.
    fn held_voltage(&self, _p: &[f64], _at: &At<'_>, _i_s: Complex64) -> Complex64 {
        Complex64::new(0.0, 0.0)
    }

    /// Changes voltage and current at the terminals.
    fn terminal(&self, _p: &[f64], _at: &At<'_>, _winding: &Winding, _terminal: &mut Terminal) {}

    /// Changes the rates of the state.
    fn finish(&self, _p: &[f64], _at: &At<'_>, _flow: &Flow, _rates: &mut Rates<'_>) {}

    /// Turns true outputs into what the instruments show.
    fn outputs(&self, _p: &[f64], _rated: &Rated<f64>, _outputs: &mut Outputs) {}
}
