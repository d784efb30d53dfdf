//! Reading, mapping, writing and auditing recordings of motors and load-test tables.
//!
//! [`read_recording`] turns a `.csv` or `.csv.gz` file into a [`Recording`] in SI units, with every
//! assumption that this took written down beside it. Whatever is wrong with an input becomes an
//! [`Error`] that names file, line, column and remedy.

mod channel;
mod error;
mod mapping;
mod metadata;
mod read;
mod recording;
mod source;
mod suggest;
mod units;

pub use channel::{Channel, Quantity, Signal};
pub use error::{Class, Error, Problem};
pub use mapping::{ColumnMap, Mapping, Target};
pub use metadata::{LoadTorque, Metadata, Sensors, StartsFrom, Supply, VoltageKind};
pub use read::read_recording;
pub use recording::Recording;
pub use source::Progress;
pub use units::{UNITS, Unit};
