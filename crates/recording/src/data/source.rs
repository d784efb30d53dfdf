use super::load_table::LoadTable;
use super::recording::Recording;

/// What comes after a piece of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Follows {
    /// Another piece.
    Piece,
    /// Nothing: the piece ends the recording.
    Nothing,
}

/// What a file turned out to hold.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// Samples over time.
    Recording(Recording),
    /// Operating points.
    LoadTable(LoadTable),
}
