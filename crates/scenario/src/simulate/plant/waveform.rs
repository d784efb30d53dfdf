//! The supply of a scenario as a voltage vector over time.

use crate::SupplySpec;
use motor::dynamic::{Harmonic, Rotating};
use num_complex::Complex64;
use std::cell::Cell;
use std::f64::consts::{FRAC_PI_2, TAU};

#[derive(Clone, Debug)]
pub(super) struct Waveform {
    spec: SupplySpec,
    whole: Vec<Whole>,
    broken: Vec<Harmonic>,
    /// The latest instant and its voltage: an integration step asks for the same instants again.
    latest: Cell<(f64, Complex64)>,
}

/// A component that turns a whole number of times as fast as the fundamental.
#[derive(Clone, Copy, Debug)]
struct Whole {
    times: u32,
    backwards: bool,
    amplitude: Complex64,
}

impl Waveform {
    pub(super) fn new(spec: &SupplySpec) -> Waveform {
        let is_whole = |component: &Harmonic| component.order.fract() == 0.0;
        let (whole, broken) = spec.components.iter().partition(|x| is_whole(x));
        Waveform {
            spec: spec.clone(),
            whole: in_order(whole),
            broken,
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

    /// Whether the terminals are connected to the supply at time `t`, s.
    pub(super) fn is_closed(&self, t: f64) -> bool {
        self.spec.is_closed(t)
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

    /// Everything that turns, at time `t`: the positive sequence first.
    pub(super) fn rotating(&self, t: f64) -> Vec<Rotating> {
        let (angle, omega_sync) = (self.angle(t), self.omega_sync(t));
        let turned = |component: &Harmonic| Rotating {
            omega: component.order * omega_sync,
            u: component.amplitude
                * Complex64::from_polar(self.amplitude(t), component.order * angle),
        };
        let first = Harmonic {
            order: 1.0,
            amplitude: Complex64::ONE,
        };
        let all = std::iter::once(&first).chain(&self.spec.components);
        all.map(turned).collect()
    }

    fn evaluate(&self, t: f64) -> Complex64 {
        let angle = self.angle(t);
        let first = Complex64::from_polar(1.0, angle);
        let turned = |component: &Harmonic| {
            component.amplitude * Complex64::from_polar(1.0, component.order * angle)
        };
        let rest: Complex64 = self.broken.iter().map(turned).sum();
        (first + powers(&self.whole, first) + rest) * self.amplitude(t)
    }
}

fn in_order(components: Vec<Harmonic>) -> Vec<Whole> {
    let whole = |component: &Harmonic| Whole {
        times: component.order.abs() as u32,
        backwards: component.order < 0.0,
        amplitude: component.amplitude,
    };
    let mut all: Vec<Whole> = components.iter().map(whole).collect();
    all.sort_by_key(|component| component.times);
    all
}

/// The sum of components in the order of their speed, by powers of the fundamental: no sine for each of them.
fn powers(components: &[Whole], first: Complex64) -> Complex64 {
    let square = first * first;
    let (mut power, mut reached) = (Complex64::ONE, 0);
    let mut sum = Complex64::ZERO;
    for component in components {
        while reached + 2 <= component.times {
            power *= square;
            reached += 2;
        }
        if reached < component.times {
            power *= first;
            reached += 1;
        }
        let turn = if component.backwards {
            power.conj()
        } else {
            power
        };
        sum += component.amplitude * turn;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parts_that_turn_are_the_voltage() {
        let component = |order: f64| Harmonic {
            order,
            amplitude: Complex64::from_polar(0.1, order),
        };
        let spec = SupplySpec {
            amplitude_volt: crate::Piecewise::constant(180.0),
            frequency_hz: crate::Piecewise::constant(60.0),
            phase_rad: 0.3,
            switch_on_s: 0.0,
            switch_off_s: None,
            components: [-1.0, -5.0, 6.7].map(component).to_vec(),
        };
        let waveform = Waveform::new(&spec);
        for t in [0.0, 0.013] {
            let sum: Complex64 = waveform.rotating(t).iter().map(|part| part.u).sum();
            assert!((sum - waveform.at(t)).norm() < 1e-9, "{t}");
        }
    }

    #[test]
    fn powers_are_the_turned_vectors() {
        let orders = [7.0, -1.0, 49.0, -5.0, 0.0];
        let component = |order: f64| Harmonic {
            order,
            amplitude: Complex64::from_polar(0.1, order),
        };
        let components = orders.map(component);
        for angle in [0.3, -2.0, 700.1] {
            let first = Complex64::from_polar(1.0, angle);
            let sum = powers(&in_order(components.to_vec()), first);
            let turned = |c: &Harmonic| c.amplitude * Complex64::from_polar(1.0, c.order * angle);
            let expected: Complex64 = components.iter().map(turned).sum();
            // Rounding of the angle 700 times 49.
            assert!((sum - expected).norm() < 1e-11, "{angle}: {sum} {expected}");
        }
    }
}
