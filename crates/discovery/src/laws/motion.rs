//! What a recording visits: the quantities over which a law may act, as the fitted model has them.

use crate::data::case::Case;
use crate::model::prediction::{Drive, SpeedObserver, run};
use motor::TParams;
use motor::dynamic::clarke;
use motor::effect::Plant;
use motor::effect::curve::{Coordinate, Place};
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
    phase: Vec<f64>,
    flux: Vec<f64>,
    frequency: Vec<f64>,
    voltage: Vec<f64>,
    load: Vec<f64>,
}

impl Motion {
    /// The motion of a plant on what drives a recording.
    pub fn of(case: &Case, plant: &Plant) -> Self {
        let drive = Drive::of(case);
        let outputs = run(case, plant, &drive, SpeedObserver::Off);
        let stride = case.between.stride();
        let t_step = case.inputs.t_sample * stride as f64;
        let n_p = plant.mechanics.n_p;
        let omega_sync = |k: usize| {
            let all = &case.timeline.omega_sync;
            all[(k * stride).min(all.len() - 1)]
        };
        let i_s: Vec<Complex64> = outputs.i_s_abc.iter().map(|i| clarke(*i)).collect();
        let fluxes = air_gap_flux(&plant.motor, &i_s, &outputs.omega_mech, n_p, t_step);
        let rotor = |(flux, i): (&Complex64, &Complex64)| (flux / plant.motor.l_m - i).norm();
        let slip = |(k, w): (usize, &f64)| (omega_sync(k) - n_p * w) / TAU;
        Self {
            slip: outputs.omega_mech.iter().enumerate().map(slip).collect(),
            frequency: (0..i_s.len()).map(|k| omega_sync(k) / TAU).collect(),
            voltage: (0..i_s.len())
                .map(|k| case.inputs.u_s[k * stride].norm())
                .collect(),
            load: (0..i_s.len())
                .map(|k| case.inputs.tau_load[k * stride])
                .collect(),
            stator: i_s.iter().map(|i| i.norm()).collect(),
            rotor: fluxes.iter().zip(&i_s).map(rotor).collect(),
            flux: fluxes.iter().map(|flux| flux.norm()).collect(),
            phase: outputs.i_s_abc.iter().map(|i| i[0]).collect(),
            duration: case.timeline.clock(t_step * i_s.len() as f64),
            speed: outputs.omega_mech,
            t_step,
        }
    }

    fn values(&self, place: Place, coordinate: Coordinate) -> &[f64] {
        match coordinate {
            Coordinate::Speed => &self.speed,
            Coordinate::Slip => &self.slip,
            Coordinate::Current if place == Place::Rotor => &self.rotor,
            Coordinate::Current => &self.stator,
            Coordinate::PhaseCurrent => &self.phase,
            Coordinate::Flux => &self.flux,
            Coordinate::Frequency => &self.frequency,
            Coordinate::Voltage => &self.voltage,
            Coordinate::LoadTorque => &self.load,
            Coordinate::Angle | Coordinate::AngleElectrical | Coordinate::Time => &[],
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
            Coordinate::Speed => [values[0].min(low), high],
            _ => [low, high],
        }
    }
}

/// Air-gap flux linkage, V s, by the rotor's own equation from stator current and speed (theory, section 2).
fn air_gap_flux(
    motor: &TParams<f64>,
    i_s: &[Complex64],
    omega_mech: &[f64],
    n_p: f64,
    h: f64,
) -> Vec<Complex64> {
    let l_r = motor.l_r();
    let (decay, coupling) = (motor.r_r / l_r, motor.l_m / l_r);
    let mut psi_r = Complex64::new(0.0, 0.0);
    let step = |(i, w): (&Complex64, &f64)| {
        let flux = (psi_r + i * motor.l_lr) * coupling;
        let fed = psi_r + (i * motor.l_m - psi_r) * (1.0 - (-decay * h).exp());
        psi_r = fed * Complex64::from_polar(1.0, n_p * w * h);
        flux
    };
    i_s.iter().zip(omega_mech).map(step).collect()
}
