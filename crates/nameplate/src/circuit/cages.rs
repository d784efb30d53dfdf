//! Two cages with a common leakage as two branches in parallel, each with its own: the form of the effect `deep-bar`.

use super::Circuit;

/// The rotor as the effect `deep-bar` (form `double-cage`) writes it, per unit at rated current.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cages {
    /// Rotor resistance at low slip.
    pub rotor_resistance: f64,
    /// Rotor leakage reactance at low slip.
    pub rotor_leakage: f64,
    /// Rotor resistance over that of the second cage.
    pub second_cage_share: f64,
    /// Leakage of the second cage over the rotor's at low slip.
    pub second_cage_leakage_ratio: f64,
}

impl Cages {
    /// The branches whose impedance equals `X p + R_2 (R_1 + X_1 p)/(R_1 + R_2 + X_1 p)` at every slip (`p = j s`).
    ///
    /// Both are forms of one impedance of two resistances and two leakages (Foster): the poles of the admittance are the
    /// zeros of `X X_1 p^2 + (X (R_1 + R_2) + R_2 X_1) p + R_1 R_2`.
    pub fn of(circuit: &Circuit) -> Cages {
        let (x, x_1) = (circuit.leakage, circuit.inner_leakage);
        let (r_1, r_2) = (circuit.inner_resistance, circuit.outer_resistance());
        let (a, b, c) = (x * x_1, x * (r_1 + r_2) + r_2 * x_1, r_1 * r_2);
        let root = (b * b - 4.0 * a * c).max(0.0).sqrt();
        // The decay rates R/X of both branches; the product of the roots gives the small one without cancellation.
        let fast = (b + root) / (2.0 * a);
        let slow = c / (a * fast);
        let leakage = |rate: f64, other: f64| x * x_1 * (other - rate) / (r_1 + r_2 - x_1 * rate);
        let (x_slow, x_fast) = (leakage(slow, fast), leakage(fast, slow));
        let (r_slow, r_fast) = (x_slow * slow, x_fast * fast);
        let rotor_resistance = r_1 * r_2 / (r_1 + r_2);
        let share = r_2 / (r_1 + r_2);
        let rotor_leakage = x + x_1 * share * share;
        let (r_second, x_second) = if r_fast >= r_slow {
            (r_fast, x_fast)
        } else {
            (r_slow, x_slow)
        };
        Cages {
            rotor_resistance,
            rotor_leakage,
            second_cage_share: rotor_resistance / r_second,
            second_cage_leakage_ratio: x_second / rotor_leakage,
        }
    }
}
