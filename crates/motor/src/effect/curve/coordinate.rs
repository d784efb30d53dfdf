//! What a law depends on.

/// A quantity over which a curve is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Coordinate {
    /// Mechanical speed, rad/s.
    Speed,
    /// Shaft angle, rad, repeating every turn.
    Angle,
    /// Angle of the stator voltage vector, rad, repeating every turn.
    AngleElectrical,
    /// Slip frequency, Hz.
    Slip,
    /// Magnitude of the current vector, A peak: the stator's, at the rotor the rotor's.
    Current,
    /// Each phase's own current, A.
    PhaseCurrent,
    /// Magnitude of the air-gap flux linkage, V s peak.
    Flux,
    /// Supply frequency, Hz.
    Frequency,
    /// Magnitude of the stator voltage vector, V peak.
    Voltage,
    /// Time since the start of the recording, s.
    Time,
    /// Load torque, N m.
    LoadTorque,
}

impl Coordinate {
    /// All coordinates.
    pub const ALL: [Coordinate; 11] = [
        Coordinate::Speed,
        Coordinate::Angle,
        Coordinate::AngleElectrical,
        Coordinate::Slip,
        Coordinate::Current,
        Coordinate::PhaseCurrent,
        Coordinate::Flux,
        Coordinate::Frequency,
        Coordinate::Voltage,
        Coordinate::Time,
        Coordinate::LoadTorque,
    ];

    /// Name in motor files, commands and reports.
    pub fn name(self) -> &'static str {
        match self {
            Coordinate::Speed => "speed",
            Coordinate::Angle => "angle",
            Coordinate::AngleElectrical => "angle-electrical",
            Coordinate::Slip => "slip",
            Coordinate::Current => "current",
            Coordinate::PhaseCurrent => "phase-current",
            Coordinate::Flux => "flux",
            Coordinate::Frequency => "frequency",
            Coordinate::Voltage => "voltage",
            Coordinate::Time => "time",
            Coordinate::LoadTorque => "load-torque",
        }
    }

    /// The coordinate of this name.
    pub fn by_name(name: &str) -> Option<Coordinate> {
        let mut all = Coordinate::ALL.into_iter();
        all.find(|coordinate| coordinate.name() == name)
    }

    /// Unit as printed.
    pub fn unit(self) -> &'static str {
        match self {
            Coordinate::Speed => "rad/s",
            Coordinate::Angle | Coordinate::AngleElectrical => "rad",
            Coordinate::Slip | Coordinate::Frequency => "Hz",
            Coordinate::Current | Coordinate::PhaseCurrent => "A",
            Coordinate::Flux => "V s",
            Coordinate::Voltage => "V",
            Coordinate::Time => "s",
            Coordinate::LoadTorque => "N m",
        }
    }

    /// Key of the knots in a motor file.
    pub fn key(self) -> &'static str {
        match self {
            Coordinate::Speed => "knots_rad_s",
            Coordinate::Angle | Coordinate::AngleElectrical => "knots_rad",
            Coordinate::Slip | Coordinate::Frequency => "knots_hz",
            Coordinate::Current | Coordinate::PhaseCurrent => "knots_amp",
            Coordinate::Flux => "knots_volt_second",
            Coordinate::Voltage => "knots_volt",
            Coordinate::Time => "knots_s",
            Coordinate::LoadTorque => "knots_nm",
        }
    }

    /// Whether a curve over it repeats every turn.
    pub fn is_angle(self) -> bool {
        matches!(self, Coordinate::Angle | Coordinate::AngleElectrical)
    }

    /// Ends of a curve over it whose knots reach over `range`: over an angle the whole turn.
    pub fn ends(self, range: [f64; 2]) -> [f64; 2] {
        match self.is_angle() {
            true => [0.0, core::f64::consts::TAU],
            false => range,
        }
    }
}
