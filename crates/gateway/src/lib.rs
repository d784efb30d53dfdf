//! From many boards to the store of a plant: links, polling, catching up; and boards that are simulated.
//!
//! A board numbers its events and seconds and keeps the newest of them. A gateway asks for what comes behind the last number in its
//! store, so that its own end, at any moment, loses nothing and stores nothing twice. What a board does not have any more is
//! stored as a gap.
//!
//! ```
//! use gateway::config::Config;
//! use std::path::Path;
//!
//! let text = r#"
//! [store]
//! path = "plant.db"
//! [[link]]
//! name = "hall-1"
//! kind = "modbus-tcp"
//! address = "10.0.0.7:502"
//! [[motor]]
//! name = "pump-7"
//! link = "hall-2"
//! unit = 7
//! "#;
//! let error = Config::parse(text, Path::new("plant.toml"), Config::no_outputs).unwrap_err();
//! assert_eq!(
//!     error.to_string(),
//!     "plant.toml:10: motor[1].link: \"hall-2\" is no link of this file: did you mean \"hall-1\"?"
//! );
//! ```

mod bus;
#[cfg(feature = "command")]
pub mod command;
pub mod config;
mod poll;
mod run;
pub mod simulate;
mod wire;

pub use poll::Snapshot;
pub use run::{Connected, Gateway, StartError, WriteError, connect};
