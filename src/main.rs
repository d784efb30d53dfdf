//! The board's firmware. On a host there is nothing to run, so it says where to go.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod commissioning;
#[cfg(target_os = "none")]
mod configuration;
#[cfg(target_os = "none")]
mod events;
#[cfg(target_os = "none")]
mod firmware;
#[cfg(target_os = "none")]
mod hardware;
#[cfg(target_os = "none")]
mod panel;
#[cfg(target_os = "none")]
mod record;
#[cfg(target_os = "none")]
mod safety;
#[cfg(target_os = "none")]
mod updates;

#[cfg(not(target_os = "none"))]
fn main() {
    println!(
        "This package is the firmware. On a computer, start with: cargo run --release -p sim-host -- demo"
    );
}
