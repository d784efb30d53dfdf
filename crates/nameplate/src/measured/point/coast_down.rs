//! Running out without a supply: `J dw/dt = -(T_b + k w^2)`.

use crate::measured::unknowns::{Machine, Unknown};

/// Speeds over rated speed at `times`, from `first` at time zero.
pub(super) fn speeds(machine: &Machine, first: f64, times: &[f64]) -> Vec<f64> {
    let rated_speed = machine.rated_speed * machine.base.rad_s;
    let loss = machine.rated_torque * machine.circuit.windage * machine.base.nm;
    let per_second = loss / (machine.get(Unknown::Inertia).exp() * rated_speed);
    let bearings = machine.bearings();
    let (steady, square) = (per_second * bearings, per_second * (1.0 - bearings));
    let (root, ratio) = ((steady * square).sqrt(), (square / steady).sqrt());
    let angle = (first.max(1e-3) * ratio).atan();
    let speed = |time: &f64| (angle - root * time).max(1e-6).tan() / ratio;
    times.iter().map(speed).collect()
}
