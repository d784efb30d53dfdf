//! What may be off, how far without being a fault, and which of it is one.

use monitor::{Cause, Phase, Uncertainty};

/// Quantities that may depart from what the monitor was told.
pub const UNKNOWNS: usize = 22;
/// Causes that are weighed against each other.
pub const HYPOTHESES: usize = 17;
/// Departures that act on the rotor flux, each with a flux of its own.
pub const FLUXES: usize = 11;

/// Places of the departures. Relative, unless said otherwise.
pub mod place {
    /// Stator resistance.
    pub const R_S: usize = 0;
    /// Rotor resistance.
    pub const R_R: usize = 1;
    /// Magnetizing inductance.
    pub const L_M: usize = 2;
    /// Both leakages.
    pub const LEAKAGE: usize = 3;
    /// Inertia.
    pub const INERTIA: usize = 4;
    /// Friction of motor and load.
    pub const FRICTION: usize = 5;
    /// Gain of voltage channel a; b and c follow.
    pub const VOLTAGE: usize = 6;
    /// Gain of current channel a; b and c follow.
    pub const CURRENT: usize = 9;
    /// Gain of the speed.
    pub const SPEED: usize = 12;
    /// Resistance in series with phase a, share of `R_s`; b and c follow.
    pub const SERIES: usize = 13;
    /// Gain of the torque channel.
    pub const TORQUE: usize = 16;
    /// Rotor resistance that grows with the slip, as deep bars have it.
    pub const SKIN: usize = 17;
    /// Leakage that falls at high current.
    pub const LEAKAGE_BEND: usize = 18;
    /// Saturation of the iron, absolute.
    pub const IRON: usize = 19;
    /// Time by which a speed channel is late, s.
    pub const SPEED_LAG: usize = 20;
    /// Both resistances together.
    pub const HEATING: usize = 21;
}

/// Departures of the rotor flux, in the order in which their fluxes are kept, with their places among all.
pub const FLUX_PLACES: [usize; FLUXES] = [
    place::R_R,
    place::L_M,
    place::LEAKAGE,
    place::SPEED,
    place::SKIN,
    place::LEAKAGE_BEND,
    place::IRON,
    place::CURRENT,
    place::CURRENT + 1,
    place::CURRENT + 2,
    place::SPEED_LAG,
];

/// Standard deviations of the departures of a healthy motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Priors(pub [f32; UNKNOWNS]);

/// What even a calibration leaves open in motion, where each parameter counts that rest does not show.
const LEAST: [f32; UNKNOWNS] = [
    0.02, 0.03, 0.01, 0.05, 0.2, 0.02, 0.003, 0.003, 0.003, 0.003, 0.003, 0.003, 1e-4, 0.003,
    0.003, 0.003, 0.005, 0.3, 0.25, 0.04, 0.0, 0.03,
];

/// What a tachometer's filter, a frequency counter or a drive's filter is late by, standard deviation, s: an encoder's count is
/// not late.
const LATE_SPEED: f32 = 0.01;

impl Priors {
    /// The same where the speed is a channel that shows rad/s, and not an encoder's count.
    pub fn with_speed_channel(mut self) -> Self {
        self.widen(place::SPEED_LAG, LATE_SPEED);
        self
    }

    /// From what a calibration left open.
    pub fn of(uncertainty: &Uncertainty) -> Self {
        let u = uncertainty;
        let known = [
            (place::R_S, u.stator_resistance),
            (place::R_R, u.rotor_resistance),
            (place::L_M, u.magnetizing_inductance),
            (place::LEAKAGE, u.leakage),
            (place::FRICTION, u.friction),
            (place::SPEED, u.speed),
            (place::HEATING, u.heating),
        ];
        let gains = (0..3).flat_map(|k| {
            [
                (place::VOLTAGE + k, u.voltage_gain),
                (place::CURRENT + k, u.current_gain),
            ]
        });
        let mut priors = Priors(LEAST);
        for (k, deviation) in known.into_iter().chain(gains) {
            priors.widen(k, deviation);
        }
        priors
    }

    /// By how much the speed may be late, standard deviation, s.
    pub fn late_s(&self) -> f32 {
        self.0.get(place::SPEED_LAG).copied().unwrap_or_default()
    }

    /// A departure is known no better than this.
    pub fn widen(&mut self, place: usize, deviation: f32) {
        if let Some(own) = self.0.get_mut(place) {
            *own = own.max(deviation);
        }
    }
}

/// One cause with the departures that it moves, all alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hypothesis {
    /// The cause.
    pub cause: Cause,
    /// First departure.
    pub first: usize,
    /// How many, from the first.
    pub count: usize,
}

const fn one(cause: Cause, first: usize) -> Hypothesis {
    let count = 1;
    Hypothesis {
        cause,
        first,
        count,
    }
}

const fn three(cause: Cause, first: usize) -> Hypothesis {
    let count = 3;
    Hypothesis {
        cause,
        first,
        count,
    }
}

/// Every cause that motion can tell.
pub const ALL: [Hypothesis; HYPOTHESES] = {
    use Phase::{A, B, C};
    [
        one(Cause::StatorResistance, place::R_S),
        one(Cause::RotorResistance, place::R_R),
        one(Cause::MagnetizingInductance, place::L_M),
        one(Cause::Leakage, place::LEAKAGE),
        one(Cause::Friction, place::FRICTION),
        one(Cause::VoltageChannel(A), place::VOLTAGE),
        one(Cause::VoltageChannel(B), place::VOLTAGE + 1),
        one(Cause::VoltageChannel(C), place::VOLTAGE + 2),
        three(Cause::AllVoltages, place::VOLTAGE),
        one(Cause::CurrentChannel(A), place::CURRENT),
        one(Cause::CurrentChannel(B), place::CURRENT + 1),
        one(Cause::CurrentChannel(C), place::CURRENT + 2),
        three(Cause::AllCurrents, place::CURRENT),
        one(Cause::SpeedGain, place::SPEED),
        one(Cause::SeriesResistance(A), place::SERIES),
        one(Cause::SeriesResistance(B), place::SERIES + 1),
        one(Cause::SeriesResistance(C), place::SERIES + 2),
    ]
};

impl Hypothesis {
    /// Sum of the departures that it moves.
    pub fn along(&self, of: &[f32; UNKNOWNS]) -> f32 {
        of.iter().skip(self.first).take(self.count).sum()
    }

    /// Adds its direction among the departures, each in units of its prior.
    pub fn add_direction(&self, sum: &mut [f32; UNKNOWNS]) {
        for x in sum.iter_mut().skip(self.first).take(self.count) {
            *x += 1.0;
        }
    }
}
