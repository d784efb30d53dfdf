//! What every check measures with: blocks of whole periods, phasors, sequences, statistics.

pub(in crate::audit) mod blocks;
pub(in crate::audit) mod fit;
pub(in crate::audit) mod refresh;
pub(in crate::audit) mod sequence;
pub(in crate::audit) mod statistics;
pub(in crate::audit) mod track;
