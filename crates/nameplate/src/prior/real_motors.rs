//! The prior fitted to the catalogue motors of `data/motors.csv`; the example `fit_prior` prints it, a test fits it again.

use super::Prior;

/// 304 catalogue motors of 0.12 to 1400 kW, nearly all for 50 Hz.
///
/// `between_makers`: with one maker left out, 1.35 holds 98.6 to 99.0 % of the breakdown and locked-rotor values; makers
/// outside these catalogues, NEMA designs above all, differ more than these makers do among themselves.
pub(super) const REAL_MOTORS: Prior = Prior {
    mean: [
        [-0.2756, -0.3475, -0.0035],
        [0.0002, -0.3067, 0.0069],
        [-0.0172, -0.0651, 0.0103],
        [1.1703, 0.0140, -0.0167],
        [0.9461, -0.0179, -0.0171],
        [1.9878, 0.0771, -0.0252],
    ],
    spread: [0.3089, 0.2308, 0.1725, 0.1479, 0.1815, 0.1639],
    correlation: [
        [1.0000, 0.7772, 0.1323, -0.3957, -0.3430, -0.5929],
        [0.7772, 1.0000, 0.1055, -0.3819, -0.3965, -0.6074],
        [0.1323, 0.1055, 1.0000, -0.1787, 0.0634, -0.3660],
        [-0.3957, -0.3819, -0.1787, 1.0000, 0.5907, 0.6965],
        [-0.3430, -0.3965, 0.0634, 0.5907, 1.0000, 0.4194],
        [-0.5929, -0.6074, -0.3660, 0.6965, 0.4194, 1.0000],
    ],
    between_makers: 1.35,
    inertia: [-2.7580, 1.3686, 0.0237, 1.3538],
    inertia_spread: 0.3768,
};
