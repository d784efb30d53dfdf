//! Faults that a study puts into its machines.

use scenario::{Asymmetry, Change, Fault, Parameter, Probe, Target};

/// A fault and its name; from the first sample on.
pub struct Broken(pub &'static str, pub Fault);

/// Those that a calibration should show wherever the motor runs.
pub fn faults() -> Vec<Broken> {
    let one = |name, target, factor| {
        let change = Change::Factor(factor);
        let (from_s, to_s) = (0.0, f64::INFINITY);
        let fault = Fault {
            target,
            change,
            from_s,
            to_s,
        };
        Broken(name, fault)
    };
    vec![
        one("one current +5 %", Target::Probe(Probe::Current(0)), 1.05),
        one("one voltage +5 %", Target::Probe(Probe::Voltage(0)), 1.05),
        one("speed -2 %", Target::Probe(Probe::Speed), 0.98),
        one(
            "resistance in phase b +50 %",
            Target::Asymmetry(Asymmetry::Series(1)),
            1.5,
        ),
        one("Lm -30 %", Target::Parameter(Parameter::Lm), 0.7),
    ]
}
