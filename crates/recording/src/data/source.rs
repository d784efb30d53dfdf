use super::load_table::LoadTable;
use super::recording::Recording;

/// What a file turned out to hold.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// Samples over time.
    Recording(Recording),
    /// Operating points.
    LoadTable(LoadTable),
}
