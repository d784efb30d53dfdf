//! What a recording of a motor or a load table holds, and how the columns of a file become its channels.
//!
//! A [`Recording`] has a clock and channels in SI units; a [`LoadTable`] has operating points. A [`Mapping`] says
//! which column of a file is which channel, in which unit and through which sensor; flags and the [`Sidecar`] beside a
//! file fill it. Whatever is wrong with an input is an [`Error`] that names file, line, column and remedy.
//! The crate `formats` reads and writes files, `audit` looks for what is wrong with a recording.
//!
//! ```
//! use recording::{Channel, Metadata, Recording};
//!
//! let t = (0..4).map(|k| f64::from(k) * 1e-4).collect();
//! let recording = Recording::new("bench", t, Metadata::default())
//!     .and_then(|recording| recording.with_channel(Channel::SPEED, vec![157.0; 4]))
//!     .expect("a rising clock, and one value per sample");
//! assert_eq!(recording.channel(Channel::SPEED), Some(&[157.0; 4][..]));
//! ```

mod data;
pub mod delay;
mod error;
mod mapping;
pub mod names;
pub mod rounded;
mod suggest;

pub use data::channel::{Channel, Quantity, Signal};
pub use data::column::{Column, Lent};
pub use data::load_table::{LoadPoint, LoadTable, TableColumn};
pub use data::metadata::{LoadTorque, Metadata, Sensors, StartsFrom, Supply, VoltageKind};
pub use data::recording::{Bridged, Recording, UnknownScale};
pub use data::source::{Follows, Source};
pub use data::units::{Period, UNITS, Unit, is_unit};
pub use error::{Class, Error, Problem};
pub use mapping::sidecar::Sidecar;
pub use mapping::{
    ColumnMap, DateOrder, Factor, Flags, Mapping, Origin, Said, Sensor, Slot, Target, quoted,
};
pub use names::{companions, sidecar_path};
pub use suggest::closest;
