//! The studies are the examples of this package: `cargo run --release -p studies --example evidence`.
