//! A Modbus RTU slave: what the board knows, for controllers and control rooms.
//!
//! Own code although crates exist: `rmodbus` indexes its frames with numbers out of them, which leaves panics within reach
//! of the wire, and needs a store of its own beside [`Image`]. The tests use it as the master on the other end.

mod map;
mod slave;
mod status;
mod table;

pub use map::{Entry, Image, Kind, MAP_VERSION, Meaning, WORDS, address};
pub use slave::{Collector, Command, MAX_REQUEST_BYTES, MAX_RESPONSE_BYTES, Slave, UNLOCK_KEY};
pub use status::{BoardStatus, Status};
pub use table::{Field, MAP};
