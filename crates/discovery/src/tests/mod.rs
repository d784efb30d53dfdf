//! Tests of several modules together, and what they share.

pub(crate) mod priors;
pub(crate) mod refitted_folds;
pub(crate) mod specimen;
