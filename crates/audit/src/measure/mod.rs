//! What every check measures with: blocks of whole periods, phasors, sequences, statistics.

pub(crate) mod blocks;
pub(crate) mod fit;
pub(crate) mod harmonics;
pub(crate) mod normal;
pub(crate) mod refresh;
pub(crate) mod sequence;
pub(crate) mod statistics;
pub(crate) mod track;
pub(crate) mod turn;
