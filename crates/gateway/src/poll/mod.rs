//! From boards to entries of the store: one task for each link.

mod asked;
mod clock;
mod context;
mod frames;
mod link;
mod motor;
mod recording;
mod tally;
mod trouble;
mod visit;
mod wanted;

pub(crate) use context::Context;
pub(crate) use link::follow;
pub use tally::Snapshot;
pub(crate) use tally::{Post, Tally};
pub(crate) use visit::knock;
