//! Why the processor began anew.

/// Numbers of the register `ResetCause` and of the event of a start, with their words.
pub const RESET_CAUSES: [(u16, &str); 5] = [
    (1, "power or brown-out"),
    (2, "watchdog"),
    (3, "the program itself"),
    (4, "reset pin"),
    (5, "another cause"),
];
