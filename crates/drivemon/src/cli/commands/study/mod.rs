//! Where a model fails, which physics it misses, and its correction.

pub(crate) mod adopt;
pub(crate) mod compare;
pub(crate) mod explain;
