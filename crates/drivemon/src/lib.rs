//! The command line of `drivemon`: arguments, printing, exit codes. What a command does is in the crates behind it.

pub mod cli;
