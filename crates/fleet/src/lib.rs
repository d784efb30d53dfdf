//! A plant of many motors: what is known of each, what is kept of it and for how long, and its alarms.
//!
//! ```
//! use fleet::{Entry, Limits, MotorId, MotorInfo, Second, Store};
//!
//! let folder = tempfile::tempdir().unwrap();
//! let store = Store::open(&folder.path().join("plant.db"), &Limits::default()).unwrap();
//! let motor: MotorId = "pump-7".parse().unwrap();
//! store.declare(&[MotorInfo::new(motor.clone())]).unwrap();
//! let second = Second { start: 1, number: 1, time_ms: 1_790_000_000_000, ..Second::default() };
//! let batch = [(motor.clone(), Entry::Second(second))];
//! assert_eq!(store.append(&batch).unwrap().stored, 1);
//! // The same second once more is recognised.
//! assert_eq!(store.append(&batch).unwrap().already, 1);
//! assert_eq!(store.last_second(&motor).unwrap(), Some((1, 1)));
//! ```

pub mod alarm;
mod claim;
mod clock;
mod entry;
pub mod lamp;
mod motor;
pub mod people;
mod state;
mod store;

pub use claim::Claim;
pub use clock::now_ms;
pub use entry::{
    BoardEvent, Entry, Gap, GapOf, Link, Numbered, Recording, RecordingKey, Second, Thinned,
    ThinnedTo,
};
pub use motor::{MotorId, MotorIdError, MotorInfo};
pub use state::MotorState;
pub use store::{
    AlarmRecording, Appended, EntryFilter, Limits, NoRecording, Reader, Samples, Store, StoreError,
    Trend, TrendPoint, Values,
};
