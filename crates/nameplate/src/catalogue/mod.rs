//! Tables of many motors: CSV in, CSV out.

mod read;
mod write;

pub use read::{CatalogueError, Row, read};
pub use write::{header, record};
