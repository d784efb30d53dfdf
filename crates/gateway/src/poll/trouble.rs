//! Why a visit brought nothing.

use crate::bus::BusError;

/// Why a visit brought nothing.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum Trouble {
    /// No answer.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// An answer that must not be stored under this motor.
    #[error("{0}")]
    Other(String),
    /// The gateway ends.
    #[error("the gateway ends")]
    Ended,
}
