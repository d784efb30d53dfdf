//! The plan: conditions, faults, and every run by its index.

pub(crate) mod axis;
pub(crate) mod check;
pub(crate) mod fault;
pub(crate) mod pair;
pub(crate) mod plan;
pub(crate) mod read;
