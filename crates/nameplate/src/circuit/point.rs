//! One operating point of the circuit.

use num_complex::Complex64;

use super::{Circuit, Rating};

/// Current at which the library's leakage saturation reaches half of its drop, in rated currents.
pub(crate) const REFERENCE_CURRENT: f64 = 3.0;
/// Share of rated speed below which a shaft hardly turns.
const STANDSTILL: f64 = 0.02;
/// Iterations of the current that its own leakage depends on; the secant needs four to six.
const ROUNDS: usize = 40;
/// Relative change of the current at which the iteration ends: far below the differences a Jacobian is made of.
const SETTLED: f64 = 1e-12;

/// Temperature of the resistances.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Winding {
    /// As at rated load.
    Warm,
    /// As in the tests of breakdown and locked rotor.
    Cold,
}

/// What the circuit takes and gives at one slip, per unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Torque at the shaft.
    pub torque: f64,
    /// Magnitude of the stator current.
    pub current: f64,
    /// Active power taken.
    pub active: f64,
    /// Reactive power taken.
    pub reactive: f64,
}

/// Stator current, air-gap voltage and rotor admittance.
struct Flow {
    current: Complex64,
    air_gap: Complex64,
    rotor_admittance: Complex64,
}

impl Circuit {
    /// The operating point at `slip` (0 < slip <= 1) and rated voltage.
    pub fn at_slip(&self, rating: &Rating, slip: f64, winding: Winding) -> Point {
        let flow = self.flow(slip, winding);
        let current = flow.current.norm();
        let air_gap_torque = flow.air_gap.norm_sqr() * flow.rotor_admittance.re;
        let rated_torque = rating.power / (1.0 - rating.slip * self.slip_ratio);
        let speed = (1.0 - slip) / (1.0 - rating.slip * self.slip_ratio);
        Point {
            torque: air_gap_torque
                - rated_torque
                    * (self.windage * speed * speed
                        + self.stray * current * current * turning(speed)),
            current,
            active: flow.current.re,
            reactive: -flow.current.im,
        }
    }

    /// The operating point at rated load.
    pub fn at_rating(&self, rating: &Rating) -> Point {
        self.at_slip(rating, rating.slip * self.slip_ratio, Winding::Warm)
    }

    /// Air-gap voltage at rated load.
    pub(crate) fn rated_air_gap_voltage(&self, rating: &Rating) -> f64 {
        let slip = rating.slip * self.slip_ratio;
        self.flow(slip, Winding::Warm).air_gap.norm()
    }

    /// Factor on all leakages at a stator current, 1 at rated current; the form of the effect `leakage-saturation`.
    pub fn saturation(&self, current: f64) -> f64 {
        let drop = self.leakage_drop();
        unsaturated_share(drop, current) / unsaturated_share(drop, 1.0)
    }

    /// `leakage_drop` of the effect `leakage-saturation`: share of the leakage without current that is lost at most.
    pub fn leakage_drop(&self) -> f64 {
        let k = self.saturated_leakage;
        (1.0 - k) / (1.0 - k * share_lost(1.0))
    }

    /// Leakage at rated current over leakage without current.
    pub fn saturation_without_current(&self) -> f64 {
        unsaturated_share(self.leakage_drop(), 1.0)
    }

    fn flow(&self, slip: f64, winding: Winding) -> Flow {
        let mut current = if slip > 0.1 { 5.0 } else { 1.0 };
        let mut flow = self.flow_at(slip, winding, current);
        if self.saturated_leakage >= 1.0 {
            return flow;
        }
        let mut before: Option<(f64, f64)> = None;
        for _ in 0..ROUNDS {
            let error = flow.current.norm() - current;
            if error.abs() <= SETTLED * current {
                break;
            }
            let next = match before {
                Some((old, old_error)) if (error - old_error).abs() > 0.0 => {
                    current - error * (current - old) / (error - old_error)
                }
                _ => current + error,
            };
            before = Some((current, error));
            current = next.max(1e-3);
            flow = self.flow_at(slip, winding, current);
        }
        flow
    }

    fn flow_at(&self, slip: f64, winding: Winding, current: f64) -> Flow {
        let warmth = match winding {
            Winding::Warm => 1.0,
            Winding::Cold => self.cold_resistance,
        };
        let g = self.saturation(current);
        let leakage = Complex64::new(0.0, self.leakage * g);
        let inner = Complex64::new(
            self.inner_resistance * warmth / slip,
            self.inner_leakage * g,
        );
        let cages = (inner.inv() + slip / (self.outer_resistance() * warmth)).inv();
        let rotor_admittance = (cages + leakage).inv();
        let parallel = Complex64::new(self.core_conductance, -1.0 / self.magnetizing);
        let air_gap_impedance = (parallel + rotor_admittance).inv();
        let current = (leakage + air_gap_impedance + self.stator_resistance * warmth).inv();
        Flow {
            current,
            air_gap: current * air_gap_impedance,
            rotor_admittance,
        }
    }
}

/// The effect `stray-load-loss` brakes a turning shaft with the same torque at every speed, and a standing one not at all.
fn turning(speed: f64) -> f64 {
    (speed / STANDSTILL).min(1.0)
}

/// `x^2/(1 + x^2)` of the effect `leakage-saturation`.
fn share_lost(current: f64) -> f64 {
    let x = current / REFERENCE_CURRENT;
    x * x / (1.0 + x * x)
}

fn unsaturated_share(drop: f64, current: f64) -> f64 {
    1.0 - drop * share_lost(current)
}
