//! What the benchmarks share: the case that both languages run, the C worker, ordinary signals for the core and
//! the peers that it is timed beside.
//!
//! Nothing here asserts a wall time. What must hold whatever the machine (both languages compute the same
//! trajectory, the core judged what it was fed) is asserted before anything is timed.

pub mod c_worker;
pub mod direct_on_line;
pub mod interleaved;
pub mod peers;
pub mod signals;

/// This package's folder in the source tree.
pub const FOLDER: &str = env!("CARGO_MANIFEST_DIR");
