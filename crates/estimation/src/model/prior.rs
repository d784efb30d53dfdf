//! What the user believes, and hypotheses about how it is wrong.

use crate::data::instrument_class::{CHANNEL_GAIN, CHANNEL_OFFSET};
use motor::effect::{
    Effect, EffectConfig, Instrument, Parameter, Plant, Rated, Role, expression, rated,
};
use motor::motor_file::Uncertainty;
use motor::{Mechanics, MotorFile, TParams};

/// Nominal parameters in the order of a hypothesis.
pub const NOMINALS: [Nominal; 6] = [
    Nominal::new("stator_resistance_ohm", "ohm", 0.1),
    Nominal::new("rotor_resistance_ohm", "ohm", 0.1),
    Nominal::new("stator_leakage_henry", "H", 0.1),
    Nominal::new("magnetizing_inductance_henry", "H", 0.1),
    Nominal::new("inertia_kg_m2", "kg m2", 0.2),
    Nominal::new("friction_nm_s", "N m s", 10.0),
];
/// Number of nominal parameters.
pub const N_NOMINAL: usize = NOMINALS.len();
/// Indices of the stator's and the rotor's resistance.
pub const RESISTANCES: [usize; 2] = [0, 1];
/// Index of the leakages.
pub const LEAKAGE: usize = 2;
/// Index of the magnetizing inductance.
pub const MAGNETIZING: usize = 3;
/// Index of the moment of inertia.
pub const INERTIA: usize = 4;
/// Index of the viscous friction, the only nominal that is added instead of multiplied.
pub const FRICTION: usize = 5;
/// Effects keep a plain wide prior: so many typical sizes.
const SIZE_PRIOR: f64 = 4.0;
/// Longest step of a logarithm in one iteration of a fit ...
const LONGEST_STEP: f64 = 1.5;
/// ... and of what enters linearly, in typical sizes: friction, sizes of effects, modes of a law. What a pump takes is ten
/// times an ordinary friction and more.
const LONGEST_LINEAR_STEP: f64 = 20.0;
/// Prior of a shape: a factor of e.
const SHAPE_PRIOR: f64 = 1.0;

/// A parameter of the motor file that every hypothesis refits.
#[derive(Clone, Copy, Debug)]
pub struct Nominal {
    /// Key in the motor file.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Prior standard deviation of its coordinate.
    pub prior_deviation: f64,
}

impl Nominal {
    const fn new(name: &'static str, unit: &'static str, prior_deviation: f64) -> Self {
        Self {
            name,
            unit,
            prior_deviation,
        }
    }
}

/// The motor as believed.
#[derive(Clone, Debug)]
pub struct Prior {
    /// Plant with the effects of the motor file.
    pub plant: Plant,
    /// Formulas of the motor file whose parameters are all zero: candidates, not priors.
    pub formulas: Vec<&'static dyn Effect>,
    /// Friction that takes 1 % of rated torque at synchronous speed, N m s.
    pub friction_unit: f64,
    /// Prior standard deviations of the nominals' coordinates: the motor file's intervals where it has them.
    pub deviations: [f64; N_NOMINAL],
    /// Effects of the motor file whose parameters have intervals: every hypothesis refits them.
    pub uncertain: Vec<UncertainEffect>,
}

/// An effect of the motor file that was not measured on this motor.
#[derive(Clone, Debug)]
pub struct UncertainEffect {
    /// As the motor file has it.
    pub config: EffectConfig,
    /// Standard deviation of each parameter's logarithm, where it has an interval.
    pub deviations: Vec<Option<f64>>,
}

impl UncertainEffect {
    /// Prior standard deviation and centre of a parameter's coordinate; `None` for one that is held.
    fn prior_of(&self, parameter: usize, rated: &Rated<f64>) -> Option<(f64, f64)> {
        let p = &self.config.effect.descriptor().parameters[parameter];
        let centre = to_coordinate(p, self.config.values[parameter], rated);
        let deviation = self.deviations[parameter]?;
        match p.role {
            Role::Size => Some((deviation * centre.abs(), centre)),
            _ => Some((deviation, centre)),
        }
    }
}

impl Prior {
    /// From a motor file and its effects (already validated).
    pub fn new(file: &MotorFile, effects: Vec<EffectConfig>) -> Self {
        let rated = rated(file);
        let open = |e: &EffectConfig| {
            e.effect.descriptor().name == expression::NAME && e.values.iter().all(|&x| x == 0.0)
        };
        let (formulas, effects): (Vec<_>, Vec<_>) = effects.into_iter().partition(open);
        let (uncertain, effects) = uncertain(file, effects);
        let plant = Plant {
            motor: file.parameters,
            mechanics: file.mechanics,
            rated,
            effects,
        };
        Self {
            friction_unit: 0.01 * rated.torque / rated.speed(),
            formulas: formulas.iter().map(|e| e.effect).collect(),
            deviations: deviations(file),
            uncertain,
            plant,
        }
    }

    /// Value of nominal parameter `k` at coordinate `z`, as the motor file writes it.
    pub fn nominal_value(&self, k: usize, z: f64) -> f64 {
        let (m, mech) = (&self.plant.motor, &self.plant.mechanics);
        let believed = [m.r_s, m.r_r, m.l_ls, m.l_m, mech.inertia, mech.friction][k];
        if k == FRICTION {
            believed + z * self.friction_unit
        } else {
            believed * z.exp()
        }
    }

    /// Standard error of that value for a standard error of the coordinate.
    pub fn nominal_error(&self, k: usize, z: f64, error: f64) -> f64 {
        if k == FRICTION {
            error * self.friction_unit
        } else {
            error * self.nominal_value(k, z)
        }
    }
}

/// Standard deviations of the nominals: of a motor file's intervals, else those of a motor that was measured.
fn deviations(file: &MotorFile) -> [f64; N_NOMINAL] {
    let mut deviations = NOMINALS.map(|nominal| nominal.prior_deviation);
    let Some(uncertainty) = &file.uncertainty else {
        return deviations;
    };
    for (deviation, nominal) in deviations.iter_mut().zip(&NOMINALS).take(FRICTION) {
        *deviation = uncertainty
            .log_deviation(nominal.name)
            .unwrap_or(*deviation);
    }
    deviations[LEAKAGE] = leakage_deviation(file, uncertainty).unwrap_or(deviations[LEAKAGE]);
    deviations
}

/// The effects whose parameters have intervals, and the others.
fn uncertain(
    file: &MotorFile,
    effects: Vec<EffectConfig>,
) -> (Vec<UncertainEffect>, Vec<EffectConfig>) {
    let deviation = |key: &str| file.uncertainty.as_ref()?.log_deviation(key);
    let described = |config: EffectConfig| {
        let parameters = config.effect.descriptor().parameters.iter();
        let deviations = parameters.map(|p| deviation(p.name).filter(|sd| *sd > 0.0));
        UncertainEffect {
            deviations: deviations.collect(),
            config,
        }
    };
    let (uncertain, known): (Vec<_>, Vec<_>) = effects
        .into_iter()
        .map(described)
        .partition(|effect| effect.deviations.iter().any(Option::is_some));
    (
        uncertain,
        known.into_iter().map(|effect| effect.config).collect(),
    )
}

/// Both leakages are one coordinate: the deviation of their sum's logarithm.
fn leakage_deviation(file: &MotorFile, uncertainty: &Uncertainty) -> Option<f64> {
    let keys = ["stator_leakage_henry", "rotor_leakage_henry"];
    let (l_ls, l_lr) = (file.parameters.l_ls, file.parameters.l_lr);
    let [stator, rotor] = [
        l_ls * uncertainty.log_deviation(keys[0])?,
        l_lr * uncertainty.log_deviation(keys[1])?,
    ];
    let correlation = uncertainty.correlation(keys);
    let variance = stator * stator + rotor * rotor + 2.0 * correlation * stator * rotor;
    Some(variance.max(0.0).sqrt() / (l_ls + l_lr))
}

/// One coordinate of an effect.
#[derive(Clone, Copy, Debug)]
struct Coordinate {
    effect: usize,
    parameter: usize,
}

/// Nominals and effects with their fitted coordinates.
#[derive(Clone, Debug)]
pub struct Hypothesis {
    /// Effects beyond those of the motor file; values are start values.
    pub effects: Vec<EffectConfig>,
    /// Coordinates: six nominals, then those of the effects.
    pub z: Vec<f64>,
    /// Whether a coordinate is fitted.
    pub free: Vec<bool>,
    coordinates: Vec<Coordinate>,
    /// The effects by which instruments may be off within their class: no finding, a nuisance.
    instruments: Vec<usize>,
    /// The effects of the motor file that are refitted, in the order of [`Prior::uncertain`].
    uncertain: Vec<usize>,
}

impl Hypothesis {
    /// Priors, nothing added; the mechanical nominals are free unless the speed is given.
    pub fn at_prior(speed_is_input: bool) -> Self {
        let free = (0..N_NOMINAL).map(|k| k < 4 || !speed_is_input);
        Self {
            effects: Vec::new(),
            z: vec![0.0; N_NOMINAL],
            free: free.collect(),
            coordinates: Vec::new(),
            instruments: Vec::new(),
            uncertain: Vec::new(),
        }
    }

    /// Priors for a load table: inertia and friction cannot move. At one speed friction is one number with
    /// every other constant loss; as a loss it is looked for among the effects.
    pub fn at_prior_of_table() -> Self {
        let mut h = Self::at_prior(true);
        h.free[FRICTION] = false;
        h
    }

    /// Whether this is the same model, to the last bit.
    pub fn is_same(&self, other: &Self) -> bool {
        let told = |e: &EffectConfig| (e.effect.descriptor().name, e.effect.texts());
        let same =
            |(a, b): (&EffectConfig, &EffectConfig)| told(a) == told(b) && a.values == b.values;
        (&self.z, &self.free) == (&other.z, &other.free)
            && self.effects.len() == other.effects.len()
            && self.effects.iter().zip(&other.effects).all(same)
    }

    /// The same with one more effect, its coordinates at its start values.
    pub fn with(&self, effect: EffectConfig, rated: &Rated<f64>) -> Self {
        let mut more = self.clone();
        let index = more.effects.len();
        for (k, p) in effect.effect.descriptor().parameters.iter().enumerate() {
            if p.role == Role::Form {
                continue;
            }
            more.coordinates.push(Coordinate {
                effect: index,
                parameter: k,
            });
            more.z.push(to_coordinate(p, effect.values[k], rated));
            more.free.push(true);
        }
        more.effects.push(effect);
        more
    }

    /// The same with the effects of the motor file whose parameters are uncertain.
    pub fn with_uncertain(&self, prior: &Prior) -> Self {
        let rated = &prior.plant.rated;
        let mut more = self.clone();
        for effect in &prior.uncertain {
            let first = more.z.len();
            more.uncertain.push(more.effects.len());
            more = more.with(effect.config.clone(), rated);
            for k in first..more.z.len() {
                more.free[k] = effect.deviations[more.parameter_of(k)].is_some();
            }
        }
        more
    }

    /// The uncertain effect of the motor file behind coordinate `k`.
    fn uncertain_of<'p>(&self, k: usize, prior: &'p Prior) -> Option<&'p UncertainEffect> {
        let effect = self.effect_of(k);
        let place = self.uncertain.iter().position(|&index| index == effect)?;
        prior.uncertain.get(place)
    }

    /// The same with an effect by which an instrument may be off within its class.
    pub fn with_instrument(&self, effect: EffectConfig, rated: &Rated<f64>) -> Self {
        let mut more = self.with(effect, rated);
        more.instruments.push(self.effects.len());
        more
    }

    /// The same with an effect that it holds already taken for one of an instrument within its class: what its channels have
    /// in common is no more uncertain than that.
    pub fn taken_for_instrument(mut self, effect: usize) -> Self {
        self.instruments.push(effect);
        self
    }

    /// Whether gains of this instrument are refitted.
    pub fn refits_instrument(&self, instrument: Instrument) -> bool {
        let mut free = (N_NOMINAL..self.z.len()).filter(|&k| self.free[k]);
        free.any(|k| {
            let effect = self.effect_of(k);
            self.instruments.contains(&effect)
                && self.effects[effect].effect.gain_of() == Some(instrument)
        })
    }

    /// Whether coordinate `k` is a prior: of the motor file about the motor, or of the class about an instrument.
    pub fn is_prior(&self, k: usize) -> bool {
        k < N_NOMINAL
            || self.instruments.contains(&self.effect_of(k))
            || self.uncertain.contains(&self.effect_of(k))
    }

    /// Prior standard deviation of a coordinate, and its centre.
    pub fn prior_of(&self, k: usize, prior: &Prior) -> (f64, f64) {
        let rated = &prior.plant.rated;
        if k < N_NOMINAL {
            return (prior.deviations[k], 0.0);
        }
        let believed = self
            .uncertain_of(k, prior)
            .and_then(|effect| effect.prior_of(self.parameter_of(k), rated));
        if let Some(believed) = believed {
            return believed;
        }
        let p = self.parameter(k);
        match p.role {
            Role::Size if self.is_prior(k) => (self.class_of(k) / p.typical, 0.0),
            Role::Size => (self.size_deviation(k), 0.0),
            _ => (
                SHAPE_PRIOR,
                to_coordinate(p, p.typical * p.scale.of(rated), rated),
            ),
        }
    }

    /// Class of the instrument that a coordinate is the error of.
    fn class_of(&self, k: usize) -> f64 {
        match self.effects[self.effect_of(k)].effect.offset_of() {
            Some(_) => CHANNEL_OFFSET,
            None => CHANNEL_GAIN,
        }
    }

    /// Prior standard deviation of a size, in typical sizes.
    fn size_deviation(&self, k: usize) -> f64 {
        let config = &self.effects[self.effect_of(k)];
        let own = config
            .effect
            .prior_deviation(&config.values, self.parameter_of(k));
        own.unwrap_or(SIZE_PRIOR)
    }

    /// Longest step of a coordinate in one iteration of a fit.
    pub fn longest_step(&self, k: usize) -> f64 {
        let is_size = |k| k >= N_NOMINAL && self.parameter(k).role == Role::Size;
        match k == FRICTION || is_size(k) {
            true => LONGEST_LINEAR_STEP,
            false => LONGEST_STEP,
        }
    }

    /// Step of a numerical derivative.
    pub fn step(&self, k: usize) -> f64 {
        match k {
            FRICTION => 0.1,
            0..N_NOMINAL => 1e-3,
            _ if self.parameter(k).role == Role::Size => 0.02,
            _ => 1e-3,
        }
    }

    /// Lowest and highest coordinate.
    pub fn bounds(&self, k: usize, prior: &Prior) -> [f64; 2] {
        if k == FRICTION {
            // Total friction may not drive the shaft.
            let mech = &prior.plant.mechanics;
            return [-mech.total_friction() / prior.friction_unit, 1e3];
        }
        if k < N_NOMINAL {
            return [-1.6, 1.6];
        }
        let (p, rated) = (self.parameter(k), &prior.plant.rated);
        p.range
            .map(|x| to_coordinate(p, x * p.scale.of(rated), rated))
    }

    /// Descriptor of the parameter behind coordinate `k` (of an effect).
    pub fn parameter(&self, k: usize) -> &'static Parameter {
        let c = self.coordinates[k - N_NOMINAL];
        &self.effects[c.effect].effect.descriptor().parameters[c.parameter]
    }

    /// Index of the effect to which coordinate `k` belongs.
    pub fn effect_of(&self, k: usize) -> usize {
        self.coordinates[k - N_NOMINAL].effect
    }

    /// Index of the parameter (within its effect) behind coordinate `k`.
    pub fn parameter_of(&self, k: usize) -> usize {
        self.coordinates[k - N_NOMINAL].parameter
    }

    /// The effects with the values of the coordinates.
    pub fn configs(&self, rated: &Rated<f64>) -> Vec<EffectConfig> {
        let mut effects = self.effects.clone();
        for (c, &z) in self.coordinates.iter().zip(&self.z[N_NOMINAL..]) {
            let config = &mut effects[c.effect];
            let p = &config.effect.descriptor().parameters[c.parameter];
            config.values[c.parameter] = from_coordinate(p, z, rated);
        }
        effects
    }

    /// The plant of this hypothesis.
    pub fn plant(&self, prior: &Prior) -> Plant {
        let b = &prior.plant;
        let leakage = self.z[2].exp();
        let mut effects = b.effects.clone();
        effects.extend(self.configs(&b.rated));
        Plant {
            motor: TParams {
                r_s: b.motor.r_s * self.z[0].exp(),
                r_r: b.motor.r_r * self.z[1].exp(),
                l_ls: b.motor.l_ls * leakage,
                l_lr: b.motor.l_lr * leakage,
                l_m: b.motor.l_m * self.z[3].exp(),
            },
            mechanics: Mechanics {
                inertia: b.mechanics.inertia * self.z[4].exp(),
                friction: b.mechanics.friction + self.z[FRICTION] * prior.friction_unit,
                ..b.mechanics
            },
            rated: b.rated,
            effects,
        }
    }
}

/// Sizes in typical sizes, shapes as logarithms.
pub fn to_coordinate(p: &Parameter, value: f64, rated: &Rated<f64>) -> f64 {
    match p.role {
        Role::Size => value / (p.typical * p.scale.of(rated)),
        Role::Shape | Role::Form => value.ln(),
    }
}

fn from_coordinate(p: &Parameter, z: f64, rated: &Rated<f64>) -> f64 {
    match p.role {
        Role::Size => z * p.typical * p.scale.of(rated),
        Role::Shape | Role::Form => z.exp(),
    }
}
