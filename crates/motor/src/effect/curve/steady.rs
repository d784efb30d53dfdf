//! A law in steady state: what the lamps need, without allocation.

use super::{Action, Coordinate, Place};
use crate::effect::SteadyPoint;
use crate::effect::steady::lit;
use num_complex::Complex;
use num_traits::Float;
use spline::piece;

/// Cosines of the odd multiples of 5.625 degrees: where the voltage drop of a phase is taken over a quarter of a cycle (Gauss and
/// Chebyshev).
const COSINES: [f64; 8] = [
    0.995_184_726_672_197,
    0.956_940_335_732_209,
    0.881_921_264_348_355,
    0.773_010_453_362_737,
    0.634_393_284_163_645,
    0.471_396_736_825_998,
    0.290_284_677_254_462,
    0.098_017_140_329_561,
];

/// Most knots of a curve on the board.
pub const BOARD_KNOTS: usize = 24;

/// A curve with its bends, ready to be evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteadyCurve<F> {
    /// Where it acts, over what.
    pub action: Action,
    knots: usize,
    x: [F; BOARD_KNOTS],
    y: [F; BOARD_KNOTS],
    second: [F; BOARD_KNOTS],
    mean: F,
}

impl<F: Float> SteadyCurve<F> {
    /// From knots that ascend and their values; `None` for more than there is room for, or fewer than three. Of a curve over an
    /// angle only the mean is kept.
    #[cfg(feature = "file")]
    pub fn new(action: Action, x: &[f64], y: &[f64]) -> Option<Self> {
        if action.coordinate.is_angle() {
            let none = [[F::zero(); BOARD_KNOTS]; 3];
            return Some(Self::of_words(action, 0, lit(mean(x, y)), none));
        }
        if !(3..=BOARD_KNOTS).contains(&x.len()) || x.len() != y.len() {
            return None;
        }
        let narrow = |values: &[f64]| {
            let mut array = [F::zero(); BOARD_KNOTS];
            for (to, &from) in array.iter_mut().zip(values) {
                *to = lit(from);
            }
            array
        };
        let second = spline::bends(x, y);
        let words = [narrow(x), narrow(y), narrow(&second)];
        Some(Self::of_words(action, x.len(), F::zero(), words))
    }

    /// From what [`SteadyCurve::words`] gave: knots, values and bends of the first `knots` places.
    pub fn of_words(
        action: Action,
        knots: usize,
        mean: F,
        [x, y, second]: [[F; BOARD_KNOTS]; 3],
    ) -> Self {
        Self {
            action,
            knots: knots.min(BOARD_KNOTS),
            x,
            y,
            second,
            mean,
        }
    }

    /// Number of knots, mean over a turn, then knots, values and bends.
    pub fn words(&self) -> (usize, F, [[F; BOARD_KNOTS]; 3]) {
        (self.knots, self.mean, [self.x, self.y, self.second])
    }

    /// Value at `x`; beyond the ends it stays.
    fn at(&self, x: F) -> F {
        let knots = self.x.get(..self.knots).unwrap_or_default();
        let [begin, .., end] = *knots else {
            return self.mean;
        };
        let x = x.max(begin).min(end);
        let after = knots.partition_point(|&knot| knot < x).max(1);
        let ends =
            |of: &[F; BOARD_KNOTS]| [after - 1, after].map(|k| *of.get(k).unwrap_or(&self.mean));
        piece(ends(&self.x), ends(&self.y), ends(&self.second), x)
    }

    /// Value of the curve at an operating point; `None` where steady state does not tell the coordinate.
    fn value(&self, point: &SteadyPoint<F>) -> Option<F> {
        let tau: F = lit(core::f64::consts::TAU);
        let x = match self.action.coordinate {
            Coordinate::Speed => point.omega_mech,
            Coordinate::Slip => (point.omega_sync - point.rated.n_p * point.omega_mech) / tau,
            Coordinate::Current if self.action.place == Place::Rotor => rotor_current(point),
            Coordinate::Current => point.i_s.norm_sqr().sqrt(),
            Coordinate::Flux => point.air_gap_flux().norm_sqr().sqrt(),
            Coordinate::Frequency => point.omega_sync / tau,
            Coordinate::Voltage => point.u_s.norm_sqr().sqrt(),
            Coordinate::Angle | Coordinate::AngleElectrical => return Some(self.mean),
            Coordinate::PhaseCurrent | Coordinate::Time | Coordinate::LoadTorque => return None,
        };
        Some(self.at(x))
    }

    /// Resistance that stands for the drop of a phase in the fundamental: the drop's part in phase with the current, over
    /// its amplitude.
    fn describing_resistance(&self, amplitude: F) -> F {
        if amplitude <= F::zero() {
            return F::zero();
        }
        let one = |sum: F, &cos: &f64| {
            let cos: F = lit(cos);
            sum + (self.at(amplitude * cos) - self.at(-amplitude * cos)) * cos
        };
        let sum = COSINES.iter().fold(F::zero(), one);
        sum / (lit::<F>(COSINES.len() as f64) * amplitude)
    }

    /// Moves a point behind the law, as [`crate::effect::SteadyEffect::correct_f32`] does.
    pub fn correct(&self, point: &mut SteadyPoint<F>) {
        if self.action.coordinate == Coordinate::PhaseCurrent {
            return self.correct_drop(point);
        }
        let Some(y) = self.value(point) else { return };
        let one = F::one();
        let factor = (one + y).max(lit(0.05));
        let motor = &mut point.motor;
        match self.action.place {
            Place::Torque | Place::Friction => point.tau_extra = point.tau_extra + y,
            Place::Stator => motor.r_s = motor.r_s * factor,
            // The positive sequence sees a third of what one phase has more.
            Place::StatorPhaseA | Place::StatorPhaseB | Place::StatorPhaseC => {
                motor.r_s = motor.r_s * (one + y / lit(3.0));
            }
            Place::Rotor => motor.r_r = motor.r_r * factor,
            Place::Magnetizing => motor.l_m = motor.l_m / factor,
            Place::Leakage => {
                (motor.l_ls, motor.l_lr) = (motor.l_ls * factor, motor.l_lr * factor);
            }
            Place::SensorSpeed => point.omega_mech = point.omega_mech / factor,
            Place::SensorIa | Place::SensorIb | Place::SensorIc => {}
        }
    }

    /// A drop over each phase's own current, or over that of one phase.
    fn correct_drop(&self, point: &mut SteadyPoint<F>) {
        let amplitude = point.i_s.norm_sqr().sqrt();
        let third: F = lit(1.0 / 3.0);
        let share = match self.action.place {
            Place::Stator => F::one(),
            Place::StatorPhaseA | Place::StatorPhaseB | Place::StatorPhaseC => third,
            _ => return,
        };
        let r = self.describing_resistance(amplitude) * share;
        point.u_s = point.u_s - point.i_s * r;
    }
}

/// Magnitude of the rotor current, A: from the air-gap flux and the stator current.
fn rotor_current<F: Float>(point: &SteadyPoint<F>) -> F {
    let i_m: Complex<F> = point.air_gap_flux() / point.motor.l_m;
    (i_m - point.i_s).norm_sqr().sqrt()
}

/// Mean over one turn of a periodic curve: by trapezoids between knots, which repeat.
#[cfg(feature = "file")]
fn mean(x: &[f64], y: &[f64]) -> f64 {
    let n = x.len();
    let width = |k: usize| match k + 1 == n {
        true => x[0] + core::f64::consts::TAU - x[k],
        false => x[k + 1] - x[k],
    };
    let area = |k: usize| 0.5 * width(k) * (y[k] + y[(k + 1) % n]);
    (0..n).map(area).sum::<f64>() / core::f64::consts::TAU
}
