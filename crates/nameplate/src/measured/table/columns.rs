//! Columns of the table, their units and ranges.

/// How many quantities a row may have.
pub const COLUMNS: usize = 10;

/// A measured quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Column {
    /// Between lines, V rms, mean of the three.
    Voltage,
    /// Hz.
    Frequency,
    /// Line current, A rms, mean of the three.
    Current,
    /// Input of all three phases, W.
    Power,
    /// rpm.
    Speed,
    /// At the shaft, N m.
    Torque,
    /// At the shaft, W.
    ShaftPower,
    /// Of the winding, degC.
    Temperature,
    /// Between two terminals, ohm.
    Resistance,
    /// s.
    Time,
}

/// A name of a column: the quantity, the factor to SI, lowest and highest value in the column's own unit.
pub(super) struct Name {
    pub name: &'static str,
    pub column: Column,
    pub factor: f64,
    pub range: [f64; 2],
}

const fn name(name: &'static str, column: Column, factor: f64, range: [f64; 2]) -> Name {
    Name {
        name,
        column,
        factor,
        range,
    }
}

/// Every name that a header may have beside `test` and `remark`.
pub(super) const NAMES: [Name; 12] = [
    name("voltage_volt", Column::Voltage, 1.0, [0.1, 3e4]),
    name("frequency_hz", Column::Frequency, 1.0, [1.0, 1000.0]),
    name("current_amp", Column::Current, 1.0, [1e-3, 1e5]),
    name("power_kw", Column::Power, 1000.0, [1e-6, 1e5]),
    name("power_watt", Column::Power, 1.0, [1e-3, 1e8]),
    name("speed_rpm", Column::Speed, 1.0, [0.0, 6e4]),
    name("torque_nm", Column::Torque, 1.0, [1e-4, 1e7]),
    name("shaft_power_kw", Column::ShaftPower, 1000.0, [1e-6, 1e5]),
    name("shaft_power_watt", Column::ShaftPower, 1.0, [1e-3, 1e8]),
    name("temperature_degc", Column::Temperature, 1.0, [-50.0, 250.0]),
    name("resistance_ohm", Column::Resistance, 1.0, [1e-6, 1e5]),
    name("time_s", Column::Time, 1.0, [0.0, 1e6]),
];
