//! Laws that no library holds: where in the equations, over which quantity, which curve.
//!
//! A curve is a sum of modes, smooth ones cheap and bending ones dear ([`modes`]). Every place and coordinate that the
//! recording visits ([`menu`]) is screened with the penalty that predicts blocks best which were not fitted
//! ([`screen`]); the best are refitted with all parameters free, get knots where the best one bends ([`refine`]), and must
//! prove themselves as an effect must ([`search`]).

pub(crate) mod curve;
pub(crate) mod formula;
pub(crate) mod menu;
pub(crate) mod modes;
pub(crate) mod motion;
mod refine;
pub(crate) mod report;
mod screen;
pub(crate) mod search;
pub(crate) mod sensitivity;
