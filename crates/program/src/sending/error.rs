//! Why a program did not reach a board.

use live::{ModbusError, RegistersError};
use update::{Refusal, Version};

/// Why a program did not reach a board, and what helps.
#[derive(Debug, thiserror::Error)]
pub enum SendError {
    /// The line.
    #[error(transparent)]
    Line(#[from] ModbusError),
    /// The board's registers.
    #[error(transparent)]
    Registers(#[from] RegistersError),
    /// The board's program cannot be exchanged.
    #[error(
        "the board's program is from before programs came over the line; write loader and program once with a debugger: \
         `drivemon flash`"
    )]
    Unable,
    /// The new program is older.
    #[error(
        "the package holds version {package}, the board runs {board}: a board takes no older program over the line; write it \
         with a debugger: `drivemon flash`"
    )]
    Older {
        /// Version of the package.
        package: Version,
        /// Version of the program that runs.
        board: Version,
    },
    /// The board did not take it.
    #[error("the board refuses the program: {refusal}; {}", remedy(*refusal))]
    Refused {
        /// Why.
        refusal: Refusal,
    },
    /// The board refuses with a number that this program does not know.
    #[error(
        "the board refuses the program (reason {0}): use the drivemon of the firmware's version"
    )]
    RefusedUnknown(u16),
    /// The new program did not confirm itself.
    #[error(
        "the board brought its program before back: the new one crashed, or did not run for a minute without a doubt within ten; `drivemon board \
         record` and `drivemon board events` say why"
    )]
    BroughtBack,
    /// The board is busy with something else.
    #[error(
        "the board takes no program now: one is on trial or being installed, or its supply is low; try again in a minute"
    )]
    Busy,
    /// The board lost the transfer again and again.
    #[error(
        "the board lost the transfer {0} times; check its supply, and termination and order of the wires; then send again"
    )]
    Lost(u32),
    /// Somebody wants to stop; the board runs on as before.
    #[error(
        "stopped at {sent} of {bytes} bytes; the board runs its program on as before, and the next transfer begins at its \
         beginning"
    )]
    Stopped {
        /// Bytes that were sent.
        sent: usize,
        /// Bytes of the package.
        bytes: usize,
    },
    /// Somebody wants to stop waiting; the board goes on by itself.
    #[error(
        "stopped waiting; the board goes on by itself: `drivemon board read` shows Update, 5 once the new program has \
         confirmed itself, and the same command waits on"
    )]
    StoppedWaiting,
    /// It was asked to install the program, and does nothing of it.
    #[error(
        "the board did not begin to install the program within {0} s; `drivemon board read` shows Update and UpdateRefused"
    )]
    NotInstalled(u64),
    /// Another program runs than the one that was sent.
    #[error(
        "the board runs another program (checksum {runs:08x}) than the one that was sent ({sent:08x}); `drivemon board \
         events` says what happened"
    )]
    Another {
        /// Checksum of the program that runs.
        runs: u32,
        /// Of the package.
        sent: u32,
    },
}

/// What helps when a board refuses.
fn remedy(refusal: Refusal) -> &'static str {
    match refusal {
        Refusal::NoProgram => "make the package again with `drivemon board package`",
        Refusal::Board => "build the firmware of this board",
        Refusal::Older => "write an older program with a debugger: `drivemon flash`",
        Refusal::Checksum | Refusal::Incomplete => "send it again",
        Refusal::Signature => {
            "sign it with the secret half of the key whose public half its loader has: `drivemon board package --key`"
        }
        Refusal::Flash => "send it again; if it refuses again the chip's flash is worn out",
        Refusal::Trial => "the program that runs is new: try again once it has run for a minute",
        Refusal::Learning => "try again once it has learnt, half a minute later",
        Refusal::Configuration => {
            "confirm the configuration first: `drivemon board configure --confirm`"
        }
        Refusal::Supply => "see to its supply and send it again",
    }
}
