//! The studies are the examples of this package: `cargo run --release -p studies --example evidence`. What several of them share is here.

#![allow(missing_docs)]

pub mod broken;
pub mod condition;
pub mod drive;
pub mod hidden;
pub mod words;
