//! Behaviour across crates: simulated and real motors through core, replay and discovery. One program, because each program
//! links all of them.

mod beyond_calibration;
mod calibrate;
mod common;
mod constant_load;
mod faults;
mod missing_effect;
mod recorded;
mod rotor_bars;
mod rotor_unrest;
mod temperatures;
