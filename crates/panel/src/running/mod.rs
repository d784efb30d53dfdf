//! The source on its own thread: samples through the core, windows, events, history.

pub(crate) mod bench;
pub(crate) mod events;
pub(crate) mod fields;
pub(crate) mod history;
pub(crate) mod message;
pub(crate) mod pace;
pub(crate) mod session;
pub(crate) mod shared;
pub(crate) mod wave;
pub(crate) mod worker;
