//! What `drivemon` is made of: scenarios and their simulation, replay through the board's core, and the command line.

pub mod calibrate;
pub mod campaign;
pub mod causes;
pub mod cli;
pub mod demo;
pub mod live;
pub mod motor_text;
pub mod operating_points;
pub mod overlay;
#[cfg(feature = "panel")]
pub mod panel;
pub mod replay;
pub mod report;
pub mod scenario;
pub mod simulate;
pub mod study;
pub mod words;
