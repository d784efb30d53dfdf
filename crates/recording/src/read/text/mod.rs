//! Text files of whatever recorder.

pub(super) mod csv_file;
pub(crate) mod source;
