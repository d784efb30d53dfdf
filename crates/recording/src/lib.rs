//! Reading, mapping, writing and auditing recordings of motors and load-test tables.
//!
//! [`read_recording`] turns a `.csv` or `.csv.gz` file into a [`Recording`] in SI units, with every
//! assumption that this took written down beside it. Whatever is wrong with an input becomes an
//! [`Error`] that names file, line, column and remedy.
//!
//! ```
//! use recording::{Mapping, read_recording};
//!
//! let file = "../../tests/data/peer/none/recording.csv.gz".as_ref();
//! let recording = read_recording(file, &Mapping::default(), &mut |_| {}).expect("readable");
//! assert!((recording.t_sample() - 1e-4).abs() < 1e-12);
//! ```

mod audit;
mod contained;
mod data;
mod error;
mod mapping;
mod names;
mod read;
mod seal;
mod suggest;
mod write;

pub use audit::{Audit, Circuit, Code, Expectation, Finding, audit, with_sound_probes};
pub use data::channel::{Channel, Quantity, Signal};
pub use data::load_table::{LoadPoint, LoadTable, TableColumn};
pub use data::metadata::{LoadTorque, Metadata, Sensors, StartsFrom, Supply, VoltageKind};
pub use data::recording::{Bridged, Recording, UnknownScale};
pub use data::units::{Period, UNITS, Unit};
pub use error::{Class, Error, Problem};
pub use mapping::sidecar::Sidecar;
pub use mapping::{ColumnMap, DateOrder, Factor, Mapping, Origin, Said, Sensor, Target};
pub use names::{companions, sidecar_path};
pub use read::{
    Preview, Progress, Source, preview, read_any, read_load_table, read_recording, read_stream,
    with_most_numbers, workbook_text,
};
pub use write::{
    reading_text, sidecar_text, write_csv, write_parquet, write_recording, write_whole,
};
