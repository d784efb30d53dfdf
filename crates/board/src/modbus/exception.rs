//! Refusals of the protocol.

/// Why a request is refused, as the protocol numbers it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Exception {
    /// A function that does not exist here, or a command while the slave is locked.
    Function = 1,
    Address = 2,
    Value = 3,
    /// Flash is being erased.
    Busy = 6,
}
