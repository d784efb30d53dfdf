//! How a command ends.

use report::study::batch::BatchError;

/// The outcome of a command that did its work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finding {
    /// Fine, healthy or adequate.
    Nothing,
    /// Something was found: a fault lit, a model inadequate.
    Something,
    /// The data do not support an answer.
    Unsupported,
    /// One of several recordings could not be read; the reason is told.
    NotRead,
}

impl Finding {
    /// Exit code as documented.
    pub fn exit_code(self) -> u8 {
        match self {
            Finding::Nothing => 0,
            Finding::Something => 1,
            Finding::NotRead => 2,
            Finding::Unsupported => 3,
        }
    }
}

/// Why a command could not do its work.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// A recording, table or sidecar.
    #[error(transparent)]
    Recording(#[from] recording::Error),
    /// A motor file or scenario.
    #[error(transparent)]
    File(#[from] document::FileError),
    /// A map of motors.
    #[error(transparent)]
    Map(#[from] report::study::MapError),
    /// Rows of a batch.
    #[error(transparent)]
    Rows(#[from] report::study::batch::StoreError),
    /// The motor file's values do not fit the core.
    #[error("{file}: {error}; change the value in the motor file")]
    Config {
        /// The motor file.
        file: String,
        /// What is out of range.
        error: monitor::ConfigError,
    },
    /// A file could not be written.
    #[error(
        "{path}: cannot be written: {error}; name a path in a folder that exists and can be written"
    )]
    Write {
        /// The file.
        path: String,
        /// What the system said.
        error: std::io::Error,
    },
    /// Standard output could not be written.
    #[error("standard output: cannot be written: {0}; send it to a place with room")]
    Output(std::io::Error),
    /// Results of a campaign.
    #[error(transparent)]
    Store(#[from] campaign::StoreError),
    /// A board on its Modbus line.
    #[error(transparent)]
    Board(#[from] live::ModbusError),
    /// Its registers.
    #[error(transparent)]
    Registers(#[from] live::RegistersError),
    /// A program, its key or its package.
    #[error(transparent)]
    Program(#[from] program::Error),
    /// A program that did not reach a board.
    #[error(transparent)]
    Sending(#[from] program::sending::SendError),
    /// The data do not support an answer.
    #[error("{0}")]
    Unsupported(String),
    /// Anything else that is wrong with what the user asked.
    #[error("{0}")]
    Usage(String),
}

impl From<BatchError> for Failure {
    fn from(error: BatchError) -> Failure {
        match error {
            BatchError::Flags(error) => Failure::Recording(error),
            BatchError::Map(error) => Failure::Map(error),
            BatchError::Store(error) => Failure::Rows(error),
        }
    }
}

impl Failure {
    /// Exit code as documented: 2 bad input or usage, 3 unsupported data.
    pub fn exit_code(&self) -> u8 {
        match self {
            Failure::Recording(error) => error.exit_code(),
            Failure::Unsupported(_) => 3,
            _ => 2,
        }
    }
}
