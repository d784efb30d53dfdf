//! Where a law acts.

use super::Coordinate;
use crate::effect::{Kind, Scale};

/// A place in the equations of the motor or in an instrument.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Place {
    /// Torque that brakes the shaft, N m, added to the load.
    Torque,
    /// Torque against the direction of motion, N m: friction that changes.
    Friction,
    /// Stator circuit of all phases.
    Stator,
    /// Stator circuit of phase a.
    StatorPhaseA,
    /// Stator circuit of phase b.
    StatorPhaseB,
    /// Stator circuit of phase c.
    StatorPhaseC,
    /// Rotor resistance.
    Rotor,
    /// Magnetizing current at a given flux.
    Magnetizing,
    /// Both leakage inductances.
    Leakage,
    /// Gain of the speed channel.
    SensorSpeed,
    /// Gain of current channel a.
    SensorIa,
    /// Gain of current channel b.
    SensorIb,
    /// Gain of current channel c.
    SensorIc,
}

/// What the values of a curve are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantity {
    /// Unit as printed.
    pub unit: &'static str,
    /// Key of the values in a motor file.
    pub key: &'static str,
    /// Unit of `typical`.
    pub scale: Scale,
    /// Size at which a person would call it ordinary.
    pub typical: f64,
}

const fn relative(typical: f64) -> Quantity {
    Quantity {
        unit: "-",
        key: "values_relative",
        scale: Scale::Own,
        typical,
    }
}

const TORQUE: Quantity = Quantity {
    unit: "N m",
    key: "values_nm",
    scale: Scale::Torque,
    typical: 0.03,
};
/// A drop of 2 V on a motor of 400 V.
const DROP: Quantity = Quantity {
    unit: "V",
    key: "values_volt",
    scale: Scale::Voltage,
    typical: 0.006,
};

impl Place {
    /// All places.
    pub const ALL: [Place; 13] = [
        Place::Torque,
        Place::Friction,
        Place::Stator,
        Place::StatorPhaseA,
        Place::StatorPhaseB,
        Place::StatorPhaseC,
        Place::Rotor,
        Place::Magnetizing,
        Place::Leakage,
        Place::SensorSpeed,
        Place::SensorIa,
        Place::SensorIb,
        Place::SensorIc,
    ];

    /// Name in motor files, commands and reports.
    pub fn name(self) -> &'static str {
        match self {
            Place::Torque => "torque",
            Place::Friction => "friction",
            Place::Stator => "stator",
            Place::StatorPhaseA => "stator-phase-a",
            Place::StatorPhaseB => "stator-phase-b",
            Place::StatorPhaseC => "stator-phase-c",
            Place::Rotor => "rotor",
            Place::Magnetizing => "magnetizing",
            Place::Leakage => "leakage",
            Place::SensorSpeed => "sensor-speed",
            Place::SensorIa => "sensor-ia",
            Place::SensorIb => "sensor-ib",
            Place::SensorIc => "sensor-ic",
        }
    }

    /// The reading whose error acts here, 0 to 2 the currents, 3 the speed; `None` inside the motor.
    pub fn reading(self) -> Option<usize> {
        match self {
            Place::SensorIa => Some(0),
            Place::SensorIb => Some(1),
            Place::SensorIc => Some(2),
            Place::SensorSpeed => Some(3),
            _ => None,
        }
    }

    /// The place of this name.
    pub fn by_name(name: &str) -> Option<Place> {
        Place::ALL.into_iter().find(|place| place.name() == name)
    }

    /// What the values mean, for a person.
    pub fn meaning(self, coordinate: Coordinate) -> &'static str {
        match self {
            Place::Torque => "braking torque",
            Place::Friction => "friction torque",
            Place::Stator if coordinate == Coordinate::PhaseCurrent => "drop of each phase",
            Place::Stator => "change of resistance",
            Place::StatorPhaseA | Place::StatorPhaseB | Place::StatorPhaseC => {
                match coordinate == Coordinate::PhaseCurrent {
                    true => "drop in this phase",
                    false => "change of resistance",
                }
            }
            Place::Rotor => "change of resistance",
            Place::Magnetizing => "change of current",
            Place::Leakage => "change of inductance",
            Place::SensorSpeed | Place::SensorIa | Place::SensorIb | Place::SensorIc => {
                "error of the reading"
            }
        }
    }

    /// Quantity of the values over `coordinate`.
    pub fn quantity(self, coordinate: Coordinate) -> Quantity {
        match self {
            Place::Torque | Place::Friction => TORQUE,
            Place::Stator | Place::StatorPhaseA | Place::StatorPhaseB | Place::StatorPhaseC => {
                match coordinate == Coordinate::PhaseCurrent {
                    true => DROP,
                    false => relative(0.2),
                }
            }
            Place::Rotor | Place::Magnetizing | Place::Leakage => relative(0.2),
            Place::SensorSpeed => relative(0.003),
            Place::SensorIa | Place::SensorIb | Place::SensorIc => relative(0.02),
        }
    }

    /// Kind of answer that a law at this place is.
    pub fn kind(self) -> Kind {
        match self {
            Place::SensorSpeed | Place::SensorIa | Place::SensorIb | Place::SensorIc => {
                Kind::Sensor
            }
            _ => Kind::Physics,
        }
    }

    /// Index of the phase that the place belongs to, for places of one phase.
    pub fn phase(self) -> Option<usize> {
        match self {
            Place::StatorPhaseA | Place::SensorIa => Some(0),
            Place::StatorPhaseB | Place::SensorIb => Some(1),
            Place::StatorPhaseC | Place::SensorIc => Some(2),
            _ => None,
        }
    }

    /// Coordinates over which a law can act here.
    pub fn coordinates(self) -> &'static [Coordinate] {
        use Coordinate::*;
        match self {
            Place::Torque => &[
                Speed,
                Angle,
                AngleElectrical,
                Slip,
                Current,
                Flux,
                Frequency,
                Voltage,
                Time,
                LoadTorque,
            ],
            Place::Friction => &[Time],
            Place::Stator => &[PhaseCurrent, Current, Time, Slip, Frequency, Speed, Voltage],
            Place::StatorPhaseA | Place::StatorPhaseB | Place::StatorPhaseC => {
                &[PhaseCurrent, Angle, Time, Speed]
            }
            Place::Rotor => &[Slip, Current, Time, Flux, Frequency, Speed],
            Place::Magnetizing => &[Flux, Time, Frequency],
            Place::Leakage => &[Current, Slip, Time],
            Place::SensorSpeed => &[Angle, Speed, Time],
            Place::SensorIa | Place::SensorIb | Place::SensorIc => &[PhaseCurrent, Time],
        }
    }
}
