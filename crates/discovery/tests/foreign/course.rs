//! What the supply and the load do.

use super::{Machine, OMEGA, U};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Load, voltage and switch as functions of time.
#[derive(Clone, Copy, Debug)]
pub struct Course {
    /// (time, load in share of rated torque, voltage or frequency in share of rated), each until the next.
    pub steps: &'static [(f64, f64, f64)],
    /// Time at which the supply is cut, s.
    pub cut: f64,
    /// Start of the recording, s.
    pub from: f64,
    /// End of the recording, s.
    pub end: f64,
    /// Time over which an inverter changes its frequency from zero to rated, s; 0: grid.
    pub ramp: f64,
    /// (time, factor on the voltage), straight lines between; empty: one.
    pub volts: &'static [(f64, f64)],
}

const GRID: Course = Course {
    steps: &[],
    cut: 99.0,
    from: 0.0,
    end: 3.2,
    ramp: 0.0,
    volts: &[],
};

/// Start, loads and voltages.
pub const LOADS: Course = Course {
    steps: &[
        (0.0, 0.0, 1.0),
        (0.6, 0.5, 1.0),
        (1.1, 1.0, 1.0),
        (1.6, 0.2, 1.1),
        (2.1, 0.5, 0.85),
        (2.6, 0.8, 1.0),
    ],
    ..GRID
};
/// Another order, and a coast-down.
pub const COAST: Course = Course {
    steps: &[
        (0.0, 0.3, 1.0),
        (0.7, 0.0, 0.9),
        (1.2, 0.7, 1.1),
        (1.7, 1.0, 0.95),
        (2.2, 0.0, 1.0),
    ],
    cut: 2.5,
    end: 3.5,
    ..GRID
};
/// Another start and other loads and voltages, no coast-down.
pub const STEPS: Course = Course {
    steps: &[
        (0.0, 0.2, 0.95),
        (0.7, 0.9, 1.05),
        (1.3, 0.0, 1.1),
        (1.9, 0.6, 0.9),
        (2.5, 1.0, 1.0),
    ],
    ..GRID
};
/// One steady load.
pub const STEADY: Course = Course {
    steps: &[(0.0, 0.0, 1.0), (0.9, 0.75, 1.0)],
    from: 1.9,
    end: 4.4,
    ..GRID
};
/// A drive with constant volts per hertz.
pub const INVERTER: Course = Course {
    steps: &[
        (0.0, 0.1, 0.8),
        (0.9, 0.6, 0.8),
        (1.4, 1.0, 0.6),
        (2.0, 0.3, 1.0),
        (2.7, 0.8, 1.0),
    ],
    ramp: 0.5,
    ..GRID
};
/// The same drive in another order.
pub const INVERTER_B: Course = Course {
    steps: &[
        (0.0, 0.3, 1.0),
        (0.9, 0.9, 1.0),
        (1.5, 0.2, 0.5),
        (2.1, 0.7, 0.7),
        (2.7, 0.0, 0.9),
    ],
    ramp: 0.4,
    ..GRID
};

/// A drive that visits many speeds, loads and fluxes ...
pub const DRIVE: Course = Course {
    steps: &[
        (0.0, 0.1, 1.0),
        (1.4, 0.7, 1.0),
        (1.9, 1.0, 1.0),
        (2.2, 0.3, 0.6),
        (2.8, 0.8, 0.6),
        (3.3, 0.2, 1.2),
        (4.0, 0.6, 1.2),
        (4.4, 0.1, 0.24),
        (5.2, 0.5, 0.24),
        (5.6, 0.9, 0.24),
    ],
    end: 6.0,
    ramp: 1.2,
    volts: &[
        (0.0, 1.0),
        (1.7, 1.0),
        (1.8, 0.8),
        (2.1, 0.8),
        (2.2, 1.08),
        (3.0, 1.08),
        (3.2, 0.9),
        (4.0, 1.0),
        (5.3, 1.0),
        (5.5, 0.85),
    ],
    ..GRID
};
/// ... and in another order.
pub const DRIVE_B: Course = Course {
    steps: &[
        (0.0, 0.05, 0.7),
        (1.1, 0.9, 0.7),
        (1.6, 0.4, 0.7),
        (1.8, 0.4, 1.16),
        (2.5, 0.5, 1.16),
        (2.8, 0.15, 1.16),
        (3.0, 0.15, 0.4),
        (3.6, 0.75, 0.4),
        (4.0, 0.3, 0.4),
        (4.2, 0.3, 1.0),
        (5.0, 1.0, 1.0),
        (5.4, 0.6, 1.0),
    ],
    end: 6.0,
    ramp: 1.0,
    volts: &[
        (0.0, 1.0),
        (1.2, 1.0),
        (1.3, 1.08),
        (2.0, 0.9),
        (2.6, 1.0),
        (3.8, 0.85),
        (4.1, 1.08),
        (5.1, 1.05),
        (5.3, 0.85),
    ],
    ..GRID
};

impl Course {
    /// Factor on the voltage.
    fn volt(&self, t: f64) -> f64 {
        let after = self.volts.partition_point(|v| v.0 <= t);
        match (
            after.checked_sub(1).map(|k| self.volts[k]),
            self.volts.get(after),
        ) {
            (None, _) => self.volts.first().map_or(1.0, |v| v.1),
            (Some(before), None) => before.1,
            (Some((t0, a)), Some(&(t1, b))) => a + (b - a) * (t - t0) / (t1 - t0),
        }
    }

    fn level(&self, t: f64) -> (f64, f64, f64) {
        let mut past = self.steps.iter().rev();
        *past.find(|x| x.0 <= t + 1e-9).unwrap()
    }

    /// Whether the motor is connected.
    pub fn is_on(&self, t: f64) -> bool {
        t < self.cut
    }

    /// Torque of the brake, N m.
    pub fn load(&self, t: f64, machine: &Machine) -> f64 {
        let share = if self.is_on(t) { self.level(t).1 } else { 0.0 };
        machine.torque * share
    }
}

/// The voltage vector, followed through time.
#[derive(Clone, Copy, Debug)]
pub struct Source {
    frequency: f64,
    angle: f64,
}

impl Source {
    pub fn new() -> Self {
        Self {
            frequency: 0.0,
            angle: 0.3,
        }
    }

    /// Grid voltage at time `t`, V.
    pub fn grid(course: &Course, t: f64) -> Complex64 {
        Complex64::from_polar(U * course.level(t).2, OMEGA * t + 0.3)
    }

    /// Frequency that an inverter has reached, Hz; 50 on the grid.
    pub fn hertz(&self, course: &Course) -> f64 {
        match course.ramp > 0.0 {
            true => self.frequency,
            false => 50.0,
        }
    }

    /// Voltage that an inverter commands for the next `step` seconds, V.
    pub fn commanded(&mut self, course: &Course, t: f64, step: f64) -> Complex64 {
        let wanted = 50.0 * course.level(t).2;
        let most = 50.0 * step / course.ramp;
        self.frequency += (wanted - self.frequency).clamp(-most, most);
        // 4 % of rated voltage lift the flux at low speed.
        let amplitude = course.volt(t) * U * (0.04 + 0.96 * self.frequency.min(52.0) / 50.0);
        let u = Complex64::from_polar(amplitude, self.angle);
        self.angle += TAU * self.frequency * step;
        u
    }
}
