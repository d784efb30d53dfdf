//! Sparkplug B over MQTT 3.1.1, from the store to a broker.

mod check;
mod config;
mod error;
mod line;
mod present;
mod run;
mod session_file;
mod status;
mod tls;

pub use check::check_files;
pub use config::{MqttConfig, OwnCertificate, TlsConfig};
pub use error::LineError;
pub use present::present;
pub use run::{OutputError, run};
pub use status::{MqttState, MqttStatus};
