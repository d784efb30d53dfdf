//! The core beside the simulated motor: what `demo` measures and prints.
//!
//! It needs neither recordings nor a browser, and so it is built and run in seconds. Everything else is `drivemon`.

pub mod demo;
