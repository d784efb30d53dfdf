//! What the board doubts about itself, and what a crash leaves behind.

pub mod doubt;
pub mod fault_record;
pub mod reset;
pub mod stuck;
