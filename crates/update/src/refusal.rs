//! Why a program is not taken.

/// Why a program is not taken. The numbers are those of the registers and of the journal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Refusal {
    /// No program of this board's kind: no seal, or a length that cannot be.
    NoProgram = 1,
    /// For another board.
    Board = 2,
    /// Older than the program that runs.
    Older = 3,
    /// Its bytes are not those that were sealed.
    Checksum = 4,
    /// Not signed with the key that belongs to the loader's.
    Signature = 5,
    /// The transfer is incomplete.
    Incomplete = 6,
    /// Flash refuses to be erased or written.
    Flash = 7,
    /// The program that runs is on trial itself: the one before it waits where another would be received.
    Trial = 8,
    /// The board is learning.
    Learning = 9,
    /// A configuration is on trial.
    Configuration = 10,
    /// The supply is low.
    Supply = 11,
}

impl Refusal {
    /// All of them, in the order of their numbers.
    pub const ALL: [Refusal; 11] = [
        Refusal::NoProgram,
        Refusal::Board,
        Refusal::Older,
        Refusal::Checksum,
        Refusal::Signature,
        Refusal::Incomplete,
        Refusal::Flash,
        Refusal::Trial,
        Refusal::Learning,
        Refusal::Configuration,
        Refusal::Supply,
    ];

    /// By its number.
    pub fn by_number(number: u8) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|refusal| *refusal as u8 == number)
    }

    /// In words.
    pub fn label(self) -> &'static str {
        match self {
            Refusal::NoProgram => "no program for this board",
            Refusal::Board => "for another board",
            Refusal::Older => "older than the program that runs",
            Refusal::Checksum => "damaged: its checksum does not hold",
            Refusal::Signature => "not signed with this board's key",
            Refusal::Incomplete => "the transfer is incomplete",
            Refusal::Flash => "flash was not written",
            Refusal::Trial => "the program that runs is on trial itself",
            Refusal::Learning => "the board is learning",
            Refusal::Configuration => "a configuration is on trial",
            Refusal::Supply => "the supply is low",
        }
    }
}

impl core::fmt::Display for Refusal {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(self.label())
    }
}

impl core::error::Error for Refusal {}
