//! The constants of a model: the motor's, the plate's, those of its effects.

use super::Quantity;
use crate::algebra::Expr;
use crate::effects::{Motor, Rated};
use motor::MotorFile;
use motor::effect::{EffectConfig, Written, rated};
use std::collections::BTreeSet;

/// Constants under their names.
#[derive(Debug, Default)]
pub struct Parameters {
    all: Vec<Quantity>,
    names: BTreeSet<String>,
}

/// Symbols of the motor without its effects.
#[derive(Clone, Debug)]
pub struct Constants {
    /// T model.
    pub motor: Motor,
    /// Rated quantities.
    pub rated: Rated,
    /// Moment of inertia, kg m2.
    pub inertia: Expr,
    /// Viscous friction of motor and load, N m s.
    pub friction: Expr,
}

impl Parameters {
    /// What there is so far.
    pub fn into_all(self) -> Vec<Quantity> {
        self.all
    }

    /// Names in use.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.names.iter().map(String::as_str)
    }

    /// Adds one, under a free name.
    fn add(&mut self, name: &str, value: f64, unit: &str, meaning: &str) -> Expr {
        let mut free = name.to_owned();
        let mut k = 2;
        while !self.names.insert(free.clone()) {
            free = format!("{name}_{k}");
            k += 1;
        }
        self.all.push(Quantity::new(&free, value, unit, meaning));
        Expr::Parameter(free.as_str().into())
    }

    /// Adds those of the motor and its plate.
    pub fn motor(&mut self, file: &MotorFile) -> Constants {
        let (p, m, rated) = (&file.parameters, &file.mechanics, rated(file));
        let motor = Motor {
            r_s: self.add("stator_resistance_ohm", p.r_s, "ohm", "stator resistance"),
            r_r: self.add(
                "rotor_resistance_ohm",
                p.r_r,
                "ohm",
                "rotor resistance, referred to the stator",
            ),
            l_ls: self.add("stator_leakage_henry", p.l_ls, "H", "stator leakage"),
            l_lr: self.add(
                "rotor_leakage_henry",
                p.l_lr,
                "H",
                "rotor leakage, referred to the stator",
            ),
            l_m: self.add(
                "magnetizing_inductance_henry",
                p.l_m,
                "H",
                "magnetizing inductance",
            ),
        };
        let n_p = self.add("pole_pairs", m.n_p, "-", "pole pairs");
        let inertia = self.add(
            "inertia_kg_m2",
            m.inertia,
            "kg m2",
            "inertia of everything on the shaft",
        );
        let own = self.add(
            "friction_nm_s",
            m.friction,
            "N m s",
            "viscous friction of the motor",
        );
        let load = self.add(
            "load_friction_nm_s",
            m.load_friction,
            "N m s",
            "load as viscous friction",
        );
        Constants {
            motor,
            rated: Rated {
                voltage: self.add(
                    "rated_voltage_volt",
                    rated.voltage,
                    "V",
                    "rated phase voltage, peak",
                ),
                current: self.add(
                    "rated_current_amp",
                    rated.current,
                    "A",
                    "rated line current, peak",
                ),
                omega_sync: self.add(
                    "rated_frequency_rad_s",
                    rated.omega_sync,
                    "rad/s",
                    "rated supply frequency",
                ),
                n_p,
            },
            inertia,
            friction: own + load,
        }
    }

    /// Adds those of an effect, written as in a motor file; gives what is inside (zero = absent).
    pub fn effect(&mut self, config: &EffectConfig) -> Vec<Expr> {
        let descriptor = config.effect.descriptor();
        let values = descriptor.parameters.iter().zip(&config.values);
        let one = |(p, &value): (&motor::effect::Parameter, &f64)| {
            let name = named(descriptor.name, p.name);
            let meaning = format!("{} of {}", p.name, descriptor.name);
            let symbol = self.add(&name, p.to_file(value), p.unit, &meaning);
            match p.written {
                Written::Plain => symbol,
                Written::Reciprocal => 1.0 / symbol,
                Written::OnePlus => symbol - 1.0,
            }
        };
        values.map(one).collect()
    }
}

/// Name of an effect's parameter: that of the motor file, behind the effect's where it does not begin with it.
fn named(effect: &str, key: &str) -> String {
    let (effect, key) = (identifier(effect), identifier(key));
    match key.starts_with(&effect) {
        true => key,
        false => format!("{effect}_{key}"),
    }
}

/// Letters, digits and underlines of ASCII: a name in every language.
pub fn identifier(text: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    text.chars().map(plain).collect()
}
