//! What happens to the motor, again and again.

use motor::motor_file::Frame as MotorFrame;
use scenario::{Fault, Scenario};

use super::common;

/// The load doubles and halves, and the stator heats beyond measure: name, per cent, from and to, s.
const FAULTS: [(&str, f64, f64, f64); 2] = [("Bl", 100.0, 5.0, 9.0), ("Rs", 50.0, 12.0, 17.0)];
/// After so many seconds all of it comes again.
pub const ROUND_S: f64 = 20.0;
/// Seconds of a round with FAULT lit and dark for certain.
pub const FAULTY_S: f64 = 9.0 - 2.0 * LAG_S;
pub const HEALTHY_S: f64 = ROUND_S - 9.0 - 2.0 * LAG_S;
/// The mains sink to a share of their voltage, from and to, s: no fault of the motor.
const SINKS: (f64, f64, f64) = (0.75, 10.3, 10.7);
/// What lamps take to light or go out at most: filling a window (5 cycles) and persistence (3), twice over.
pub const LAG_S: f64 = 0.27;

/// A running motor for `seconds` with all of this.
pub fn lived_through(seconds: f64) -> Scenario {
    let mut scenario = common::scenario(seconds);
    let rounds = (seconds / ROUND_S) as u32;
    scenario.faults = (0..rounds).flat_map(faults_of).collect();
    let rated = scenario.supply.amplitude_volt.at(0.0);
    let (share, from_s, to_s) = SINKS;
    for round in 0..rounds {
        let begin = ROUND_S * f64::from(round);
        let volt = &mut scenario.supply.amplitude_volt;
        volt.change(begin + from_s, share * rated, 0.0);
        volt.change(begin + to_s, rated, 0.0);
    }
    scenario
}

fn faults_of(round: u32) -> Vec<Fault> {
    let begin = ROUND_S * f64::from(round);
    let fault = |(name, percent, from_s, to_s)| {
        let fault = Fault::percent(name, percent, MotorFrame::RotorFlux).expect("a known fault");
        Fault {
            from_s: begin + from_s,
            to_s: begin + to_s,
            ..fault
        }
    };
    FAULTS.into_iter().map(fault).collect()
}

/// Whether FAULT has to be lit at time `t`, s; `None` while it may change.
pub fn is_faulty(t: f64) -> Option<bool> {
    let t = t % ROUND_S;
    let settled = |at: f64| !(at..at + LAG_S).contains(&t);
    let begun = FAULTS
        .iter()
        .all(|(.., from, to)| settled(*from) && settled(*to));
    let faulty = FAULTS
        .iter()
        .any(|(.., from, to)| (*from..*to).contains(&t));
    begun.then_some(faulty)
}
