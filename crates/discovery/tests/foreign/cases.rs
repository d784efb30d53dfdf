//! What is hidden, with sizes drawn around typical ones.

use super::Hidden;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

/// A hidden effect under the name that the library gives it.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    pub name: &'static str,
    pub hidden: Hidden,
    /// Only behind an inverter.
    pub inverter: bool,
}

/// Sizes of one seed.
struct Draw(Pcg64);

impl Draw {
    /// 0.7 to 1.3 times `typical`.
    fn positive(&mut self, typical: f64) -> f64 {
        typical * self.0.random_range(0.7..1.3)
    }

    /// The same of either sign.
    fn signed(&mut self, typical: f64) -> f64 {
        let size = self.positive(typical);
        if self.0.random() { size } else { -size }
    }
}

/// Every single effect.
pub fn single(seed: u64) -> Vec<Case> {
    let mut d = Draw(Pcg64::seed_from_u64(seed.wrapping_mul(7919)));
    let mut all = Vec::new();
    let mut add = |name, set: &dyn Fn(&mut Hidden, &mut Draw), inverter| {
        let mut hidden = Hidden::default();
        set(&mut hidden, &mut d);
        all.push(Case {
            name,
            hidden,
            inverter,
        });
    };
    add(
        "magnetizing-saturation",
        &|h, d| h.saturation = d.positive(0.15),
        false,
    );
    add(
        "leakage-saturation",
        &|h, d| h.leakage = d.positive(0.3),
        false,
    );
    add("deep-bar", &|h, d| h.cage = d.positive(0.9), false);
    add("core-loss", &|h, d| h.core = d.positive(0.05), false);
    add(
        "stator-heating",
        &|h, d| h.stator_rise = d.positive(0.2),
        false,
    );
    add(
        "rotor-heating",
        &|h, d| h.rotor_rise = d.positive(0.2),
        false,
    );
    add(
        "coulomb-friction",
        &|h, d| h.coulomb = d.positive(0.05),
        false,
    );
    add("windage", &|h, d| h.windage = d.positive(0.1), false);
    add(
        "load-pulsation",
        &|h, d| h.pulsation = d.positive(0.05),
        false,
    );
    add(
        "shaft-compliance",
        &|h, d| h.torsion_hz = d.positive(40.0),
        false,
    );
    add(
        "stator-asymmetry",
        &|h, d| h.phase_b = d.positive(0.2),
        false,
    );
    add(
        "rotor-asymmetry",
        &|h, d| h.rotor_bar = d.positive(0.05),
        false,
    );
    add(
        "inverter-dead-time",
        &|h, d| h.dead_time = d.positive(0.015),
        true,
    );
    add("dc-link", &|h, d| h.droop = d.positive(0.03), true);
    add(
        "phase-voltage-gain",
        &|h, d| h.gain_vc = d.signed(0.02),
        false,
    );
    add(
        "phase-current-gain",
        &|h, d| h.gain_ia = d.signed(0.03),
        false,
    );
    add("current-gain", &|h, d| h.gain_i = d.signed(0.03), false);
    add("load-gain", &|h, d| h.gain_torque = d.signed(0.03), false);
    add(
        "current-offset",
        &|h, d| h.offset_ib = d.signed(0.04),
        false,
    );
    add("sample-delay", &|h, d| h.delay = d.positive(1.5e-4), false);
    add(
        "speed-scale",
        &|h, d| h.speed_scale = d.signed(0.006),
        false,
    );
    add(
        "speed-ripple",
        &|h, d| h.speed_ripple = d.positive(0.008),
        false,
    );
    add(
        "speed-delay",
        &|h, d| h.speed_delay = d.positive(3e-3),
        false,
    );
    add("load-delay", &|h, d| h.load_delay = d.positive(6e-3), false);
    all
}

/// Two at once.
pub fn double(seed: u64) -> Vec<([&'static str; 2], Hidden)> {
    let mut d = Draw(Pcg64::seed_from_u64(seed.wrapping_mul(6007)));
    let mut all = Vec::new();
    let mut add = |names, set: &dyn Fn(&mut Hidden, &mut Draw)| {
        let mut hidden = Hidden::default();
        set(&mut hidden, &mut d);
        all.push((names, hidden));
    };
    add(["magnetizing-saturation", "phase-voltage-gain"], &|h, d| {
        (h.saturation, h.gain_vc) = (d.positive(0.15), d.signed(0.02));
    });
    add(["shaft-compliance", "rotor-heating"], &|h, d| {
        (h.torsion_hz, h.rotor_rise) = (d.positive(50.0), d.positive(0.2));
    });
    add(["load-pulsation", "current-offset"], &|h, d| {
        (h.pulsation, h.offset_ib) = (d.positive(0.05), d.signed(0.04));
    });
    add(["core-loss", "rotor-asymmetry"], &|h, d| {
        (h.core, h.rotor_bar) = (d.positive(0.05), d.positive(0.05));
    });
    add(["windage", "stator-asymmetry"], &|h, d| {
        (h.windage, h.phase_b) = (d.positive(0.1), d.positive(0.2));
    });
    add(["coulomb-friction", "speed-scale"], &|h, d| {
        (h.coulomb, h.speed_scale) = (d.positive(0.05), d.signed(0.006));
    });
    all
}
