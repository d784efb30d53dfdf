//! Tests of several modules together.

mod priors;
mod refitted_folds;
