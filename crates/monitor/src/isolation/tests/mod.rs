//! The isolation against motors in steady state, solved in double precision by the crate `motor`.

mod causes;
mod covariance;
mod degenerate;
mod plant;
mod temperature;
mod weights;
