//! What a page says: one file per command.

pub mod adopt;
pub mod campaign;
pub mod check;
pub mod compare;
pub mod demo;
pub mod explain;
pub mod load_table;
pub mod monitor;
pub mod month;
