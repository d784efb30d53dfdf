//! The running program's side: it receives a new one, checks it, asks the loader, and is on trial itself.

pub(super) mod background;
#[cfg(test)]
mod bank;
pub(super) mod state;
pub(super) mod tray;
pub(super) mod updater;
pub(super) mod waiting;
