//! What the data that were not fitted say of two trials, and which parameters are off.

pub mod accept;
pub mod channels;
pub mod off;
pub mod order;
pub mod pairs;
pub mod windings;
