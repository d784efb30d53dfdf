//! A Modbus RTU slave: what the board knows, for controllers and control rooms.
//!
//! Own code although crates exist: `rmodbus` indexes its frames with numbers out of them, which leaves panics within reach
//! of the wire, and needs a store of its own beside [`Image`]. The tests use it as the master on the other end.

mod answer;
mod entry;
mod exception;
mod file;
mod identity;
mod map;
mod memory;
mod second_collector;
mod slave;
mod status;
mod table;

pub use answer::MAX_RESPONSE_BYTES;
pub use entry::{Entry, Field, Kind, Meaning};
pub use file::{
    CAPTURE_FILE, EVENT_FILE, MOST_FILE_WORDS, MOST_PROGRAM_WORDS, PROGRAM_FILE, PROGRAM_REST_FILE,
    SECONDS_FILE,
};
pub use identity::Object;
pub use map::{Image, MAP_VERSION, WORDS, address};
pub use memory::{File, Files, Identity, Memory};
pub use second_collector::SecondCollector;
pub use slave::{Collector, Command, MAX_REQUEST_BYTES, Slave, UNLOCK_KEY};
pub use status::{BoardStatus, Status, UpdateStatus};
pub use table::MAP;
