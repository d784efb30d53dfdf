//! Checks for channels that are absent, dead, held or frozen.

pub(crate) mod dead;
pub(crate) mod frozen;
pub(crate) mod held;
pub(crate) mod missing;
pub(crate) mod stuck;
