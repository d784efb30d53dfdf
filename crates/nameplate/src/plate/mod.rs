//! What the plate or a catalogue's row prints, and what follows from it.

mod code_letter;
mod completed;
mod file;
mod printed;
mod problem;
mod question;
mod synchronous;
mod values;

pub use completed::Completed;
pub use file::{EXTRA_KEYS, HORSEPOWER_KW, PlateFile};
pub use printed::{NotANumber, Printed};
pub use problem::Problem;
pub use question::{Printing, QUESTIONS, Question};
pub use values::{VALUES, Value, Values};

/// A plate: every number may be missing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Plate {
    /// Rated shaft power, kW.
    pub power_kw: Option<Printed>,
    /// Rated line voltage, V rms.
    pub voltage_volt: Option<Printed>,
    /// Rated frequency, Hz.
    pub frequency_hz: Option<Printed>,
    /// Rated speed, rpm.
    pub speed_rpm: Option<Printed>,
    /// Efficiency at rated load, percent.
    pub efficiency_percent: Option<Printed>,
    /// Power factor at rated load, 0..1.
    pub power_factor: Option<Printed>,
    /// Rated line current, A rms.
    pub current_amp: Option<Printed>,
    /// Breakdown torque over rated torque.
    pub breakdown_torque_ratio: Option<Printed>,
    /// Locked-rotor torque over rated torque.
    pub locked_rotor_torque_ratio: Option<Printed>,
    /// Locked-rotor current over rated current.
    pub locked_rotor_current_ratio: Option<Printed>,
    /// Resistance measured between two terminals with direct current.
    pub dc_resistance: Option<DcResistance>,
}

/// A winding's resistance, measured with direct current.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DcResistance {
    /// Between two terminals, ohm, the mean of all three pairs.
    pub terminals_ohm: f64,
    /// Temperature of the winding, degC.
    pub winding_degc: f64,
}

/// Temperature at which copper would have no resistance, degC below zero (IEC 60034-1).
const COPPER_DEGC: f64 = 235.0;
/// Temperature of a winding at rated load: a rise of 80 K, class B, above 20 degC.
const WARM_DEGC: f64 = 100.0;

impl DcResistance {
    /// Of an equivalent star phase, warm from rated load, ohm: half of that between two terminals, in star as in delta.
    pub fn warm_phase_ohm(&self) -> f64 {
        0.5 * self.terminals_ohm * (COPPER_DEGC + WARM_DEGC) / (COPPER_DEGC + self.winding_degc)
    }
}

impl Plate {
    /// The numbers in the order of [`crate::COLUMN_KEYS`].
    pub fn numbers(&self) -> [Option<Printed>; crate::COLUMNS] {
        let mut copy = *self;
        copy.places().map(|place| *place)
    }

    /// The places of the numbers in the order of [`crate::COLUMN_KEYS`].
    pub fn places(&mut self) -> [&mut Option<Printed>; crate::COLUMNS] {
        [
            &mut self.power_kw,
            &mut self.voltage_volt,
            &mut self.frequency_hz,
            &mut self.speed_rpm,
            &mut self.efficiency_percent,
            &mut self.power_factor,
            &mut self.current_amp,
            &mut self.breakdown_torque_ratio,
            &mut self.locked_rotor_torque_ratio,
            &mut self.locked_rotor_current_ratio,
        ]
    }
}
