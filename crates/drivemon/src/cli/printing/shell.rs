//! Command lines that a person can paste.

pub use recording::quoted;
