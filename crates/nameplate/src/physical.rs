//! The circuit in SI units, as a motor file writes it.

use std::f64::consts::TAU;

use crate::circuit::{Cages, Circuit};
use crate::plate::Completed;

/// How many parameters a circuit has in a motor file.
pub const PHYSICAL: usize = 12;

/// Keys of a motor file, in the order of [`physical`].
pub const KEYS: [&str; PHYSICAL] = [
    "stator_resistance_ohm",
    "rotor_resistance_ohm",
    "stator_leakage_henry",
    "rotor_leakage_henry",
    "magnetizing_inductance_henry",
    "second_cage_share",
    "second_cage_leakage_ratio",
    "leakage_drop",
    "core_loss_resistance_ohm",
    "windage_nm_s2",
    "stray_load_torque_nm",
    "inertia_kg_m2",
];

/// Range of each parameter in a motor file.
pub const RANGES: [[f64; 2]; PHYSICAL] = [
    [1e-9, 1e5],
    [1e-9, 1e5],
    [1e-9, 100.0],
    [1e-9, 100.0],
    [1e-9, 1000.0],
    [0.0, 0.8],
    [0.05, 4.0],
    [0.0, 0.9],
    [1e-6, 1e9],
    [0.0, 1e9],
    [0.0, 1e9],
    [1e-9, 1e6],
];

/// Rotor resistance, both leakages and magnetizing inductance with equal leakages: the same machine at its terminals, rotor
/// quantities referred by `a^2 = L_s/L_r`.
pub fn with_equal_leakages([r_r, l_ls, l_lr, l_m]: [f64; 4]) -> [f64; 4] {
    let squared = (l_ls + l_m) / (l_lr + l_m);
    let magnetizing = squared.sqrt() * l_m;
    let leakage = l_ls + l_m - magnetizing;
    [squared * r_r, leakage, leakage, magnetizing]
}

/// Parameters of an equivalent star phase in the order of [`KEYS`]; inductances without current, resistances at rated load's
/// temperature.
pub fn physical(circuit: &Circuit, completed: &Completed) -> [f64; PHYSICAL] {
    physical_with_cages(circuit, completed, completed.knows_standstill())
}

/// As [`physical`], with the leakages of two cages where `two_cages`, of one otherwise.
pub(crate) fn physical_with_cages(
    circuit: &Circuit,
    completed: &Completed,
    two_cages: bool,
) -> [f64; PHYSICAL] {
    let ohm = completed.base_impedance_ohm();
    let omega = TAU * completed.frequency_hz;
    let henry = ohm / omega / circuit.saturation_without_current();
    let cages = Cages::of(circuit);
    let rating = completed.targets.rating();
    let speed = omega / f64::from(completed.pole_pairs) * (1.0 - rating.slip * circuit.slip_ratio);
    let torque = 1000.0 * completed.power_kw / speed;
    let machine = [
        cages.rotor_resistance * ohm,
        circuit.leakage * henry,
        cages.rotor_leakage * henry,
        circuit.magnetizing * ohm / omega,
    ];
    // One cage: the leakages' split is convention, and equal ones are the usual one.
    let [r_r, l_ls, l_lr, l_m] = if two_cages {
        machine
    } else {
        with_equal_leakages(machine)
    };
    [
        circuit.stator_resistance * ohm,
        r_r,
        l_ls,
        l_lr,
        l_m,
        cages.second_cage_share,
        cages.second_cage_leakage_ratio,
        circuit.leakage_drop().max(1e-9),
        ohm / circuit.core_conductance,
        circuit.windage * torque / (speed * speed),
        circuit.stray * torque,
        completed.inertia.value,
    ]
}
