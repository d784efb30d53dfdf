//! The command line of `drivemon`: arguments, printing, exit codes. What a command does stands in the crates behind it.

pub mod cli;
