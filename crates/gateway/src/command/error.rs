//! How a command fails.

/// Why a command could not do its work.
#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    /// The configuration.
    #[error(transparent)]
    Config(#[from] document::FileError),
    /// The store.
    #[error(transparent)]
    Start(#[from] crate::StartError),
    /// Writing.
    #[error(transparent)]
    Write(#[from] crate::WriteError),
    /// An output.
    #[error("{0}")]
    Output(String),
    /// An alarm without a recording.
    #[error(transparent)]
    NoRecording(#[from] fleet::NoRecording),
    /// Samples that make no recording.
    #[error(transparent)]
    Capture(#[from] live::CaptureError),
    /// A recording that cannot be written.
    #[error(transparent)]
    Recording(#[from] recording::Error),
    /// Reading the store.
    #[error(transparent)]
    Read(#[from] fleet::StoreError),
    /// People of a plant.
    #[error(transparent)]
    People(#[from] fleet::people::PeopleError),
    /// A plan of simulated boards.
    #[error(transparent)]
    Plan(#[from] crate::simulate::PlanError),
    /// A file that the command is to write.
    #[error("{option} {path}: {error}; name a path in a folder that exists and can be written")]
    File {
        /// The option.
        option: &'static str,
        /// The file.
        path: String,
        /// What the system says.
        error: std::io::Error,
    },
    /// Anything else that the system refuses.
    #[error("{0}")]
    System(#[from] std::io::Error),
}
