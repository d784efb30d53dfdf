//! The supply of a scenario as a voltage vector over time.

use crate::scenario::SupplySpec;
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, TAU};

#[derive(Clone, Debug)]
pub(super) struct Waveform {
    spec: SupplySpec,
}

impl Waveform {
    pub(super) fn new(spec: &SupplySpec) -> Waveform {
        Waveform { spec: spec.clone() }
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
        let angle = self.angle(t);
        let turned = |order: f64| Complex64::from_polar(1.0, order * angle);
        let rest: Complex64 = self
            .spec
            .components
            .iter()
            .map(|component| component.amplitude * turned(component.order))
            .sum();
        (turned(1.0) + rest) * self.amplitude(t)
    }
}
