//! What commands take: files, flags of recordings, sources of a study.

pub(crate) mod files;
pub(crate) mod healthy;
pub(crate) mod input;
pub(crate) mod long;
pub(crate) mod next_run;
pub(crate) mod study;
