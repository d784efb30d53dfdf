//! What is looked at beside the model: sensors, supply, bars of the rotor.

pub(crate) mod cage;
pub(crate) mod rotor_bars;
pub(crate) mod sensors;
pub(crate) mod speed_swing;
pub(crate) mod supply;
pub(crate) mod unbalance;
