//! The supply of a scenario as a voltage vector over time.

use crate::scenario::SupplySpec;
use num_complex::Complex64;
use std::cell::Cell;
use std::f64::consts::{FRAC_PI_2, TAU};

#[derive(Clone, Debug)]
pub(super) struct Waveform {
    spec: SupplySpec,
    /// The latest instant and its voltage: an integration step asks for the same instants again.
    latest: Cell<(f64, Complex64)>,
}

impl Waveform {
    pub(super) fn new(spec: &SupplySpec) -> Waveform {
        Waveform {
            spec: spec.clone(),
            latest: Cell::new((f64::NAN, Complex64::ZERO)),
        }
    }

    /// Angle of the positive sequence, rad; kept through frequency steps.
    pub(super) fn angle(&self, t: f64) -> f64 {
        self.spec.phase_rad + TAU * self.spec.frequency_hz.integral(t)
    }

    /// Angle of the d axis of the voltage frame, rad.
    pub(super) fn d_axis(&self, t: f64) -> f64 {
        self.angle(t) - FRAC_PI_2
    }

    /// Phase amplitude of the positive sequence, V; 0 before the motor is switched on.
    pub(super) fn amplitude(&self, t: f64) -> f64 {
        if t < self.spec.switch_on_s {
            0.0
        } else {
            self.spec.amplitude_volt.at(t)
        }
    }

    /// Angular frequency of the positive sequence, rad/s.
    pub(super) fn omega_sync(&self, t: f64) -> f64 {
        TAU * self.spec.frequency_hz.at(t)
    }

    /// Voltage vector, V.
    pub(super) fn at(&self, t: f64) -> Complex64 {
        let (latest, u) = self.latest.get();
        if t == latest {
            return u;
        }
        let u = self.evaluate(t);
        self.latest.set((t, u));
        u
    }

    fn evaluate(&self, t: f64) -> Complex64 {
        let angle = self.angle(t);
        let first = Complex64::from_polar(1.0, angle);
        let components = self.spec.components.iter();
        let rest: Complex64 = components
            .map(|component| component.amplitude * turned(first, angle, component.order))
            .sum();
        (first + rest) * self.amplitude(t)
    }
}

/// `e^(j order angle)`, from the first power where the order is whole: no sine for every harmonic.
fn turned(first: Complex64, angle: f64, order: f64) -> Complex64 {
    if order.fract() != 0.0 {
        return Complex64::from_polar(1.0, order * angle);
    }
    let power = first.powu(order.abs() as u32);
    if order < 0.0 { power.conj() } else { power }
}

#[cfg(test)]
mod tests {
    use super::turned;
    use num_complex::Complex64;

    #[test]
    fn powers_are_the_turned_vector() {
        for (angle, order) in [
            (0.3, -1.0),
            (700.1, -5.0),
            (-2.0, 49.0),
            (1.0, 2.5),
            (9.0, 0.0),
        ] {
            let turn = turned(Complex64::from_polar(1.0, angle), angle, order);
            let expected = Complex64::from_polar(1.0, order * angle);
            // Rounding of the angle 700 times five.
            assert!((turn - expected).norm() < 1e-12, "{angle} {order}");
        }
    }
}
