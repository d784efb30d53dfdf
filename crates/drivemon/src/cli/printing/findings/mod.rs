//! What an explanation finds, in a terminal.

pub(crate) mod bursts;
pub(crate) mod errors;
pub(crate) mod laws;
pub(crate) mod next_run;
pub(crate) mod places;
pub(crate) mod scale;
