//! The event log: what happened to the motor and to the board, in flash, whatever was switched off since.
//!
//! 512 events of 32 bytes lie in a ring of eight pages. An event's number tells its place, so that the newest is found after
//! any reset, and a master reads any of them without asking for a list. Each page stands 10 000 erasures: 5.1 million events,
//! 140 years at 100 a day. A cause is written once a minute at most, and its repetitions are counted, so that a lamp that
//! flickers fills no log.

mod cause;
mod event;
mod journal;
mod log;
mod words;

pub use cause::EventCause;
pub use event::{EVENT_BYTES, Event};
pub use journal::{Journal, Situation};
pub use log::{Appended, EventLog, LOG_EVENTS, LOG_PAGES, place_of};
