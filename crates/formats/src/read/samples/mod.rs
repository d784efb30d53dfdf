//! The samples of a file before they are channels, all at once or piece by piece.

mod collector;
mod pieces;
mod raw;

pub(super) use pieces::{Extent, gather};
pub(super) use raw::{Kept, Piece, Raw, Rows};
