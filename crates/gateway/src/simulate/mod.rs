//! Boards that are simulated: the motors are made up, the protocol, the log and the seconds are the real board's.

mod board;
mod capture;
mod flash;
mod life;
mod plant;
mod serial;
mod server;
mod truth;

pub use capture::{MOTOR_FILE, MOTOR_FILE_NAME};
pub use plant::{Plan, PlanError, Plant, Share};
pub use serial::answer_line;
pub use server::{listen, serve};
pub use truth::Truth;
