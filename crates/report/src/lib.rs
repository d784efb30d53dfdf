//! Results for people: pages for a browser, figures of measured beside modelled signals, changed motor files.

pub mod motor_text;
pub mod overlay;
mod page;
pub mod study;

pub use page::*;
