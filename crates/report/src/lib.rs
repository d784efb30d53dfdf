//! Results for people: pages for a browser, figures of measured beside modelled signals, changed motor files.
//!
//! A changed motor file keeps the comments of its author:
//!
//! ```
//! # use motor::MotorFile;
//! let text = std::fs::read_to_string("../../motors/peer-2k2.toml").expect("readable");
//! let mut motor = MotorFile::parse(&text, "peer-2k2.toml").expect("a motor file");
//! motor.parameters.r_s *= 1.1;
//! let changed = report::motor_text::updated(&text, &motor);
//! let comments = |text: &str| text.matches('#').count();
//! assert!(changed != text && comments(&changed) == comments(&text));
//! ```

pub mod json;
pub mod motor_text;
pub mod overlay;
mod page;
pub mod study;

pub use page::*;
