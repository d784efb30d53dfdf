//! One file per subcommand.

pub(crate) mod batch;
pub(crate) mod board;
pub(crate) mod calibrate;
pub(crate) mod check;
pub(crate) mod completions;
mod ending;
mod engine;
pub(crate) mod export;
pub(crate) mod flash;
#[cfg(feature = "gateway")]
pub(crate) mod gateway;
pub(crate) mod live;
pub(crate) mod monitor;
pub(crate) mod motor;
#[cfg(feature = "panel")]
pub(crate) mod panel;
pub(crate) mod schema;
pub(crate) mod simulated;
pub(crate) mod study;
