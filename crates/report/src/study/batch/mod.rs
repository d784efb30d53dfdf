//! A folder of recordings, one row each: which recordings, what a row says, and where rows are kept until all are there.

mod folder;
mod row;
mod store;

pub use folder::{Batch, BatchError};
pub use row::{FAULT, HEALTHY, NOT_JUDGED, NOT_READ, Row};
pub use store::{Store, StoreError, read_table};
