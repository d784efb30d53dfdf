//! Signals over the angle of the supply: its frequency may wander, its harmonics stay on whole orders.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;

use super::circuit::{CircuitSlip, between, phasor};

/// Below this share of the largest voltage the supply has no angle.
const PRESENT: f64 = 0.2;

/// Voltages, currents and the circuit's slip at equal steps of the supply's angle.
pub(super) struct Turned {
    /// Space vectors of the voltages, V.
    pub u: Vec<Complex64>,
    /// Space vectors of the currents, A.
    pub i: Vec<Complex64>,
    /// Slip by the circuit.
    pub slip: Vec<f64>,
    /// Steps in one cycle.
    pub per_cycle: usize,
    /// Time of each step, in samples of the recording.
    pub at: Vec<f64>,
    /// Angular frequency of the supply, rad/s.
    pub omega: f64,
}

impl Turned {
    /// `None` for less than two cycles.
    pub fn of(circuit: &CircuitSlip) -> Option<Turned> {
        let (omega, step) = (circuit.omega.abs(), circuit.step);
        let [u, i] = &circuit.vectors;
        let cycle = (TAU / omega / step).round() as usize;
        let lead = leads(u, omega, step, cycle);
        if lead.len() < 2 {
            return None;
        }
        let ahead = |sample: f64| between(&lead, sample / cycle as f64);
        let turns = (omega * step * (u.len() - 1) as f64 / TAU).floor() as usize;
        let at: Vec<f64> = (0..turns * cycle)
            .map(|k| {
                let angle = TAU * k as f64 / cycle as f64;
                let mut sample = angle / (omega * step);
                for _ in 0..3 {
                    sample = (angle - ahead(sample)) / (omega * step);
                }
                sample
            })
            .filter(|sample| (0.0..=(u.len() - 1) as f64).contains(sample))
            .collect();
        Some(Turned {
            u: at.iter().map(|&sample| interpolated(u, sample)).collect(),
            i: at.iter().map(|&sample| interpolated(i, sample)).collect(),
            slip: at
                .iter()
                .map(|&sample| circuit.slip[sample as usize])
                .collect(),
            per_cycle: cycle,
            at,
            omega,
        })
    }
}

/// By how much the voltage is ahead of a steady turn, rad, cycle by cycle; held where there is no voltage.
fn leads(u: &[Complex64], omega: f64, step: f64, cycle: usize) -> Vec<f64> {
    let phasors: Vec<Complex64> = u
        .chunks_exact(cycle)
        .enumerate()
        .map(|(k, chunk)| {
            phasor(chunk, omega, step)
                * Complex64::from_polar(1.0, -omega * (k * cycle) as f64 * step)
        })
        .collect();
    let largest = phasors.iter().map(|p| p.norm()).fold(0.0, f64::max);
    let mut last: Option<(Complex64, f64)> = None;
    let each = phasors.iter().map(|p| {
        if p.norm() > PRESENT * largest {
            let lead = last.map_or(0.0, |(before, lead)| lead + (before.conj() * p).arg());
            last = Some((*p, lead));
        }
        last.map_or(0.0, |(_, lead)| lead)
    });
    each.collect()
}

/// Neighbours to each side between which a signal is found: errors stay below 0.5 % up to 0.4 of the sampling rate.
const TAPS: usize = 12;

/// Through its neighbours, as a signal without anything above half the sampling rate runs (sinc with Hann's window).
fn interpolated(x: &[Complex64], at: f64) -> Complex64 {
    let nearest = (at.round() as usize).min(x.len() - 1);
    if (at - nearest as f64).abs() < 1e-6 {
        return x[nearest];
    }
    let first = at.floor() as usize;
    let t = at - first as f64;
    let sine = (PI * t).sin();
    let (mut sum, mut weights) = (Complex64::ZERO, 0.0);
    for k in 0..2 * TAPS {
        let off = t + TAPS as f64 - 1.0 - k as f64;
        let sign = if (k + TAPS).is_multiple_of(2) {
            -1.0
        } else {
            1.0
        };
        let taper = (PI * off / (2.0 * TAPS as f64)).cos().powi(2);
        let weight = sign * sine / (PI * off) * taper;
        // At the ends the last sample goes on.
        let place = (first + k + 1).saturating_sub(TAPS).min(x.len() - 1);
        sum += x[place] * weight;
        weights += weight;
    }
    sum / weights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_is_met_between_its_samples() {
        for rate in [0.01, 0.1, 0.3, 0.4, -0.35] {
            let turn = |at: f64| Complex64::from_polar(1.0, TAU * rate * at);
            let x: Vec<Complex64> = (0..200).map(|k| turn(f64::from(k))).collect();
            for k in 0..100 {
                let at = 50.0 + 0.937 * f64::from(k);
                let off = (interpolated(&x, at) - turn(at)).norm();
                assert!(off < 5e-3, "{rate} {at}: {off}");
            }
        }
    }
}
