//! What the rows amount to: alarms, smallest sizes, delays, names.

pub(crate) mod detection;
pub(crate) mod groups;
pub(crate) mod markdown;
pub(crate) mod print;
pub(crate) mod statistics;
pub(crate) mod table;
#[cfg(test)]
mod table_tests;
