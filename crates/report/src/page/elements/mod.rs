//! What every page is made of: its frame, numbers, figures, and places in the result.

pub mod chart;
pub mod number;
pub mod place;
pub mod shell;
