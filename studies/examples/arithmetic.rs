//! How far `libm` and `micromath` are off in single precision, against double precision; a table for
//! docs/develop/dependencies.md: `cargo run --release -p studies --example arithmetic`.

use micromath::F32Ext;
use std::io::{self, Write};

/// Values at which a function is tried: so many, spread evenly.
const POINTS: u32 = 100_000;

/// A function of both libraries, and what it should give.
struct Function {
    name: &'static str,
    range: (f32, f32),
    exact: fn(f64) -> f64,
    libm: fn(f32) -> f32,
    micromath: fn(f32) -> f32,
    /// Whether the error counts in units of the function or as a share of its value.
    relative: bool,
}

const FUNCTIONS: [Function; 6] = [
    Function {
        name: "square root, 0.01 to 1000",
        range: (0.01, 1000.0),
        exact: f64::sqrt,
        libm: libm::sqrtf,
        micromath: |x| F32Ext::sqrt(x),
        relative: true,
    },
    Function {
        name: "sine, -pi to pi",
        range: (-std::f32::consts::PI, std::f32::consts::PI),
        exact: f64::sin,
        libm: libm::sinf,
        micromath: |x| F32Ext::sin(x),
        relative: false,
    },
    Function {
        name: "cosine, -pi to pi",
        range: (-std::f32::consts::PI, std::f32::consts::PI),
        exact: f64::cos,
        libm: libm::cosf,
        micromath: |x| F32Ext::cos(x),
        relative: false,
    },
    Function {
        name: "arctangent of y over 1, -20 to 20 (rad)",
        range: (-20.0, 20.0),
        exact: f64::atan,
        libm: libm::atanf,
        micromath: |x| F32Ext::atan2(x, 1.0),
        relative: false,
    },
    Function {
        name: "exponential, -20 to 5",
        range: (-20.0, 5.0),
        exact: f64::exp,
        libm: libm::expf,
        micromath: |x| F32Ext::exp(x),
        relative: true,
    },
    Function {
        name: "logarithm, 0.01 to 1000",
        range: (0.01, 1000.0),
        exact: f64::ln,
        libm: libm::logf,
        micromath: |x| F32Ext::ln(x),
        relative: false,
    },
];

impl Function {
    /// The largest error of `f` over the range.
    fn worst(&self, f: fn(f32) -> f32) -> f64 {
        let (low, high) = self.range;
        let points = (0..=POINTS).map(|k| low + (high - low) * (k as f32 / POINTS as f32));
        let error = |x: f32| {
            let exact = (self.exact)(f64::from(x));
            let error = (f64::from(f(x)) - exact).abs();
            if self.relative { error / exact } else { error }
        };
        points.map(error).fold(0.0, f64::max)
    }
}

fn main() -> io::Result<()> {
    let mut out = io::stdout().lock();
    writeln!(
        out,
        "| function | error counts | libm, largest error | micromath, largest error |"
    )?;
    writeln!(out, "|---|---|---|---|")?;
    for f in &FUNCTIONS {
        let counts = if f.relative { "relative" } else { "absolute" };
        let errors = [f.worst(f.libm), f.worst(f.micromath)];
        writeln!(
            out,
            "| {} | {counts} | {:.1e} | {:.1e} |",
            f.name, errors[0], errors[1]
        )?;
    }
    Ok(())
}
