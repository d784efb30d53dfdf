//! Operating points of the tests in closed form, each from what sets it: air-gap voltage, current or slip.
//!
//! Per unit; `nu` is the frequency over the rated one. The magnetizing branch saturates with the flux, the leakages with the
//! stator current.

use num_complex::Complex64;

use crate::measured::unknowns::Machine;

/// Rounds in which a weak dependence settles; each gains more than a factor of ten.
const ROUNDS: usize = 6;

/// What the terminals and the shaft show, per unit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shown {
    pub voltage: f64,
    pub current: f64,
    pub active: f64,
    pub torque: f64,
}

impl Shown {
    fn of(voltage: Complex64, current: Complex64, torque: f64) -> Shown {
        Shown {
            voltage: voltage.norm_sqr().sqrt(),
            current: current.norm_sqr().sqrt(),
            active: (voltage * current.conj()).re,
            torque,
        }
    }
}

impl Machine {
    /// Susceptance of the magnetizing branch at an air-gap voltage.
    fn magnetizing(&self, air_gap: f64, nu: f64) -> f64 {
        let [share, exponent] = self.saturation();
        let flux = air_gap / (nu * self.rated_flux);
        (1.0 + share * (flux.max(1e-6).powf(exponent) - 1.0)) / (self.circuit.magnetizing * nu)
    }

    fn stator(&self, current: f64, nu: f64, warmth: f64) -> Complex64 {
        let leakage = self.circuit.leakage * nu * self.circuit.saturation(current);
        Complex64::new(self.circuit.stator_resistance * warmth, leakage)
    }

    fn rotor_admittance(&self, slip: f64, current: f64, nu: f64, warmth: f64) -> Complex64 {
        let c = &self.circuit;
        let g = nu * c.saturation(current);
        let inner = Complex64::new(c.inner_resistance * warmth / slip, c.inner_leakage * g);
        let cages = (inner.inv() + slip / (c.outer_resistance() * warmth)).inv();
        (cages + Complex64::new(0.0, c.leakage * g)).inv()
    }

    /// Torque that the shaft loses at a speed over synchronous speed and a stator current.
    fn lost_torque(&self, speed: f64, current: f64) -> f64 {
        self.friction(speed / self.rated_speed)
            + self.rated_torque * self.circuit.stray * current * current
    }

    /// Uncoupled: the slip is where the rotor gives what friction and stray load take.
    pub(super) fn no_load(&self, air_gap: f64, degc: f64, nu: f64) -> Shown {
        let [stator, rotor] = self.warmth(degc);
        let branch = Complex64::new(
            self.circuit.core_conductance,
            -self.magnetizing(air_gap, nu),
        );
        let (mut slip, mut current) = (1e-3, air_gap * branch);
        for _ in 0..ROUNDS {
            let admittance = self.rotor_admittance(slip, current.norm_sqr().sqrt(), nu, rotor);
            let given = air_gap * air_gap * admittance.re / nu;
            let needed = self.lost_torque(nu * (1.0 - slip), current.norm_sqr().sqrt());
            slip = (slip * needed / given).clamp(1e-9, 0.5);
            current = air_gap * (branch + admittance * (needed / given));
        }
        let voltage = air_gap + current * self.stator(current.norm_sqr().sqrt(), nu, stator);
        Shown::of(voltage, current, 0.0)
    }

    /// Standing still at a stator current.
    pub(super) fn locked(&self, current: f64, degc: f64, nu: f64) -> Shown {
        let [stator, rotor] = self.warmth(degc);
        let admittance = self.rotor_admittance(1.0, current, nu, rotor);
        let mut air_gap = current / admittance.norm_sqr().sqrt();
        let mut parallel = admittance;
        for _ in 0..ROUNDS {
            let branch = Complex64::new(
                self.circuit.core_conductance,
                -self.magnetizing(air_gap, nu),
            );
            parallel = admittance + branch;
            air_gap = current / parallel.norm_sqr().sqrt();
        }
        let impedance = parallel.inv() + self.stator(current, nu, stator);
        let torque = air_gap * air_gap * admittance.re / nu;
        Shown::of(impedance * current, Complex64::from(current), torque)
    }

    /// Running at a slip.
    pub(super) fn running(&self, air_gap: f64, slip: f64, degc: f64, nu: f64) -> Shown {
        let [stator, rotor] = self.warmth(degc);
        let branch = Complex64::new(
            self.circuit.core_conductance,
            -self.magnetizing(air_gap, nu),
        );
        let (mut current, mut admittance) = (Complex64::from(1.0), Complex64::from(1.0));
        for _ in 0..ROUNDS {
            admittance = self.rotor_admittance(slip, current.norm_sqr().sqrt(), nu, rotor);
            current = air_gap * (admittance + branch);
        }
        let torque = air_gap * air_gap * admittance.re / nu
            - self.lost_torque(nu * (1.0 - slip), current.norm_sqr().sqrt());
        let voltage = air_gap + current * self.stator(current.norm_sqr().sqrt(), nu, stator);
        Shown::of(voltage, current, torque)
    }
}
