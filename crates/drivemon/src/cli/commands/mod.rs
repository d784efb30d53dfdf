//! One file per subcommand.

pub(crate) mod adopt;
pub(crate) mod calibrate;
pub(crate) mod campaign;
pub(crate) mod check;
pub(crate) mod compare;
pub(crate) mod completions;
pub(crate) mod demo;
pub(crate) mod explain;
pub(crate) mod flash;
pub(crate) mod live;
pub(crate) mod monitor;
pub(crate) mod motor;
#[cfg(feature = "panel")]
pub(crate) mod panel;
pub(crate) mod simulate;
