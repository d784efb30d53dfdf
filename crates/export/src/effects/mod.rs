//! The equations of each effect as expressions: one file each, one line in the list `ALL`.
//!
//! The names of the methods are those of `motor::effect::Effect`, which computes the same with numbers; a test holds both together.

mod curve;
mod expression;
mod flow;
mod formula;
mod readings;
mod shaft;
mod supply;
mod terminal;
mod winding;

pub use expression::Expression;
pub use flow::{
    At, Cage, Flow, Given, Motor, Now, Rated, Rates, Shown, Terminal, Winding, linear_currents,
};
pub use formula::{Formula, NotWritten};

use crate::algebra::{Body, Expr, Vector};
use motor::effect::EffectConfig;
use motor::effect::curve::Action;

/// What belongs to one effect of a model.
#[derive(Clone, Debug)]
pub struct Own {
    /// Its parameters inside (zero = absent), in the order of its descriptor.
    pub p: Vec<Expr>,
    /// Its states.
    pub extra: Vec<Expr>,
}

/// Name, unit and meaning of a state.
pub type StateNote = (&'static str, &'static str, &'static str);

/// The equations of an effect.
pub trait Equations {
    /// States that it adds.
    fn states(&self) -> &'static [StateNote] {
        &[]
    }

    /// Turns measured inputs into the true ones.
    fn inputs(&self, _own: &Own, _body: &mut Body, _given: &mut Given) {}

    /// Changes the motor's constant parameters.
    fn motor(&self, _own: &Own, _body: &mut Body, _motor: &mut Motor) {}

    /// Changes parameters from instant to instant. `i_s` is the stator current of the linear motor, A.
    fn parameters(&self, _own: &Own, _body: &mut Body, _at: &At, _i_s: &Vector, _now: &mut Now) {}

    /// Factor on the magnetizing current at the air-gap flux `x` (over rated flux), and the factor's derivative.
    fn magnetizing(&self, _own: &Own, _body: &mut Body, _x: &Expr) -> (Expr, Expr) {
        (1.0.into(), 0.0.into())
    }

    /// Voltage that is decided once a step, V.
    fn held_voltage(&self, _own: &Own, _body: &mut Body, _i_s: &Vector) -> Vector {
        Vector::zero()
    }

    /// Changes voltage and current at the terminals.
    fn terminal(
        &self,
        _own: &Own,
        _body: &mut Body,
        _at: &At,
        _winding: &Winding,
        _terminal: &mut Terminal,
    ) {
    }

    /// Changes the rates of the state.
    fn finish(&self, _own: &Own, _body: &mut Body, _at: &At, _flow: &Flow, _rates: &mut Rates) {}

    /// Turns true outputs into what instruments show.
    fn outputs(&self, _own: &Own, _shown: &mut Shown) {}
}

/// Effects of the library whose equations are here: name, form, equations.
static ALL: &[(&str, &str, &(dyn Equations + Sync))] = &[
    (
        "magnetizing-saturation",
        "",
        &winding::MagnetizingSaturation,
    ),
    ("leakage-saturation", "", &winding::LeakageSaturation),
    ("core-loss", "", &terminal::CoreLoss),
    ("core-loss", "air-gap", &terminal::CoreLossAirGap),
    ("stator-heating", "", &winding::StatorHeating),
    ("rotor-heating", "", &winding::RotorHeating),
    ("deep-bar", "slip", &winding::DeepBar),
    ("deep-bar", "double-cage", &winding::DoubleCage),
    ("coulomb-friction", "", &shaft::CoulombFriction),
    ("windage", "", &shaft::Windage),
    ("stray-load-loss", "", &shaft::StrayLoadLoss),
    ("load-pulsation", "", &shaft::LoadPulsation),
    ("shaft-compliance", "", &shaft::ShaftCompliance),
    ("voltage-asymmetry", "", &supply::VoltageAsymmetry),
    ("stator-asymmetry", "", &terminal::StatorAsymmetry),
    ("rotor-asymmetry", "", &winding::RotorAsymmetry),
    ("inverter-dead-time", "", &supply::InverterDeadTime),
    ("series-inductance", "", &winding::SeriesInductance),
    ("series-inductance", "lc-filter", &terminal::LcFilter),
    ("dc-link", "droop", &terminal::DcLink),
    ("dc-link", "capacitor", &terminal::DcLinkCapacitor),
    ("voltage-gain", "", &supply::VoltageGain),
    ("current-gain", "", &readings::CurrentGain),
    ("load-gain", "", &supply::LoadGain),
    ("phase-voltage-gain", "", &supply::PhaseVoltageGain),
    ("phase-current-gain", "", &readings::PhaseCurrentGain),
    ("current-offset", "", &readings::CurrentOffset),
    ("voltage-offset", "", &supply::VoltageOffset),
    ("frame-rotation", "", &supply::FrameRotation),
    ("speed-scale", "", &readings::SpeedScale),
    ("speed-ripple", "", &readings::SpeedRipple),
];

/// Effects that work on whole signals of an instrument: delays and filters.
pub const OF_WHOLE_SIGNALS: [&str; 4] =
    ["load-delay", "sample-delay", "sensor-filter", "speed-delay"];

/// Why an effect without equations has none.
pub fn without_equations(effect: &str) -> &'static str {
    match OF_WHOLE_SIGNALS.contains(&effect) {
        true => "it works on whole signals of an instrument and has no equation at one instant",
        false => "its equations are not written for other languages",
    }
}

/// The equations of an effect of the library, `None` where there are none.
pub fn of_library(config: &EffectConfig) -> Option<&'static (dyn Equations + Sync)> {
    let descriptor = config.effect.descriptor();
    let mut all = ALL.iter();
    let fits = all.find(|(name, form, _)| *name == descriptor.name && *form == descriptor.form);
    fits.map(|(_, _, equations)| *equations)
}

/// The equations of a curve whose table has this name.
pub fn of_curve(action: Action, table: &str) -> Box<dyn Equations> {
    Box::new(curve::Curve::new(action, table))
}
