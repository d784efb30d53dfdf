//! From residuals to lamps, and to the likely cause.

pub(crate) mod lamp;
pub(crate) mod likely_cause;
pub(crate) mod logic;
pub(crate) mod signature;
pub(crate) mod threshold;
