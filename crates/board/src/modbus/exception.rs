//! Refusals of the protocol.

/// Why a request is refused, as the protocol numbers it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Exception {
    /// A function that does not exist here, or a command while the slave is locked.
    Function = 1,
    Address = 2,
    Value = 3,
    /// The transfer of a program has failed.
    Failure = 4,
    /// Not now: flash is being erased, or the piece of a program before this one is being written.
    Busy = 6,
}
