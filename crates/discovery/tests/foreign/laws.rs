//! Laws that no library holds, in the plant's own units.

use super::{Machine, U};
use discovery::LawReport;

/// A hidden law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// Friction that falls from rest (Stribeck), torque over speed.
    Stribeck,
    /// Torque three times a turn.
    Ripple,
    /// A pump that lifts from a speed on.
    Pump,
    /// A bearing that warms: friction over time.
    Bearing,
    /// Current displacement in the stator: resistance over frequency.
    Displacement,
    /// An odd magnetizing curve.
    Magnetizing,
    /// A worn contact in phase b: drop over the phase's current.
    Contact,
    /// An eccentric speed disc.
    Disc,
    /// A piston: half a sine each turn.
    Piston,
    /// Rotor resistance over slip.
    Bars,
    /// Leakage over current.
    Leakage,
    /// A gear whose loss sets in above a load.
    Gear,
    /// A contact of phase c that ages within seconds.
    Ageing,
    /// A brake that drags for a while.
    Brake,
    /// A current channel that saturates.
    Saturating,
    /// Two jaws: twice and four times a turn.
    Jaws,
    /// A contact of phase b that opens and closes.
    Intermittent,
    /// A brake that sticks now and then.
    Sticking,
    /// A frame that shakes at one speed.
    Resonance,
}

/// Something that comes at about every `every` seconds for 10 to 60 ms, 0.33 to 1 of its full size.
fn comes_and_goes(t: f64, every: f64) -> f64 {
    let k = (t / every).floor();
    let random = |n: f64| (((k + 1.0) * n).sin() * 43_758.545_3).rem_euclid(1.0);
    let from = every * (k + 0.1 + 0.5 * random(12.9898));
    let length = 0.01 + 0.05 * random(78.233);
    let there = (from..from + length).contains(&t);
    f64::from(u8::from(there)) * (1.0 + 2.0 * random(37.719)) / 3.0
}

/// What a law depends on.
#[derive(Clone, Copy, Debug)]
pub struct Where {
    pub t: f64,
    pub speed: f64,
    pub theta: f64,
    pub load: f64,
}

impl Law {
    /// Those of the evidence table.
    pub const ALL: [Law; 18] = [
        Law::Stribeck,
        Law::Ripple,
        Law::Pump,
        Law::Bearing,
        Law::Displacement,
        Law::Magnetizing,
        Law::Contact,
        Law::Disc,
        Law::Piston,
        Law::Bars,
        Law::Leakage,
        Law::Gear,
        Law::Ageing,
        Law::Brake,
        Law::Saturating,
        Law::Jaws,
        Law::Intermittent,
        Law::Sticking,
    ];

    /// Place and coordinate as reports name them.
    pub fn truth(self) -> (&'static str, &'static str) {
        match self {
            Law::Stribeck | Law::Pump | Law::Resonance => ("torque", "speed"),
            Law::Ripple | Law::Piston | Law::Jaws => ("torque", "angle"),
            Law::Bearing | Law::Brake | Law::Sticking => ("torque", "time"),
            Law::Displacement => ("stator", "frequency"),
            Law::Magnetizing => ("magnetizing", "flux"),
            Law::Contact => ("stator-phase-b", "current"),
            Law::Disc => ("sensor-speed", "angle"),
            Law::Bars => ("rotor", "slip"),
            Law::Leakage => ("leakage", "current"),
            Law::Gear => ("torque", "load-torque"),
            Law::Ageing => ("stator-phase-c", "time"),
            Law::Saturating => ("sensor-ia", "current"),
            Law::Intermittent => ("stator-phase-b", "time"),
        }
    }

    /// Whether a report names the law, alone or among ties that it declares.
    pub fn is_named(self, law: &LawReport) -> bool {
        let is = |place: &str, coordinate: &str| (place, coordinate) == self.truth();
        let tied = law.tied_with.iter();
        is(&law.place, &law.coordinate) || tied.into_iter().any(|t| is(&t.place, &t.coordinate))
    }

    /// Effects of the library at the same place over the same coordinate.
    pub fn library_names(self) -> &'static [&'static str] {
        match self {
            Law::Stribeck | Law::Pump => &["coulomb-friction", "windage"],
            Law::Ripple | Law::Jaws | Law::Piston => &["load-pulsation"],
            Law::Magnetizing => &["magnetizing-saturation"],
            Law::Leakage => &["leakage-saturation"],
            Law::Bars => &["deep-bar"],
            Law::Disc => &["speed-ripple"],
            Law::Gear => &["load-gain"],
            _ => &[],
        }
    }

    /// Shapes of the dictionary that are the law's own; empty: the dictionary does not hold it.
    pub fn shapes(self) -> &'static [&'static str] {
        match self {
            Law::Stribeck => &["Stribeck", "Stribeck and linear"],
            Law::Ripple => &["harmonic", "two harmonics"],
            Law::Jaws | Law::Disc => &["two harmonics"],
            Law::Pump => &["power beyond a place"],
            Law::Bearing => &["exponential", "constant and exponential"],
            Law::Displacement => &["power", "constant and power"],
            Law::Contact => &["x/(|x|+w)"],
            Law::Piston => &["half sine"],
            Law::Bars => &["saturating exponential", "constant and exponential"],
            Law::Leakage => &["x2/(x2+w2)"],
            Law::Gear => &["hinge"],
            Law::Ageing => &["step", "tanh"],
            Law::Brake | Law::Resonance => &["bump"],
            Law::Saturating => &["quadratic"],
            Law::Magnetizing | Law::Intermittent | Law::Sticking => &[],
        }
    }

    /// Torque that brakes the shaft, N m.
    pub fn torque(self, m: &Machine, at: Where) -> f64 {
        let w = at.speed / m.speed();
        let share = match self {
            Law::Stribeck => {
                (w / 0.01).tanh() * (0.05 + 0.05 * (-(w.abs() / 0.14).powf(1.3)).exp())
            }
            Law::Ripple => 0.05 * (3.0 * at.theta).cos() + 0.03 * (3.0 * at.theta).sin(),
            Law::Pump => 0.25 * ((w - 0.45).max(0.0) / 0.57).powf(2.6),
            Law::Resonance => 0.2 * (-((w - 0.7) / 0.06).powi(2)).exp(),
            Law::Bearing => 0.06 * (-at.t / 1.6).exp() * (w / 0.01).tanh(),
            Law::Piston => 0.18 * at.theta.sin().max(0.0),
            Law::Gear => 0.2 * (at.load / m.torque - 0.55).max(0.0),
            Law::Brake => 0.08 * (-0.5 * ((at.t - 3.2) / 0.35).powi(2)).exp(),
            Law::Sticking => 0.3 * comes_and_goes(at.t, 0.5) * (w / 0.01).tanh(),
            Law::Jaws => 0.04 * (2.0 * at.theta).cos() + 0.03 * (4.0 * at.theta + 1.0).cos(),
            _ => 0.0,
        };
        share * m.torque
    }

    /// Factor on the stator resistance at a frequency, Hz.
    pub fn stator(self, hz: f64) -> f64 {
        match self {
            Law::Displacement => 1.0 + 0.35 * (hz / 50.0).powf(1.5),
            _ => 1.0,
        }
    }

    /// Drops of the phases, V.
    pub fn drops(self, m: &Machine, i: [f64; 3], t: f64) -> [f64; 3] {
        let [_, b, c] = i;
        match self {
            Law::Contact => [0.0, 0.016 * U * b / (b.abs() + 0.1 * m.current), 0.0],
            Law::Intermittent => [0.0, 9.0 * m.r_s * comes_and_goes(t, 0.2) * b, 0.0],
            Law::Ageing => {
                let more = 0.4 / (1.0 + (-(t - 2.8) / 0.12).exp());
                [0.0, 0.0, more * m.r_s * c]
            }
            _ => [0.0; 3],
        }
    }

    /// Factor on the rotor resistance at a slip frequency, Hz.
    pub fn rotor(self, slip_hz: f64) -> f64 {
        match self {
            Law::Bars => 1.0 + 0.5 * (1.0 - (-slip_hz.abs() / 4.0).exp()),
            _ => 1.0,
        }
    }

    /// Factor on the magnetizing current at a flux over rated flux.
    pub fn magnetizing(self, x: f64) -> f64 {
        match self {
            Law::Magnetizing => {
                let knee = 0.25 / (1.0 + (-(x - 0.82) / 0.05).exp());
                1.0 + knee - 0.12 * (-((x - 0.45) / 0.12).powi(2)).exp()
            }
            _ => 1.0,
        }
    }

    /// Factor on the leakages at a stator current, A.
    pub fn leakage(self, m: &Machine, i: f64) -> f64 {
        match self {
            Law::Leakage => {
                let x = i / (1.3 * m.current * 2f64.sqrt());
                1.0 - 0.35 * x * x / (x * x + 1.0)
            }
            _ => 1.0,
        }
    }

    /// Factor on the reading of current channel a.
    pub fn channel_a(self, m: &Machine, i: f64) -> f64 {
        match self {
            Law::Saturating => 1.0 - 0.1 * (i / (4.0 * m.current)).powi(2).min(1.0),
            _ => 1.0,
        }
    }

    /// Factor on the reading of the speed channel.
    pub fn speed(self, theta: f64) -> f64 {
        match self {
            Law::Disc => 1.0 + 0.004 * (theta + 0.4).cos() + 0.0015 * (2.0 * theta).cos(),
            _ => 1.0,
        }
    }
}
