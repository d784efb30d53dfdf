//! The questions a user asks.

mod adopt;
mod explain;

pub use adopt::{adopt, adopt_with};
pub use explain::{Asked, explain, explain_with, explain_without};

pub(crate) use adopt::{as_believed, errors, updated};
pub(crate) use explain::speed_scale_report;

/// Hears what is being done, and how far it is (0 to 1).
pub type Progress<'a> = dyn FnMut(&str, f64) + 'a;

/// Name under which [`adopt`] takes over refitted parameters without any effect.
pub const PARAMETERS: &str = "parameters";

/// Name under which [`adopt`] takes over the laws that [`explain`] proves.
pub const LAW: &str = "law";
