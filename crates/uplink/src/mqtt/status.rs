//! How the output to a broker is doing, for pages and metrics.

use std::sync::{Arc, Mutex, PoisonError};

use serde::Serialize;

/// State of the output to a broker.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct MqttState {
    /// Whether a session is up.
    pub connected: bool,
    /// Whether births were told: data flows. Connected and not online: the primary host is away.
    pub online: bool,
    /// Sessions since the program started.
    pub sessions: u64,
    /// Times that all births were told.
    pub births: u64,
    /// Messages sent.
    pub messages: u64,
    /// Commands that were refused.
    pub refused_commands: u64,
    /// Births under this node's name that somebody else said.
    pub foreign_births: u64,
    /// Newest entry that the broker has taken.
    pub delivered: u64,
    /// Why the last session ended; empty: none has.
    pub last_error: String,
}

/// A state that the output writes and others read.
#[derive(Clone, Debug, Default)]
pub struct MqttStatus(Arc<Mutex<MqttState>>);

impl MqttStatus {
    /// The state now.
    pub fn get(&self) -> MqttState {
        let state = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        state.clone()
    }

    pub(super) fn change(&self, change: impl FnOnce(&mut MqttState)) {
        change(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner));
    }
}
