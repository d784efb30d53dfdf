//! What the boards have produced, written down beside the gateway: what a store is compared with.

use std::fmt::Write as _;
use std::fs::File;
use std::io::{BufWriter, Result, Write};
use std::path::Path;

use board::{EVENT_BYTES, SECOND_BYTES};

/// A record as it lies in the board.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Produced {
    /// A second.
    Second([u8; SECOND_BYTES]),
    /// An event.
    Event([u8; EVENT_BYTES]),
    /// The file of the samples around an alarm.
    Recording(Vec<u8>),
}

/// A text file with a line each: `second`, `event` or `recording`, motor, the record's bytes as hexadecimal digits.
#[derive(Debug)]
pub struct Truth {
    file: BufWriter<File>,
    line: String,
}

impl Truth {
    /// An empty file.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn create(path: &Path) -> Result<Self> {
        Ok(Truth {
            file: BufWriter::new(File::create(path)?),
            line: String::new(),
        })
    }

    /// Takes what a board has produced.
    ///
    /// # Errors
    /// The file cannot be written.
    pub(crate) fn take(&mut self, motor: &str, produced: &Produced) -> Result<()> {
        let (kind, bytes): (_, &[u8]) = match produced {
            Produced::Second(bytes) => ("second", bytes),
            Produced::Event(bytes) => ("event", bytes),
            Produced::Recording(bytes) => ("recording", bytes),
        };
        self.line.clear();
        self.line.extend([kind, " ", motor, " "]);
        for byte in bytes {
            // Into memory.
            let _ = write!(self.line, "{byte:02x}");
        }
        self.line.push('\n');
        self.file.write_all(self.line.as_bytes())
    }

    /// Everything so far is in the file.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn flush(&mut self) -> Result<()> {
        self.file.flush()
    }
}
