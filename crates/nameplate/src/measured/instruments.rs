//! What the instruments of a test bench may be off by.

/// Limits of error; a limit counts as a rectangular distribution (GUM: standard deviation a limit over sqrt(3)).
///
/// The defaults: IEC 60034-2-1 asks for instruments of class 0.2, IEEE 112 (method B) for a speed to 1 rpm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instruments {
    /// Voltage, percent of the reading.
    pub voltage_percent: f64,
    /// Current, percent of the reading.
    pub current_percent: f64,
    /// Power, percent of the apparent power: of its gain, and of its angle.
    pub power_percent: f64,
    /// Torque, percent of the reading.
    pub torque_percent: f64,
    /// Resistance, percent of the reading.
    pub resistance_percent: f64,
    /// Speed, rpm.
    pub speed_rpm: f64,
    /// Temperature of the winding, K.
    pub temperature_kelvin: f64,
}

impl Default for Instruments {
    fn default() -> Instruments {
        Instruments {
            voltage_percent: 0.2,
            current_percent: 0.2,
            power_percent: 0.2,
            torque_percent: 0.2,
            resistance_percent: 0.2,
            speed_rpm: 1.0,
            temperature_kelvin: 2.0,
        }
    }
}

/// Standard deviation of a limit of error.
pub(super) fn deviation(limit: f64) -> f64 {
    limit / 3f64.sqrt()
}

/// The same of a limit in percent, as a share.
pub(super) fn share(percent: f64) -> f64 {
    deviation(percent / 100.0)
}
