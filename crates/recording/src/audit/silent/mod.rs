//! Checks for channels that are absent, dead, held or frozen.

pub(in crate::audit) mod dead;
pub(in crate::audit) mod frozen;
pub(in crate::audit) mod held;
pub(in crate::audit) mod missing;
pub(in crate::audit) mod stuck;
