//! The board's loader: the first program after each reset. It checks a new program's signature, exchanges it for the old
//! one, brings the old one back, or just starts what is there (crates/update decides). On a host there is nothing to run.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod faults;
#[cfg(target_os = "none")]
mod flash;
#[cfg(target_os = "none")]
mod lamps;
#[cfg(target_os = "none")]
mod loader;
#[cfg(target_os = "none")]
mod program;
#[cfg(target_os = "none")]
mod supply;
#[cfg(target_os = "none")]
mod watchdog;

#[cfg(not(target_os = "none"))]
fn main() {
    println!(
        "This package is the board's loader. Build it with: tools/thumb build --release -p loader"
    );
}
