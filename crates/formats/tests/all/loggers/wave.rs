//! One simulated run, which every device records.

use std::f64::consts::TAU;

/// What a device sees at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Instant {
    pub k: u32,
    pub t: f64,
    pub v: [f64; 3],
    pub i: [f64; 3],
    pub speed: f64,
    pub torque: f64,
}

impl Instant {
    /// Line voltages v_ab, v_bc, v_ca.
    pub fn line(&self) -> [f64; 3] {
        let [a, b, c] = self.v;
        [a - b, b - c, c - a]
    }
}

/// Instants of a 2.2 kW motor at 400 V and 50 Hz whose load is let go: the currents fall, the shaft speeds up.
pub fn wave(step_s: f64, count: u32) -> Vec<Instant> {
    (0..count)
        .map(|k| instant(k, f64::from(k) * step_s))
        .collect()
}

fn instant(k: u32, t: f64) -> Instant {
    let phase = |x: f64| [0.0, -TAU / 3.0, TAU / 3.0].map(|shift| x + shift);
    let load = (-t / 0.03).exp();
    let v = phase(TAU * 50.0 * t + 0.4).map(|angle| 326.6 * angle.cos());
    let i = phase(TAU * 50.0 * t - 0.9 + 0.4 * load).map(|angle| (3.1 + 3.6 * load) * angle.cos());
    Instant {
        k,
        t,
        v,
        i,
        speed: 156.7 - 6.8 * load,
        torque: 14.1 * load,
    }
}
