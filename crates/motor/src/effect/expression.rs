//! A user's own term as a formula in the motor file: physics that the library never thought of, without Rust.
//!
//! ```toml
//! [[effects]]
//! name = "expression"
//! formula = "k * omega^3"     # of i_d i_q u_d u_q psi omega slip theta t, and parameters
//! adds_to = "torque"          # N m that brakes; or "voltage_d", "voltage_q": V in the rotor-flux frame
//! k = 0.0                     # zero: to be fitted; anything else: in force
//! k_typical = 1e-6            # needed while k is zero: the size at which it matters
//! ```
//!
//! d axis on the rotor flux; `psi` is its magnitude (V s), `omega` the mechanical speed (rad/s), `theta` the shaft
//! angle (rad), `slip` 1 at standstill, `t` seconds from the start of the recording.

use crate::dynamic::{Flow, Terminal, Winding};
use crate::effect::{
    Applies, At, Descriptor, Effect, EffectConfig, EffectError, Hook, Kind, MAX_PARAMETERS,
    Parameter, Rates, Role, Scale, SteadyEffect, SteadyPoint, Written,
};
use exmex::{Express, FlatEx};
use num_complex::Complex64;
use std::collections::BTreeMap;
use std::sync::Mutex;

/// Name of the effect in motor files.
pub const NAME: &str = "expression";
const FORMULA: &str = "formula";
const ADDS_TO: &str = "adds_to";
/// Keys whose values are text.
pub const TEXTS: [&str; 2] = [FORMULA, ADDS_TO];
const TYPICAL: &str = "_typical";
pub(super) const VARIABLES: [&str; 9] = [
    "i_d", "i_q", "u_d", "u_q", "psi", "omega", "slip", "theta", "t",
];

/// Where the value of a formula goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Target {
    Torque,
    VoltageD,
    VoltageQ,
}

impl Target {
    const ALL: [(&'static str, Target); 3] = [
        ("torque", Target::Torque),
        ("voltage_d", Target::VoltageD),
        ("voltage_q", Target::VoltageQ),
    ];
}

/// One argument of the formula.
#[derive(Clone, Copy, Debug)]
enum Slot {
    Variable(usize),
    Parameter(usize),
}

/// A formula, understood.
#[derive(Debug)]
struct Expression {
    descriptor: &'static Descriptor,
    formula: &'static str,
    target: (&'static str, Target),
    flat: FlatEx<f64>,
    slots: Vec<Slot>,
}

/// Characters of a formula: a line, not a program. Understood, each takes some thirty bytes.
const MOST_CHARACTERS: usize = 1_000;
/// Different formulas of one run of the program: with the bound above they take at most some 40 MB.
const MOST_FORMULAS: usize = 1_000;

/// Formulas in use. They come from motor files and live as long as the program; equal ones are kept once, whatever the
/// values of their parameters, and there is room for [`MOST_FORMULAS`].
static KNOWN: Mutex<BTreeMap<String, &'static Expression>> = Mutex::new(BTreeMap::new());

/// The formula of a motor file, with its numbers (parameters and their typical sizes).
///
/// # Errors
/// A formula that cannot be parsed, an unknown target, a name that is neither variable nor parameter, a parameter
/// that the formula does not use or that is zero without a typical size.
pub fn expression(
    formula: Option<&str>,
    adds_to: Option<&str>,
    numbers: &[(String, f64)],
) -> Result<EffectConfig, EffectError> {
    let wrong = |reason: String| EffectError::Formula {
        formula: formula.unwrap_or("").to_owned(),
        reason,
    };
    let text = formula.ok_or_else(|| wrong("give the key `formula`".to_owned()))?;
    let target = adds_to.and_then(|a| Target::ALL.into_iter().find(|t| t.0 == a));
    let target = target.ok_or_else(|| {
        wrong("`adds_to` must be \"torque\", \"voltage_d\" or \"voltage_q\"".to_owned())
    })?;
    let length = text.chars().count();
    if length > MOST_CHARACTERS {
        let reason = format!("it has {length} characters: write it with at most {MOST_CHARACTERS}");
        return Err(EffectError::Formula {
            formula: text.chars().take(40).chain("...".chars()).collect(),
            reason,
        });
    }
    let flat = exmex::parse::<f64>(text).map_err(|e| wrong(e.to_string()))?;
    let mut parameters: Vec<(&str, f64)> = numbers
        .iter()
        .filter(|(k, _)| !k.ends_with(TYPICAL))
        .map(|(k, v)| (k.as_str(), *v))
        .collect();
    parameters.sort_by(|a, b| a.0.cmp(b.0));
    check_names(&parameters, numbers).map_err(wrong)?;
    let slots = slots(&flat, &parameters).map_err(wrong)?;
    let typical = typical(&parameters, numbers).map_err(wrong)?;
    let effect = interned(text, target, flat, slots, &parameters, &typical).map_err(wrong)?;
    Ok(EffectConfig {
        effect,
        values: parameters.iter().map(|p| p.1).collect(),
    })
}

/// Parameters must not hide variables, and a typical size must belong to a parameter.
fn check_names(parameters: &[(&str, f64)], numbers: &[(String, f64)]) -> Result<(), String> {
    if let Some((name, _)) = parameters.iter().find(|p| VARIABLES.contains(&p.0)) {
        return Err(format!(
            "`{name}` is a variable: give the parameter another name"
        ));
    }
    let mut sizes = numbers
        .iter()
        .filter_map(|(key, _)| key.strip_suffix(TYPICAL));
    match sizes.find(|name| !parameters.iter().any(|p| p.0 == *name)) {
        Some(name) => Err(format!(
            "`{name}{TYPICAL}` belongs to no parameter: add `{name} = 0.0`"
        )),
        None => Ok(()),
    }
}

/// Meaning of each name in the formula.
fn slots(flat: &FlatEx<f64>, parameters: &[(&str, f64)]) -> Result<Vec<Slot>, String> {
    let meaning = |name: &String| {
        let variable = VARIABLES.iter().position(|v| v == name).map(Slot::Variable);
        let parameter = parameters
            .iter()
            .position(|p| p.0 == name)
            .map(Slot::Parameter);
        variable.or(parameter).ok_or_else(|| {
            let known = VARIABLES.join(", ");
            format!("`{name}` is neither a key of this entry nor one of {known}")
        })
    };
    let unused = parameters
        .iter()
        .find(|p| !flat.var_names().iter().any(|n| n == p.0));
    if let Some((name, _)) = unused {
        return Err(format!("it does not use the parameter `{name}`"));
    }
    flat.var_names().iter().map(meaning).collect()
}

/// Typical size of each parameter.
fn typical(parameters: &[(&str, f64)], numbers: &[(String, f64)]) -> Result<Vec<f64>, String> {
    let one = |&(name, value): &(&str, f64)| {
        let key = format!("{name}{TYPICAL}");
        let given = numbers
            .iter()
            .find(|(k, _)| *k == key)
            .map(|(_, v)| v.abs());
        let size = given.unwrap_or(value.abs());
        if size > 0.0 && size.is_finite() {
            Ok(size)
        } else {
            Err(format!(
                "`{name}` is zero: give `{key}`, the size at which it matters"
            ))
        }
    };
    parameters.iter().map(one).collect()
}

/// The one expression of this text and these sizes.
fn interned(
    formula: &str,
    target: (&'static str, Target),
    flat: FlatEx<f64>,
    slots: Vec<Slot>,
    parameters: &[(&str, f64)],
    typical: &[f64],
) -> Result<&'static dyn Effect, String> {
    let names: Vec<&str> = parameters.iter().map(|(name, _)| *name).collect();
    let key = format!("{formula}|{}|{names:?}|{typical:?}", target.0);
    let mut known = KNOWN
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner);
    if known.len() >= MOST_FORMULAS && !known.contains_key(&key) {
        return Err(format!(
            "{MOST_FORMULAS} other formulas were read since the program was started: start it again"
        ));
    }
    Ok(*known.entry(key).or_insert_with(|| {
        let formula: &'static str = String::leak(formula.to_owned());
        Box::leak(Box::new(Expression {
            descriptor: Box::leak(Box::new(descriptor(formula, parameters, typical))),
            formula,
            target,
            flat,
            slots,
        }))
    }))
}

fn descriptor(formula: &'static str, parameters: &[(&str, f64)], typical: &[f64]) -> Descriptor {
    let one = |(p, &typical): (&(&str, f64), &f64)| Parameter {
        name: String::leak(p.0.to_owned()),
        unit: "-",
        role: Role::Size,
        written: Written::Plain,
        scale: Scale::Own,
        range: [-1e6 * typical, 1e6 * typical],
        typical,
        grid: &[],
        is_resonance: false,
    };
    let all: Vec<Parameter> = parameters.iter().zip(typical).map(one).collect();
    Descriptor {
        name: NAME,
        form: formula,
        kind: Kind::Physics,
        applies: Applies::Always,
        parameters: Vec::leak(all),
        symptom: "what the formula says",
        look_alikes: &[],
        separating_test: "the user's own: a test in which only this term changes",
    }
}

impl Expression {
    /// Value of the formula. It is a number at every motion of the motor with the values of its file, which is checked when
    /// that is read; where the values of a trial fit make it none, it adds nothing.
    fn value(&self, p: &[f64], variables: &[f64; 9]) -> f64 {
        let argument = |slot: &Slot| match *slot {
            Slot::Variable(k) => variables[k],
            Slot::Parameter(k) => p[k],
        };
        let arguments: Vec<f64> = self.slots.iter().map(argument).collect();
        let value = self.flat.eval(&arguments).unwrap_or(0.0);
        if value.is_finite() { value } else { 0.0 }
    }

    fn at(&self, p: &[f64], at: &At<'_>, i: Complex64, u: Complex64) -> (f64, Complex64) {
        let d_axis = axis(at.psi_r);
        let (i, u) = (i * d_axis.conj(), u * d_axis.conj());
        let psi = at.psi_r.norm();
        let slip = at.slip();
        let x = [
            i.re,
            i.im,
            u.re,
            u.im,
            psi,
            at.omega_mech,
            slip,
            at.theta_mech,
            at.t,
        ];
        (self.value(p, &x), d_axis)
    }

    fn voltage(&self, value: f64, d_axis: Complex64) -> Complex64 {
        match self.target.1 {
            Target::VoltageD => d_axis * value,
            Target::VoltageQ => d_axis * Complex64::new(0.0, value),
            Target::Torque => Complex64::ZERO,
        }
    }
}

/// Direction of a vector; the alpha axis while it is zero.
fn axis(x: Complex64) -> Complex64 {
    let size = x.norm();
    if size > 0.0 {
        x / size
    } else {
        Complex64::new(1.0, 0.0)
    }
}

impl SteadyEffect for Expression {
    fn descriptor(&self) -> &'static Descriptor {
        self.descriptor
    }

    /// A formula needs an operating system: single precision, the board's, leaves the point as it is.
    fn correct_f32(&self, _p: &[f32; MAX_PARAMETERS], _point: &mut SteadyPoint<f32>) {}

    fn correct_f64(&self, p: &[f64], point: &mut SteadyPoint<f64>) {
        let motor = &point.motor;
        let psi_r =
            (point.air_gap_flux() * motor.l_r() - point.i_s * (motor.l_m * motor.l_lr)) / motor.l_m;
        let d_axis = axis(psi_r);
        let (i, u) = (point.i_s * d_axis.conj(), point.u_s * d_axis.conj());
        let (psi, slip) = (psi_r.norm(), point.slip());
        let x = [
            i.re,
            i.im,
            u.re,
            u.im,
            psi,
            point.omega_mech,
            slip,
            0.0,
            f64::MAX,
        ];
        let value = self.value(p, &x);
        if self.target.1 == Target::Torque {
            point.tau_extra += value;
        }
        point.u_s += self.voltage(value, d_axis);
    }
}

impl Effect for Expression {
    fn hooks(&self) -> &'static [Hook] {
        match self.target.1 {
            Target::Torque => &[Hook::Finish],
            Target::VoltageD | Target::VoltageQ => &[Hook::Terminal],
        }
    }

    fn texts(&self) -> Vec<(&'static str, &'static str)> {
        vec![(FORMULA, self.formula), (ADDS_TO, self.target.0)]
    }

    fn terminal(&self, p: &[f64], at: &At<'_>, _winding: &Winding, terminal: &mut Terminal) {
        let (value, d_axis) = self.at(p, at, terminal.i, terminal.u);
        terminal.u += self.voltage(value, d_axis);
    }

    fn finish(&self, p: &[f64], at: &At<'_>, flow: &Flow, rates: &mut Rates<'_>) {
        let (value, _) = self.at(p, at, flow.terminal.i, flow.terminal.u);
        rates.omega_mech -= value / flow.inertia;
    }
}
