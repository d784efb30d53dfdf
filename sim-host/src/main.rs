//! The `drivemon` command line.
fn main() {}
