//! The answer: types, words, tables.

pub(crate) mod frame;
pub(crate) mod law;
pub(crate) mod parameter;
pub(crate) mod present;
pub(crate) mod types;
pub(crate) mod unexplained;
pub(crate) mod words;
