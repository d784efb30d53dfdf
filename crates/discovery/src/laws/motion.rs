//! What a recording visits: the quantities over which a law may act, as the fitted model has them.

use estimation::data::case::Waveform;
use motor::dynamic::clarke;
use motor::effect::curve::{Coordinate, Place};
use motor::effect::tangent::Tangent;
use motor::effect::{Outputs, Plant};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Begin of a recording that ranges leave out, s: the first instants of a switched-on motor.
const SETTLES: f64 = 0.05;
/// Share of the samples beyond a range at each end.
const BEYOND: f64 = 0.002;

/// Quantities of one recording, one value per step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Motion {
    /// Time between the values, s.
    pub t_step: f64,
    /// Time from the first to the last value, s, parts that were left out counted.
    duration: f64,
    speed: Vec<f64>,
    slip: Vec<f64>,
    stator: Vec<f64>,
    rotor: Vec<f64>,
    phases: [Vec<f64>; 3],
    flux: Vec<f64>,
    frequency: Vec<f64>,
    voltage: Vec<f64>,
    load: Vec<f64>,
    angle: Vec<f64>,
    angle_electrical: Vec<f64>,
    time: Vec<f64>,
}

impl Motion {
    /// The motion of a plant on what drives a recording, of a linearised run and its true outputs.
    pub fn of(waveform: &Waveform, plant: &Plant, tangent: &Tangent, outputs: &Outputs) -> Self {
        let stride = waveform.between.stride();
        let t_step = waveform.t_step();
        let n_p = plant.mechanics.n_p;
        let omega_sync = |k: usize| {
            let all = &waveform.timeline.omega_sync;
            all[(k * stride).min(all.len() - 1)]
        };
        let i_s: Vec<Complex64> = outputs.i_s_abc.iter().map(|i| clarke(*i)).collect();
        let air_gap = |(psi_s, i_s): (Complex64, &Complex64)| psi_s - i_s * plant.motor.l_ls;
        let fluxes: Vec<Complex64> = tangent.psi_s().zip(&i_s).map(air_gap).collect();
        let rotor = |(flux, i): (&Complex64, &Complex64)| (flux / plant.motor.l_m - i).norm();
        let slip = |(k, w): (usize, &f64)| (omega_sync(k) - n_p * w) / TAU;
        let steps = 0..i_s.len();
        let u_s = |k: usize| waveform.inputs.u_s[k * stride];
        Self {
            slip: outputs.omega_mech.iter().enumerate().map(slip).collect(),
            frequency: steps.clone().map(|k| omega_sync(k) / TAU).collect(),
            voltage: steps.clone().map(|k| u_s(k).norm()).collect(),
            angle_electrical: steps.clone().map(|k| u_s(k).arg()).collect(),
            load: steps
                .clone()
                .map(|k| waveform.inputs.tau_load[k * stride])
                .collect(),
            time: steps
                .map(|k| waveform.timeline.clock(t_step * k as f64))
                .collect(),
            stator: i_s.iter().map(|i| i.norm()).collect(),
            rotor: fluxes.iter().zip(&i_s).map(rotor).collect(),
            flux: fluxes.iter().map(|flux| flux.norm()).collect(),
            phases: [0, 1, 2].map(|p| outputs.i_s_abc.iter().map(|i| i[p]).collect()),
            duration: waveform.timeline.clock(t_step * i_s.len() as f64),
            speed: outputs.omega_mech.clone(),
            angle: outputs.theta_mech.clone(),
            t_step,
        }
    }

    /// Values of a coordinate, one per step.
    pub fn values(&self, place: Place, coordinate: Coordinate) -> &[f64] {
        match coordinate {
            Coordinate::Speed => &self.speed,
            Coordinate::Slip => &self.slip,
            Coordinate::Current if place == Place::Rotor => &self.rotor,
            Coordinate::Current => &self.stator,
            Coordinate::PhaseCurrent => &self.phases[place.phase().unwrap_or(0)],
            Coordinate::Flux => &self.flux,
            Coordinate::Frequency => &self.frequency,
            Coordinate::Voltage => &self.voltage,
            Coordinate::LoadTorque => &self.load,
            Coordinate::Angle => &self.angle,
            Coordinate::AngleElectrical => &self.angle_electrical,
            Coordinate::Time => &self.time,
        }
    }

    /// Lowest and highest value that the recording visits.
    pub fn range(&self, place: Place, coordinate: Coordinate) -> [f64; 2] {
        match coordinate {
            Coordinate::Angle | Coordinate::AngleElectrical => return [0.0, TAU],
            Coordinate::Time => return [0.0, self.duration],
            _ => {}
        }
        let begin = (SETTLES / self.t_step) as usize;
        let mut values = self.values(place, coordinate).to_vec();
        let at_first = values.first().copied().unwrap_or(0.0);
        values.drain(..begin.min(values.len() / 2));
        values.retain(|x| x.is_finite());
        if values.is_empty() {
            return [0.0, 0.0];
        }
        values.sort_by(f64::total_cmp);
        let last = values.len() - 1;
        let at = |share: f64| values[(share * last as f64) as usize];
        let [low, high] = [at(BEYOND), at(1.0 - BEYOND)];
        match coordinate {
            // Both half waves: a drop over the current is asked on both sides.
            Coordinate::PhaseCurrent => {
                let largest = low.abs().max(high.abs());
                [-largest, largest]
            }
            // A start from rest is short, and what happens there is asked about.
            Coordinate::Speed | Coordinate::Slip => [at_first.min(low), at_first.max(high)],
            _ => [low, high],
        }
    }
}

#[cfg(test)]
impl Motion {
    /// A motion of which only the supply frequency (Hz) is known, one value per second.
    pub fn of_frequencies(frequency: Vec<f64>) -> Self {
        Self {
            duration: frequency.len() as f64,
            frequency,
            t_step: 1.0,
            ..Self::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A small motor starts within two cycles of the supply, before the instants that ranges leave out are over.
    #[test]
    fn slip_and_speed_reach_to_the_standstill_of_a_start() {
        let t_step = 1e-3;
        let slip: Vec<f64> = (0..4000).map(|k| (50.0 - k as f64).max(2.0)).collect();
        let motion = Motion {
            speed: slip.iter().map(|slip| TAU * (50.0 - slip)).collect(),
            slip,
            duration: 4.0,
            t_step,
            ..Motion::default()
        };
        let range = |coordinate| motion.range(Place::Rotor, coordinate);
        assert_eq!(range(Coordinate::Slip), [2.0, 50.0]);
        assert_eq!(range(Coordinate::Speed), [0.0, TAU * 48.0]);
    }
}
