//! Compare a motor model with recordings, find the physical effect it misses, prove it on data that was not fitted.

mod accept;
mod belief;
mod case;
mod confirm;
mod explain;
mod fit;
mod floor;
mod gram;
mod predict;
mod present;
#[doc(hidden)]
pub mod probe;
mod proof;
mod report;
mod screen;
mod signal;
mod study;

pub use case::Unsupported;
