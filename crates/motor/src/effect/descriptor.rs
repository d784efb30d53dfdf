//! What is known about an effect before any recording is looked at.

use num_traits::Float;

/// Rated quantities that give every effect its natural size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rated<F> {
    /// Phase voltage, V peak.
    pub voltage: F,
    /// Line current, A peak.
    pub current: F,
    /// Supply frequency, rad/s.
    pub omega_sync: F,
    /// Pole pairs.
    pub n_p: F,
    /// Shaft torque, N m.
    pub torque: F,
}

impl<F: Float> Rated<F> {
    /// Rated stator flux linkage, V s peak.
    pub fn flux(&self) -> F {
        self.voltage / self.omega_sync
    }

    /// Synchronous mechanical speed, rad/s.
    pub fn speed(&self) -> F {
        self.omega_sync / self.n_p
    }
}

/// Unit in which range and typical size of a parameter are given, so that they suit every machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// The number itself, in the parameter's own unit.
    Own,
    /// Rated torque, N m.
    Torque,
    /// Rated torque over synchronous speed squared, N m s2.
    TorquePerSpeedSquared,
    /// Rated phase voltage, V peak.
    Voltage,
    /// Rated line current, A peak.
    Current,
    /// Rated current over rated voltage, S.
    Conductance,
    /// Rated voltage over rated current and frequency, H.
    Inductance,
    /// Rated current over rated voltage and frequency, F.
    Capacitance,
    /// One over the rated electrical power, 1/W.
    PerPower,
}

impl Scale {
    /// Value of the scale for a machine.
    pub fn of<F: Float>(self, rated: &Rated<F>) -> F {
        let three_halves = F::from(1.5).unwrap_or_else(F::one);
        match self {
            Scale::Own => F::one(),
            Scale::Torque => rated.torque,
            Scale::TorquePerSpeedSquared => rated.torque / (rated.speed() * rated.speed()),
            Scale::Voltage => rated.voltage,
            Scale::Current => rated.current,
            Scale::Conductance => rated.current / rated.voltage,
            Scale::Inductance => rated.voltage / (rated.current * rated.omega_sync),
            Scale::Capacitance => rated.current / (rated.voltage * rated.omega_sync),
            Scale::PerPower => F::one() / (three_halves * rated.current * rated.voltage),
        }
    }
}

/// Part a parameter plays in its effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The effect is proportional to it; zero means absent.
    Size,
    /// Changes the form of the effect continuously; meaningless while every size is zero.
    Shape,
    /// Chooses between discrete forms; never fitted, only tried.
    Form,
}

/// How the value inside (zero = absent) is written in a motor file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Written {
    /// As it is.
    Plain,
    /// As its reciprocal (a loss resistance for a conductance).
    Reciprocal,
    /// As one plus it (a gain for a gain error).
    OnePlus,
}

/// One parameter of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Key in the motor file and in reports; ends with the unit.
    pub name: &'static str,
    /// Unit as printed.
    pub unit: &'static str,
    /// Part it plays.
    pub role: Role,
    /// How it is written.
    pub written: Written,
    /// Unit of `range`, `typical` and `grid`.
    pub scale: Scale,
    /// Lowest and highest value.
    pub range: [f64; 2],
    /// Size at which a person would call the effect ordinary; start value of a shape.
    pub typical: f64,
    /// Values of a shape or form that a screen tries; empty for sizes.
    pub grid: &'static [f64],
    /// Whether it is a resonance frequency, between the lines of whose grid a screen has to look too.
    pub is_resonance: bool,
}

impl Parameter {
    /// A size that can have either sign.
    pub const fn size(name: &'static str, unit: &'static str, scale: Scale, typical: f64) -> Self {
        Self {
            name,
            unit,
            role: Role::Size,
            written: Written::Plain,
            scale,
            range: [-25.0 * typical, 25.0 * typical],
            typical,
            grid: &[],
            is_resonance: false,
        }
    }

    /// A size that physics keeps from being negative.
    pub const fn positive(
        name: &'static str,
        unit: &'static str,
        scale: Scale,
        typical: f64,
    ) -> Self {
        let mut parameter = Self::size(name, unit, scale, typical);
        parameter.range[0] = 0.0;
        parameter
    }

    /// A continuous shape, tried on `grid`; its first start value is `typical`.
    pub const fn shape(
        name: &'static str,
        unit: &'static str,
        scale: Scale,
        range: [f64; 2],
        typical: f64,
        grid: &'static [f64],
    ) -> Self {
        let mut parameter = Self::size(name, unit, scale, typical);
        parameter.role = Role::Shape;
        parameter.range = range;
        parameter.grid = grid;
        parameter
    }

    /// A choice between discrete forms.
    pub const fn form(name: &'static str, range: [f64; 2], grid: &'static [f64]) -> Self {
        let mut parameter = Self::shape(name, "-", Scale::Own, range, grid[0], grid);
        parameter.role = Role::Form;
        parameter
    }

    /// The same shape as a resonance frequency.
    pub const fn resonance(mut self) -> Self {
        self.is_resonance = true;
        self
    }

    /// The same parameter, written differently in files.
    pub const fn written(mut self, written: Written) -> Self {
        self.written = written;
        self
    }

    /// From the value in a motor file to the value inside.
    pub fn from_file(&self, value: f64) -> f64 {
        match self.written {
            Written::Plain => value,
            Written::Reciprocal => 1.0 / value,
            Written::OnePlus => value - 1.0,
        }
    }

    /// From the value inside to the value in a motor file.
    pub fn to_file(&self, value: f64) -> f64 {
        match self.written {
            Written::Plain => value,
            Written::Reciprocal => 1.0 / value,
            Written::OnePlus => 1.0 + value,
        }
    }

    /// Standard error of the file's value, from that of the value inside.
    pub fn error_to_file(&self, value: f64, error: f64) -> f64 {
        match self.written {
            Written::Reciprocal => error / (value * value),
            _ => error,
        }
    }
}

/// Where an effect can occur.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Applies {
    /// Everywhere.
    Always,
    /// Only behind an inverter.
    Inverter,
    /// Everywhere, but only samples over time can show it, not a table of running points.
    Samples,
}

/// What kind of answer an effect is: the four kinds are kept apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Physics of the motor, its shaft or its feeding circuit.
    Physics,
    /// A measuring channel is wrong.
    Sensor,
    /// The supply differs from what was believed.
    Supply,
}

/// Everything that is known about an effect before any recording is looked at.
#[derive(Debug, PartialEq)]
pub struct Descriptor {
    /// Name in motor files, commands and reports.
    pub name: &'static str,
    /// Which of several mathematical forms of the same physics this is; empty for the only one.
    pub form: &'static str,
    /// Kind of answer.
    pub kind: Kind,
    /// Where it can occur.
    pub applies: Applies,
    /// Its parameters, in the order of the slices passed to every method.
    pub parameters: &'static [Parameter],
    /// What a person sees when a model lacks it.
    pub symptom: &'static str,
    /// Effects (or parameters) it is easily confused with.
    pub look_alikes: &'static [&'static str],
    /// The test that separates it from them.
    pub separating_test: &'static str,
}

impl Descriptor {
    /// Whether this name and form mean it; an empty form means any.
    pub fn is_meant(&self, name: &str, form: &str) -> bool {
        self.name == name && (form.is_empty() || self.form == form)
    }

    /// Whether this effect is a resonance: without sizes, present or absent as a whole.
    pub fn is_resonance(&self) -> bool {
        self.parameters.iter().all(|p| p.role != Role::Size)
    }
}
