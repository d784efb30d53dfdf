//! Where the frames come from.

use std::time::Duration;

use serialport::SerialPort;

/// How long one read waits for bytes.
const PATIENCE: Duration = Duration::from_millis(100);

/// Why nothing can be read.
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    /// The port.
    #[error("{port}: {error}; {remedy}")]
    Port {
        /// Its name.
        port: String,
        /// What the system says.
        error: serialport::Error,
        /// What helps.
        remedy: String,
    },
    /// Reading ended.
    #[error("the connection ended: {0}; is the cable still plugged in?")]
    Ended(std::io::Error),
    /// The debug probe.
    #[error("{0}")]
    Probe(String),
}

/// Bytes as they come.
pub trait Source: Send {
    /// The bytes of the next tenth of a second; none when nothing came.
    ///
    /// # Errors
    /// The connection is gone.
    fn read(&mut self) -> Result<Vec<u8>, SourceError>;
}

struct Serial(Box<dyn SerialPort>);

impl Source for Serial {
    fn read(&mut self) -> Result<Vec<u8>, SourceError> {
        let mut bytes = [0; 1024];
        match self.0.read(&mut bytes) {
            Ok(length) => Ok(bytes[..length].to_vec()),
            Err(error) if error.kind() == std::io::ErrorKind::TimedOut => Ok(Vec::new()),
            Err(error) => Err(SourceError::Ended(error)),
        }
    }
}

/// Opens a serial port at `baud` bit/s.
///
/// # Errors
/// No such port, no permission, or a rate that it cannot do.
pub fn open_serial(port: &str, baud: u32) -> Result<Box<dyn Source>, SourceError> {
    let opened = serialport::new(port, baud).timeout(PATIENCE).open();
    Ok(Box::new(Serial(
        opened.map_err(|error| port_error(port, error))?,
    )))
}

/// Why a port could not be opened, and what helps.
pub(crate) fn port_error(port: &str, error: serialport::Error) -> SourceError {
    SourceError::Port {
        port: port.to_owned(),
        remedy: remedy(&error),
        error,
    }
}

fn remedy(error: &serialport::Error) -> String {
    use serialport::ErrorKind::{Io, NoDevice};
    use std::io::ErrorKind::{NotFound, PermissionDenied};
    match error.kind {
        Io(PermissionDenied) => {
            "your user may not read it; on Linux join the group `dialout` and log in again".into()
        }
        NoDevice | Io(NotFound) => match port_names() {
            names if names.is_empty() => {
                "there is no serial port at all; is the board plugged in?".into()
            }
            names => format!("there are: {}", names.join(", ")),
        },
        _ => "is another program using it?".into(),
    }
}

fn port_names() -> Vec<String> {
    // Without it, as in a small container, the library panics.
    if cfg!(target_os = "linux") && !std::path::Path::new("/sys/class/tty").exists() {
        return Vec::new();
    }
    let ports = serialport::available_ports().unwrap_or_default();
    ports.into_iter().map(|port| port.port_name).collect()
}

/// Opens the first debug probe.
///
/// # Errors
/// This program was built without probes, there is none, or no board at its end.
#[cfg(not(feature = "probe"))]
pub fn open_probe() -> Result<Box<dyn Source>, SourceError> {
    Err(SourceError::Probe(
        "this drivemon was built without debug probes; build it with `cargo build --release -p drivemon --features probe`, or use --serial".into(),
    ))
}

/// Opens the first debug probe.
///
/// # Errors
/// There is none, or no board at its end.
#[cfg(feature = "probe")]
pub fn open_probe() -> Result<Box<dyn Source>, SourceError> {
    super::probe::open()
}
