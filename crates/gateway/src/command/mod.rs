//! The commands: their arguments, what they do, and what they say. How a line is printed knows the program.

mod error;
mod export;
mod fleet;
mod gather;
mod outputs;
mod report;
mod simulate;
mod terminal;
mod uplinks;
mod users;

pub use error::CommandError;
pub use fleet::Fleet;
pub use gather::{Gather, Ran};
pub use outputs::{Handles, Outputs};
pub use report::PageOfMonth;
pub use simulate::Simulate;
pub use terminal::Terminal;
pub use uplinks::Uplinks;
