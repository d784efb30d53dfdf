//! Text files of whatever recorder: separator, way of writing numbers, names, units and clock are found, and said.

mod blanks;
mod body;
mod cells;
mod clocks;
pub(super) mod csv_file;
mod encoding;
mod head;
mod layout;
mod number;
mod preamble;
mod rows;
pub(crate) mod source;
mod stamp;
mod titles;
