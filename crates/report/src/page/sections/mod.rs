//! Sections that the pages of several commands share.

pub mod audit;
pub mod frame;
pub mod laws;
pub mod models;
pub mod motion;
pub mod next_run;
pub mod overlay;
pub mod parameters;
pub mod plate;
pub mod scale;
pub mod table_overlay;
