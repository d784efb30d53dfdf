//! What comes and goes: an intermittent contact, a slipping coupling, a sticking valve.
//!
//! No smooth curve over time follows it. Its amount is first estimated freely over time, at each place of the equations
//! ([`estimation::fit::smoother`]); where it is there and gone again and again ([`pulse`]), each burst gets a beginning, an end and a size,
//! fitted with the parameters ([`fit`]). The place is what the bursts of all recordings have in common ([`search`]).

mod fit;
pub(crate) mod pulse;
pub(crate) mod report;
pub(crate) mod search;
mod trace;

#[cfg(test)]
mod tests;
