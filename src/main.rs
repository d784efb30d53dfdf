//! The board's firmware. On a host there is nothing to run, so it says where to go.

fn main() {
    println!("This package is the firmware. On a computer, start with: cargo run --release -p sim-host -- demo");
}
