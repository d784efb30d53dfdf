//! Places of a board's lamps, in the order of its register `Lamps`.

/// Voltage is there, the board judges or waits to.
pub const RUN: u32 = 0;
/// r1, the first of four.
pub const RESIDUALS: u32 = 1;
/// An instrument is faulty.
pub const SENSOR: u32 = 5;
/// The supply is out of range, or unbalanced.
pub const LINE: u32 = 6;
/// The load is beyond the rated torque, or changes.
pub const LOAD: u32 = 7;
/// A fault.
pub const FAULT: u32 = 8;
