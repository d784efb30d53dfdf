//! What a recording or a load table holds: channels, units, samples, what is known beside them.

pub(crate) mod channel;
pub(crate) mod column;
pub(crate) mod load_table;
pub(crate) mod metadata;
pub(crate) mod recording;
pub(crate) mod source;
pub(crate) mod units;
