//! The last two minutes, second by second, for a master that was away: it asks for what it has not got yet.

mod ring;
mod second;

pub use ring::{SECONDS, SecondRing, place_of_second};
pub use second::{SECOND_BYTES, Second};
