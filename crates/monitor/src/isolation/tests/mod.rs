//! The isolation against motors in steady state, solved in double precision by the crate `motor`.

mod causes;
mod covariance;
mod degenerate;
mod plant;
mod range;
mod temperature;
mod weights;
