//! Why there is no line to a broker.

use std::io;
use std::time::Duration;

use mqtt_protocol_core::mqtt::result_code::MqttError;
use thiserror::Error;

/// How long the broker may take for an answer, or to take what is sent.
pub(super) const PATIENCE: Duration = Duration::from_secs(10);

/// Why there is no connection to a broker, or no longer.
#[derive(Debug, Error)]
pub enum LineError {
    /// It cannot be reached, or the line broke.
    #[error("{0}")]
    Io(#[from] io::Error),
    /// It closed the line.
    #[error("the broker closed the line")]
    Closed,
    /// It does not answer.
    #[error("the broker did not answer within {} s", PATIENCE.as_secs())]
    Silent,
    /// It does not want this client.
    #[error("the broker refused: {0}")]
    Refused(String),
    /// It does not keep to MQTT, or what should be sent cannot be.
    #[error("MQTT: {0}")]
    Protocol(String),
    /// A file that the configuration names.
    #[error("{path}: {error}")]
    File {
        /// The file.
        path: String,
        /// What is wrong.
        error: String,
    },
}

impl From<MqttError> for LineError {
    fn from(error: MqttError) -> LineError {
        LineError::Protocol(format!("{error:?}"))
    }
}
