//! What can end a run.

use unicorn_engine::uc_error;

/// Why the board cannot go on.
#[derive(Debug, thiserror::Error)]
pub enum BoardError {
    /// The file is not what the board can run.
    #[error("the firmware file cannot be used: {0}")]
    Elf(String),
    /// The emulator refused.
    #[error("the emulator refuses: {0:?}")]
    Emulator(uc_error),
    /// The program did something that this board cannot do.
    #[error("stopped at pc {pc:#x}, lr {lr:#x}: {what}")]
    Stopped {
        /// What it did.
        what: String,
        /// Program counter.
        pc: u32,
        /// Link register.
        lr: u32,
    },
}

impl From<uc_error> for BoardError {
    fn from(error: uc_error) -> Self {
        BoardError::Emulator(error)
    }
}
