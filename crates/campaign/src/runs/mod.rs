//! Runs: simulated, replayed through the core, one row each, in parts that survive a crash.

pub(crate) mod cause;
pub(crate) mod file;
pub(crate) mod outcome;
pub(crate) mod parts;
pub(crate) mod row;
pub(crate) mod run;
