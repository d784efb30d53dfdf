//! The instruments of a scenario: from what was true to what is recorded.

mod chain;
mod sensing;
#[cfg(feature = "recording")]
mod shown;

pub(super) use sensing::Instruments;
#[cfg(feature = "recording")]
pub(super) use shown::shown;
