//! From the plate of a squirrel-cage induction motor to its equivalent circuit, every parameter with an interval.
//!
//! A plate prints six to ten numbers, a circuit has twelve unknowns: what the numbers leave open, a prior over real motors
//! settles, and the intervals say how well.
//!
//! ```
//! use nameplate::{Estimate, plate::PlateFile};
//!
//! let plate = "power_kw = 5.5\nvoltage_volt = 400\nfrequency_hz = 50\nspeed_rpm = 1455\ncurrent_amp = 10.8\npower_factor = 0.83";
//! let file = PlateFile::parse(plate, "plate.toml").expect("numbers");
//! let estimate = Estimate::of(&file.plate).expect("a motor");
//! let [stator_resistance, ..] = estimate.parameters; // ohm
//! assert!(stator_resistance.low < stator_resistance.value && stator_resistance.value < stator_resistance.high);
//! ```

pub mod catalogue;
pub mod circuit;
pub mod contradiction;
mod estimate;
pub mod fit;
mod interval;
pub mod measured;
mod motor_text;
pub mod physical;
pub mod plate;
pub mod prior;

pub use estimate::{COLUMN_KEYS, COLUMNS, Estimate};
pub use interval::Interval;
pub use motor_text::{motor_text, tested_text};
pub use plate::Plate;
