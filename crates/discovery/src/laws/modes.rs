//! A curve as a sum of modes: the coordinates of a law while it is fitted.
//!
//! Ten cubic B-splines at equal distances with a penalty on second differences (Eilers and Marx, 1996,
//! doi:10.1214/ss/1038425655), turned to the penalty's own axes, so that each mode has a prior of its own. Where a
//! coordinate passes zero the knots crowd there by an inverse hyperbolic sine; elsewhere they do where that is asked
//! for. Over an angle the modes are a constant and harmonics.

use motor::effect::curve::{Action, Coordinate, Law, tabulated};
use motor::effect::{
    Applies, Descriptor, EffectConfig, MAX_PARAMETERS, Parameter, Rated, Role, Scale, SteadyEffect,
    SteadyPoint, Written,
};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;
use std::sync::LazyLock;

/// B-splines of a curve.
pub(crate) const SPLINES: usize = 10;
/// Harmonics of a curve over an angle.
const HARMONICS: usize = 8;
/// Modes of a curve over an angle.
pub(crate) const TURN_MODES: usize = 1 + 2 * HARMONICS;
/// Parameters before the sizes: lowest and highest coordinate, width of the crowded knots (0: none) and their centre, stiffness.
const SHAPES: usize = 5;
const WARP: usize = 2;
const CENTRE: usize = 3;
const STIFFNESS: usize = 4;
/// Places at which a curve is drawn with modes.
const DRAWN: usize = 200;
/// Weight of each mode when a curve is drawn: it decides where modes hardly differ.
const DRAWN_RIDGE: f64 = 1e-6;
/// Share of the range within which knots crowd about zero.
const CROWDED: f64 = 0.12;
/// Prior weight of each mode beside its stiffness: one over the square of four typical sizes, as an effect's size.
const RIDGE: f64 = 1.0 / 16.0;

/// A law with its modes. Its values: the five shapes, then the size of each mode.
#[derive(Debug)]
pub(crate) struct Modes {
    /// Where it acts, over what.
    pub action: Action,
    descriptor: &'static Descriptor,
}

/// Every law there is, once.
static LAWS: LazyLock<Vec<Modes>> = LazyLock::new(|| Action::all().map(Modes::new).collect());

/// Penalty on the splines in its own axes: eigenvalues, and for each spline its share of each mode.
static AXES: LazyLock<(DVector<f64>, DMatrix<f64>)> = LazyLock::new(|| {
    let second = DMatrix::from_fn(SPLINES - 2, SPLINES, |row, column| {
        match column.checked_sub(row) {
            Some(0 | 2) => 1.0,
            Some(1) => -2.0,
            _ => 0.0,
        }
    });
    let eigen = nalgebra::SymmetricEigen::new(second.transpose() * second);
    (
        eigen.eigenvalues.map(|x: f64| x.max(0.0)),
        eigen.eigenvectors,
    )
});

impl Modes {
    fn new(action: Action) -> Self {
        let quantity = action.place.quantity(action.coordinate);
        let shape = Parameter {
            name: "shape",
            unit: action.coordinate.unit(),
            role: Role::Form,
            written: Written::Plain,
            scale: Scale::Own,
            range: [-f64::MAX, f64::MAX],
            typical: 1.0,
            grid: &[],
            is_resonance: false,
        };
        let size = Parameter {
            name: quantity.key,
            unit: quantity.unit,
            role: Role::Size,
            scale: quantity.scale,
            range: [-1e3 * quantity.typical, 1e3 * quantity.typical],
            typical: quantity.typical,
            ..shape
        };
        let n = count(action.coordinate);
        Self {
            descriptor: Box::leak(Box::new(Descriptor {
                name: motor::effect::curve::NAME,
                form: String::leak(format!(
                    "{} over {}",
                    action.place.name(),
                    action.coordinate.name()
                )),
                kind: action.place.kind(),
                applies: Applies::Samples,
                parameters: Vec::leak([vec![shape; SHAPES], vec![size; n]].concat()),
                symptom: "",
                look_alikes: &[],
                separating_test: "",
            })),
            action,
        }
    }

    /// A law of nothing, whose curve reaches from `low` to `high`.
    pub fn absent(action: Action, [low, high]: [f64; 2]) -> EffectConfig {
        let law = LAWS.iter().find(|law| law.action == action);
        let effect = law.unwrap_or(&LAWS[0]);
        let crowd = crowded(action.coordinate, [low, high]);
        let mut values = vec![low, high, crowd, 0.0, 0.0];
        values.resize(SHAPES + count(action.coordinate), 0.0);
        EffectConfig { effect, values }
    }

    /// The law of a config without its curve, with knots that crowd about a share of the way from end to end, `width` as a share of that
    /// way; `None` over an angle.
    pub fn crowded_about(config: &EffectConfig, place: f64, width: f64) -> Option<EffectConfig> {
        let action = Self::of(config)?.action;
        let [low, high] = [config.values[0], config.values[1]];
        let mut crowd = Self::absent(action, [low, high]);
        crowd.values[WARP] = width * (high - low);
        crowd.values[CENTRE] = low + place * (high - low);
        (!action.coordinate.is_angle()).then_some(crowd)
    }

    /// Draws a curve with the modes of a config of this law, over its range, as nearly as they can (least squares).
    pub fn draw(&self, config: &mut EffectConfig, curve: impl Fn(f64) -> f64) {
        let [low, high] = [config.values[0], config.values[1]];
        let at = |k: usize| low + (high - low) * k as f64 / (DRAWN - 1) as f64;
        let n = count(self.action.coordinate);
        let mut gram = DMatrix::identity(n, n) * DRAWN_RIDGE;
        let mut moment = DVector::zeros(n);
        for x in (0..DRAWN).map(at) {
            let shares = DVector::from_vec(self.shares(&config.values, x));
            gram += &shares * shares.transpose();
            moment += shares * curve(x);
        }
        if let Some(sizes) = gram.cholesky().map(|gram| gram.solve(&moment)) {
            config.values[SHAPES..].copy_from_slice(sizes.as_slice());
        }
    }

    /// A law of one value everywhere.
    pub fn constant(action: Action, range: [f64; 2], value: f64) -> EffectConfig {
        let mut config = Self::absent(action, range);
        let sizes = &mut config.values[SHAPES..];
        match action.coordinate.is_angle() {
            true => sizes[0] = value,
            // The splines sum to one.
            false => {
                for (mode, size) in sizes.iter_mut().enumerate() {
                    *size = value * AXES.1.column(mode).sum();
                }
            }
        }
        config
    }

    /// The law behind an effect of a hypothesis; `None` for any other effect.
    pub fn of(config: &EffectConfig) -> Option<&'static Modes> {
        let descriptor = config.effect.descriptor();
        LAWS.iter()
            .find(|law| std::ptr::eq(law.descriptor, descriptor))
    }

    /// Value of each mode at `x`, for sizes of one.
    pub fn shares(&self, p: &[f64], x: f64) -> Vec<f64> {
        match self.action.coordinate.is_angle() {
            true => harmonics(x).to_vec(),
            false => spline_modes(p, x).to_vec(),
        }
    }

    /// Value of the curve at `x`, in the unit of its place.
    pub fn value(&self, p: &[f64], x: f64) -> f64 {
        let shares = self.shares(p, x);
        shares.iter().zip(&p[SHAPES..]).map(|(s, u)| s * u).sum()
    }

    /// The coordinate at a share of the way between the ends, on the axis of the splines.
    pub fn along(&self, p: &[f64], share: f64) -> f64 {
        match self.action.coordinate.is_angle() {
            true => TAU * share,
            false => from_place(p, share),
        }
    }

    /// Places at which a curve of knots meets this one: more than two for each interval of the splines.
    pub fn knots(&self, p: &[f64]) -> Vec<f64> {
        const OPEN: usize = 18;
        const TURN: usize = 36;
        if self.action.coordinate.is_angle() {
            return (0..TURN).map(|k| TAU * k as f64 / TURN as f64).collect();
        }
        let at = |k: usize| from_place(p, k as f64 / (OPEN - 1) as f64);
        (0..OPEN).map(at).collect()
    }
}

/// Prior weight of each mode for a stiffness of one.
pub(crate) fn stiffness(coordinate: Coordinate) -> Vec<f64> {
    if coordinate.is_angle() {
        let order = |mode: usize| match mode {
            0 => 0,
            mode if mode <= HARMONICS => mode,
            mode => mode - HARMONICS,
        };
        let one = |mode| (order(mode) as f64).powi(4) / (HARMONICS * HARMONICS) as f64;
        return (0..count(coordinate)).map(one).collect();
    }
    AXES.0.iter().copied().collect()
}

/// Prior weight of a mode.
pub(crate) fn weight(stiffness: f64, of_mode: f64) -> f64 {
    RIDGE + stiffness * of_mode
}

/// Number of modes.
pub(crate) fn count(coordinate: Coordinate) -> usize {
    match coordinate.is_angle() {
        true => TURN_MODES,
        false => SPLINES,
    }
}

/// Sets how dear the bending modes are.
pub(crate) fn stiffen(config: &mut EffectConfig, stiffness: f64) {
    config.values[STIFFNESS] = stiffness;
}

/// How dear the bending modes are.
pub(crate) fn stiffness_of(config: &EffectConfig) -> f64 {
    config.values[STIFFNESS]
}

/// Indices of the sizes among the values.
#[cfg(test)]
pub(crate) fn sizes(config: &EffectConfig) -> std::ops::Range<usize> {
    SHAPES..config.values.len()
}

/// Width of the crowded knots of a coordinate that passes zero.
fn crowded(coordinate: Coordinate, [low, high]: [f64; 2]) -> f64 {
    let crowds = matches!(
        coordinate,
        Coordinate::Speed | Coordinate::Slip | Coordinate::PhaseCurrent
    );
    let largest = low.abs().max(high.abs());
    let passes = low < 0.25 * largest && high > -0.25 * largest;
    match crowds && passes {
        true => CROWDED * largest,
        false => 0.0,
    }
}

/// Place of `x` between the ends, 0 to 1, on the axis of the splines.
fn place(p: &[f64], x: f64) -> f64 {
    let (low, high) = (warped(p, p[0]), warped(p, p[1]));
    ((warped(p, x) - low) / (high - low)).clamp(0.0, 1.0)
}

/// `x` on the axis on which knots have equal distances.
fn warped(p: &[f64], x: f64) -> f64 {
    match p[WARP] > 0.0 {
        true => ((x - p[CENTRE]) / p[WARP]).asinh(),
        false => x,
    }
}

fn from_place(p: &[f64], place: f64) -> f64 {
    if p[WARP] <= 0.0 {
        return p[0] + place * (p[1] - p[0]);
    }
    let (low, high) = (warped(p, p[0]), warped(p, p[1]));
    p[CENTRE] + p[WARP] * (low + place * (high - low)).sinh()
}

/// The four cubic B-splines that are not zero at `place`, with their values.
fn splines(place: f64) -> [(usize, f64); 4] {
    let u = place * (SPLINES - 3) as f64;
    let k = (u as usize).min(SPLINES - 4);
    let f = u - k as f64;
    let (f2, f3) = (f * f, f * f * f);
    [
        (k, (1.0 - f).powi(3) / 6.0),
        (k + 1, (3.0 * f3 - 6.0 * f2 + 4.0) / 6.0),
        (k + 2, (-3.0 * f3 + 3.0 * f2 + 3.0 * f + 1.0) / 6.0),
        (k + 3, f3 / 6.0),
    ]
}

/// Value of each mode of a curve of splines at `x`, for sizes of one.
pub(crate) fn spline_modes(p: &[f64], x: f64) -> [f64; SPLINES] {
    let mut shares = [0.0; SPLINES];
    for (spline, weight) in splines(place(p, x)) {
        for (mode, share) in shares.iter_mut().enumerate() {
            *share += weight * AXES.1[(spline, mode)];
        }
    }
    shares
}

/// A constant, then cosines, then sines of the harmonics of an angle.
pub(crate) fn harmonics(x: f64) -> [f64; TURN_MODES] {
    let mut shares = [1.0; TURN_MODES];
    let (sin, cos) = x.sin_cos();
    let (mut c, mut s) = (1.0, 0.0);
    for k in 1..=HARMONICS {
        (c, s) = (c * cos - s * sin, s * cos + c * sin);
        (shares[k], shares[HARMONICS + k]) = (c, s);
    }
    shares
}

impl SteadyEffect for Modes {
    fn descriptor(&self) -> &'static Descriptor {
        self.descriptor
    }

    /// A law is asked about recordings only; the board gets it as knots.
    fn correct_f32(&self, _p: &[f32; MAX_PARAMETERS], _point: &mut SteadyPoint<f32>) {}

    fn correct_f64(&self, _p: &[f64], _point: &mut SteadyPoint<f64>) {}
}

impl Law for Modes {
    fn action(&self) -> Action {
        self.action
    }

    fn table(&self, p: &[f64], rated: &Rated<f64>) -> Vec<f64> {
        let per_unit = self.action.per_unit(rated);
        let range = self.action.coordinate.ends([p[0], p[1]]);
        if self.action.coordinate.is_angle() {
            return tabulated(range, per_unit, |x| self.value(p, x));
        }
        // The sum over modes once for each spline, not once for each point of the table.
        let sizes = DVector::from_column_slice(&p[SHAPES..]);
        let of_spline = &AXES.1 * sizes;
        tabulated(range, per_unit, |x| {
            let near = splines(place(p, x));
            near.iter().map(|&(k, weight)| weight * of_spline[k]).sum()
        })
    }

    fn deviation(&self, p: &[f64], parameter: usize) -> Option<f64> {
        let of_mode = stiffness(self.action.coordinate);
        let mode = parameter.checked_sub(SHAPES)?;
        Some(weight(p[STIFFNESS], *of_mode.get(mode)?).sqrt().recip())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use motor::effect::Effect;
    use motor::effect::curve::{Place, Table};

    fn law(place: Place, coordinate: Coordinate, range: [f64; 2]) -> EffectConfig {
        Modes::absent(Action { place, coordinate }, range)
    }

    /// B-splines at equal distances sum to one: the constant costs no stiffness, nor does a line.
    #[test]
    fn a_constant_and_a_line_are_free_of_stiffness() {
        let free = stiffness(Coordinate::Time)
            .iter()
            .filter(|k| **k < 1e-9)
            .count();
        assert_eq!(free, 2);
        let law = law(Place::Torque, Coordinate::Time, [0.0, 6.0]);
        let modes = Modes::of(&law).expect("a law");
        for x in [0.0, 0.1, 2.9, 6.0] {
            let sum: f64 = splines(place(&law.values, x)).iter().map(|s| s.1).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{x}");
            assert_eq!(modes.shares(&law.values, x).len(), SPLINES);
        }
    }

    /// A bump of a second and a half in ten, in the middle of an interval of splines at equal distances: a crowd about it draws it.
    #[test]
    fn a_crowd_of_knots_draws_a_bump_that_equal_distances_do_not() {
        let law = law(Place::Torque, Coordinate::Time, [0.0, 10.0]);
        let modes = Modes::of(&law).expect("a law");
        let bump = |x: f64| (-((x - 5.0) / 0.4).powi(2)).exp();
        let xs = || (0..1000).map(|k| 0.01 * f64::from(k));
        let left = |of: &EffectConfig| {
            let mut drawn = of.clone();
            modes.draw(&mut drawn, bump);
            let squares = xs().map(|x| (modes.value(&drawn.values, x) - bump(x)).powi(2));
            let all: f64 = xs().map(|x| bump(x).powi(2)).sum();
            (squares.sum::<f64>() / all).sqrt()
        };
        // A curve that is found is to be within 15 % of the true one.
        assert!(left(&law) > 0.15, "{}", left(&law));
        // Places are tried at distances of a 24th: half of one is the farthest from where the bump is.
        for place in [0.5, 0.5 - 1.0 / 48.0] {
            let crowd = Modes::crowded_about(&law, place, 0.04).expect("no angle");
            assert!(left(&crowd) < 0.15, "{place}: {}", left(&crowd));
        }
    }

    /// A curve drawn with other knots is the same curve; over an angle there are no knots to crowd.
    #[test]
    fn a_curve_drawn_with_other_knots_is_the_same() {
        let mut from = law(Place::Torque, Coordinate::Speed, [-10.0, 157.0]);
        for (mode, k) in sizes(&from).enumerate() {
            // The smooth modes are the last ones.
            from.values[k] = if mode + 3 >= SPLINES { 1.0 } else { 0.0 };
        }
        let modes = Modes::of(&from).expect("a law");
        let mut to = Modes::crowded_about(&from, 0.5, 0.5).expect("no angle");
        modes.draw(&mut to, |x| modes.value(&from.values, x));
        let size = (0..=100).map(|k| modes.value(&from.values, 1.67 * f64::from(k) - 10.0));
        let size = size.fold(0.0f64, |a, y| a.max(y.abs()));
        for k in 0..=100 {
            let x = 1.67 * f64::from(k) - 10.0;
            let (a, b) = (modes.value(&from.values, x), modes.value(&to.values, x));
            // As near as the curve of knots is to that of modes, below.
            assert!((a - b).abs() < 0.02 * size, "{x}: {a} {b}");
        }
        let turn = law(Place::Torque, Coordinate::Angle, [0.0, TAU]);
        assert!(Modes::crowded_about(&turn, 0.5, 0.04).is_none());
    }

    /// The prepared table, the sum over modes and the curve of knots are one curve.
    #[test]
    fn a_table_and_knots_are_the_curve_of_the_modes() {
        let rated = Rated {
            voltage: 325.0,
            current: 7.0,
            omega_sync: 314.0,
            n_p: 2.0,
            torque: 14.6,
        };
        for (coordinate, range) in [
            (Coordinate::Speed, [-10.0, 157.0]),
            (Coordinate::Time, [0.0, 6.0]),
            (Coordinate::Angle, [0.0, TAU]),
        ] {
            let mut law = law(Place::Torque, coordinate, range);
            for k in sizes(&law) {
                // Stiff modes are small, as in fitted curves.
                let stiff = stiffness(coordinate)[k - SHAPES];
                law.values[k] = (k as f64).sin() / (1.0 + 10.0 * stiff);
            }
            let modes = Modes::of(&law).expect("a law");
            let table = modes.prepared(&law.values, &rated);
            let knots = super::super::curve::as_knots(&law).expect("knots");
            let there = knots.effect.prepared(&knots.values, &rated);
            let size = table[2..].iter().fold(0.0f64, |a, b| a.max(b.abs()));
            for k in 0..=100 {
                let x = range[0] + (range[1] - range[0]) * f64::from(k) / 100.0 * 0.9999;
                let exact = modes.value(&law.values, x);
                assert!(
                    (Table::of(&table).at(x) - exact).abs() < 0.01 * size,
                    "{coordinate:?} {x}"
                );
                let of_knots = Table::of(&there).at(x);
                assert!(
                    (of_knots - exact).abs() < 0.02 * size,
                    "{coordinate:?} {x}: {of_knots} {exact}"
                );
            }
        }
    }
}
