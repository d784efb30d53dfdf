//! What a page or a program is told of a plant, as JSON: units in the names of keys, null where a number is not known.
//!
//! These types are the interface; those of the store may change beside them.

mod actions;
mod alarms;
mod motor;
mod trend;
mod wall;
mod words;

pub use actions::{ActionAnswer, ActionRequest, AuditAnswer, Refusal};
pub use alarms::{AlarmAnswer, AlarmHistoryAnswer, AlarmsAnswer, ChangeAnswer};
pub use motor::{MotorAnswer, SecondAnswer, TimelineAnswer};
pub use trend::{SeriesAnswer, TrendAnswer};
pub use wall::{Condition, Counts, WallAnswer, WallMotor};
