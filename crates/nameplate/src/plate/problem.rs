//! Why no circuit follows from a plate.

/// What is missing on a plate, or cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Problem {
    /// Voltage is neither printed nor follows.
    #[error(
        "the voltage is missing: give the line voltage in V, or power, current, efficiency and power factor, from which it follows"
    )]
    NoVoltage,
    /// Power is neither printed nor follows.
    #[error("the power is missing: give it in kW or hp, or voltage and current together")]
    NoPower,
    /// Neither frequency nor speed.
    #[error(
        "the frequency is missing: give it in Hz, or the rated speed in rpm, from which 50 or 60 Hz follows"
    )]
    NoFrequency,
    /// The speed is synchronous or above.
    #[error(
        "a rated speed of {speed_rpm} rpm at {frequency_hz} Hz is no slip of an induction motor: the next synchronous speed is \
         {synchronous_rpm} rpm, a rated speed is 0.2 to 20 % below"
    )]
    NoSlip {
        /// The printed speed.
        speed_rpm: f64,
        /// The frequency.
        frequency_hz: f64,
        /// The synchronous speed nearest above.
        synchronous_rpm: f64,
    },
    /// A number outside its range.
    #[error("{name} = {value} is outside {low}..{high} {unit}")]
    Range {
        /// Key of the number.
        name: &'static str,
        /// The number.
        value: f64,
        /// Lowest possible.
        low: f64,
        /// Highest possible.
        high: f64,
        /// Unit.
        unit: &'static str,
    },
    /// Power does not come out of voltage and current.
    #[error(
        "power, voltage, current, efficiency and power factor contradict each other: sqrt(3) U I = {apparent_kva:.3} kVA cannot \
         give {power_kw:.3} kW; check the units, and whether current and voltage belong to the same connection"
    )]
    Apparent {
        /// Apparent power, kVA.
        apparent_kva: f64,
        /// Shaft power, kW.
        power_kw: f64,
    },
}
