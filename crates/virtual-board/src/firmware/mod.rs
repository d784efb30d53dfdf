//! What is known of the firmware from outside: its file, its log and the memory it shares with a debugger.

pub(crate) mod elf;
pub(crate) mod loader;
pub(crate) mod log;
pub(crate) mod rtt;
