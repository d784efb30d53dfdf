//! A shape of the dictionary: a formula that is proportional to its amplitudes.

use super::kind::{Kind, Reach};
use exmex::{Express, FlatEx};
use motor::effect::curve::Coordinate;

/// Names that stand for quantities of the motor, here or in a motor file's formulas.
const TAKEN: [&str; 15] = [
    "x", "X", "i_d", "i_q", "u_d", "u_q", "psi", "omega", "slip", "slip_hz", "theta", "t", "i",
    "f", "u",
];
/// Most amplitudes and shape parameters of one formula.
const MOST_NUMBERS: usize = 8;
/// Characters of a formula.
const MOST_CHARACTERS: usize = 500;

/// Coordinates over which a shape is asked about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Over {
    Any,
    Open,
    Zero,
    Signed,
    Angle,
}

impl Over {
    /// Words for files.
    pub const WORDS: [(&'static str, Over); 5] = [
        ("any", Over::Any),
        ("open", Over::Open),
        ("zero", Over::Zero),
        ("signed", Over::Signed),
        ("angle", Over::Angle),
    ];

    /// Whether a coordinate that reaches from `low` to `high` is meant.
    pub fn suits(self, coordinate: Coordinate, [low, high]: [f64; 2]) -> bool {
        let (open, largest) = (!coordinate.is_angle(), low.abs().max(high.abs()));
        match self {
            Over::Any => true,
            Over::Open => open,
            Over::Zero => open && low < 0.05 * largest && high > -0.05 * largest,
            Over::Signed => open && low < -0.2 * largest && high > 0.2 * largest,
            Over::Angle => !open,
        }
    }
}

/// What stands at one place of the formula's arguments.
#[derive(Clone, Copy, Debug)]
enum Slot {
    X,
    Largest,
    Amplitude(usize),
    Parameter(usize),
}

/// A formula with amplitudes and shape parameters.
#[derive(Debug)]
pub(crate) struct Shape {
    /// Name for a person.
    pub name: String,
    /// The formula as written.
    pub formula: String,
    /// Over which coordinates it is asked about.
    pub over: Over,
    /// Names of the amplitudes.
    pub amplitudes: Vec<String>,
    /// Shape parameters with their kinds.
    pub parameters: Vec<(String, Kind)>,
    flat: FlatEx<f64>,
    slots: Vec<Slot>,
}

impl Shape {
    /// Understands a formula; what is wrong with it is said in words.
    pub fn new(
        name: &str,
        formula: &str,
        over: Over,
        parameters: Vec<(String, Kind)>,
    ) -> Result<Self, String> {
        if formula.chars().count() > MOST_CHARACTERS {
            return Err(format!(
                "write it with at most {MOST_CHARACTERS} characters"
            ));
        }
        let flat = exmex::parse::<f64>(formula).map_err(|e| e.to_string())?;
        let given = |name: &String| parameters.iter().position(|p| p.0 == *name);
        let mut amplitudes = Vec::new();
        let mut slots = Vec::new();
        for name in flat.var_names() {
            slots.push(match (name.as_str(), given(name)) {
                ("x", _) => Slot::X,
                ("X", _) => Slot::Largest,
                (_, Some(k)) => Slot::Parameter(k),
                _ => {
                    amplitudes.push(name.clone());
                    Slot::Amplitude(amplitudes.len() - 1)
                }
            });
        }
        let shape = Self {
            name: name.to_owned(),
            formula: formula.to_owned(),
            over,
            amplitudes,
            parameters,
            flat,
            slots,
        };
        shape.check()?;
        Ok(shape)
    }

    fn check(&self) -> Result<(), String> {
        let names = || {
            self.amplitudes
                .iter()
                .chain(self.parameters.iter().map(|p| &p.0))
        };
        if let Some(name) = names().find(|name| TAKEN.contains(&name.as_str())) {
            return Err(format!(
                "`{name}` is a quantity of the motor: take another name"
            ));
        }
        let used = |name: &String| self.flat.var_names().contains(name);
        if let Some((name, _)) = self.parameters.iter().find(|p| !used(&p.0)) {
            return Err(format!("it does not use the shape parameter `{name}`"));
        }
        if self.amplitudes.is_empty() {
            return Err("it has no amplitude: write `a*(...)`".to_owned());
        }
        let numbers = names().count();
        if numbers > MOST_NUMBERS {
            return Err(format!(
                "it has {numbers} parameters: write it with at most {MOST_NUMBERS}"
            ));
        }
        match self.is_proportional() {
            true => Ok(()),
            false => {
                let names = self.amplitudes.join("`, `");
                Err(format!(
                    "it must be proportional to `{names}`: give a parameter that is no amplitude a key of its own, \
                     such as `w = \"width\"`"
                ))
            }
        }
    }

    /// Whether the value is a sum of terms, each an amplitude times something.
    fn is_proportional(&self) -> bool {
        let reach = Reach::of([0.0, 3.0]);
        let middle = |(_, kind): &(String, Kind)| kind.grid()[kind.grid().len() / 2];
        let coordinates: Vec<f64> = self.parameters.iter().map(middle).collect();
        let sizes: Vec<f64> = (0..self.amplitudes.len()).map(|k| 0.7 + k as f64).collect();
        [0.4, 1.3, 2.9].into_iter().all(|x| {
            let terms = self.terms(&coordinates, &reach, x);
            let sum: f64 = terms.iter().zip(&sizes).map(|(t, a)| t * a).sum();
            let value = self.value(&sizes, &coordinates, &reach, x);
            (value - sum).abs() <= 1e-9 * (1.0 + sum.abs())
        })
    }

    /// Value at `x`; what is no number counts as zero.
    pub fn value(&self, amplitudes: &[f64], coordinates: &[f64], reach: &Reach, x: f64) -> f64 {
        let argument = |slot: &Slot| match *slot {
            Slot::X => x,
            Slot::Largest => reach.largest,
            Slot::Amplitude(k) => amplitudes[k],
            Slot::Parameter(k) => self.parameters[k].1.value(coordinates[k], reach),
        };
        let arguments: Vec<f64> = self.slots.iter().map(argument).collect();
        let value = self.flat.eval(&arguments).unwrap_or(0.0);
        if value.is_finite() { value } else { 0.0 }
    }

    /// Value at `x` for each amplitude alone being one.
    pub fn terms(&self, coordinates: &[f64], reach: &Reach, x: f64) -> Vec<f64> {
        let n = self.amplitudes.len();
        let one = |k: usize| {
            let mut alone = vec![0.0; n];
            alone[k] = 1.0;
            self.value(&alone, coordinates, reach, x)
        };
        (0..n).map(one).collect()
    }

    /// Numbers that a fit finds.
    pub fn numbers(&self) -> usize {
        let fitted = self.parameters.iter().filter(|p| p.1 != Kind::Harmonic);
        self.amplitudes.len() + fitted.count()
    }

    /// All points of the grid of shape parameters.
    pub fn grid(&self) -> Vec<Vec<f64>> {
        self.parameters
            .iter()
            .fold(vec![Vec::new()], |all, (_, kind)| {
                let grid = kind.grid();
                let with = |point: &Vec<f64>| {
                    let longer = |z: &f64| [point.as_slice(), &[*z]].concat();
                    grid.iter().map(longer).collect::<Vec<_>>()
                };
                all.iter().flat_map(with).collect()
            })
    }

    /// The formula of the variable `x`, with numbers for the largest |x| and for harmonics.
    pub fn text(&self, x: &str, coordinates: &[f64], reach: &Reach) -> String {
        let word = |name: &str| match name {
            "x" => x.to_owned(),
            "X" => reach.largest.to_string(),
            name => {
                let mut parameters = self.parameters.iter().zip(coordinates);
                let harmonic = parameters.find(|(p, _)| p.0 == name && p.1 == Kind::Harmonic);
                harmonic.map_or_else(|| name.to_owned(), |(_, z)| z.to_string())
            }
        };
        let is_part = |c: char| c.is_alphanumeric() || c == '_';
        let (mut text, mut rest) = (String::new(), self.formula.as_str());
        while let Some(first) = rest.chars().next() {
            let end = match is_part(first) {
                true => rest.find(|c| !is_part(c)).unwrap_or(rest.len()),
                false => first.len_utf8(),
            };
            text += &word(&rest[..end]);
            rest = &rest[end..];
        }
        text
    }
}
