//! How far the motor's impedance to the negative sequence may be from the model's, as the healthy motor shows it.
//!
//! What is left of the negative sequence's balance is the channels' gains, the same in every window, and the error of the impedance, which follows the
//! supply's unbalance. Recordings whose unbalance differs tell them apart; one alone leaves open which of both it was.

use monitor::{Evidence, Row};
use motor::motor_file::HealthySettings;
use num_complex::Complex64;

/// Standard deviation of the impedance's error before anything was seen, a share of it, of a circuit that was measured.
const MEASURED: f64 = 0.1;
/// Of a circuit that a plate tells: at a slip of nearly 2 the bars of a cage have 1.2 to 3 times the resistance that they have under load, and a
/// tenth to a third less leakage.
const OF_A_PLATE: f64 = 0.3;
/// What recordings teach at best: leakage follows the current, resistances follow the temperature.
const LEAST: f64 = 0.05;

/// Mean of what the supply's negative sequence dropped over the modelled impedance, percent of the positive sequence's voltage.
pub fn drop_percent(evidence: &[(Evidence, f64)]) -> [f64; 2] {
    let votes: f64 = evidence.iter().map(|(_, weight)| weight).sum();
    let drops = evidence.iter().map(|(e, weight)| drop(e) * *weight);
    let mean = drops.sum::<Complex64>() * (100.0 / votes);
    [mean.re, mean.im]
}

/// How far the impedance may be off, a share of it: the root mean square of an error that is not corrected.
///
/// Its mean and its standard deviation by least squares over `balance = gains + error drop`, with what is believed of gains and error
/// beforehand. `of_a_plate`: a plate alone tells the circuit.
pub fn impedance_error(
    evidence: &[(Evidence, f64)],
    settings: &HealthySettings,
    of_a_plate: bool,
) -> f64 {
    // Three channels whose gains are off by themselves leave their root mean square in each sequence.
    let gains = settings.voltage_gain_percent / 100.0 / 3_f64.sqrt();
    let error = if of_a_plate { OF_A_PLATE } else { MEASURED };
    let row = Row::Negative as usize;
    let [re, im] = [row, row + 1].map(|row| settings.scatter_percent[row] / 100.0);
    let precision = 1.0 / (re * re + im * im);
    let mut ones = 1.0 / (gains * gains);
    let mut squares = 1.0 / (error * error);
    let [mut mixed, mut of_gains, mut of_error] = [Complex64::default(); 3];
    for (e, weight) in evidence {
        let weight = weight * precision;
        let (balance, drop) = (balance(e), drop(e));
        ones += weight;
        mixed += drop * weight;
        squares += drop.norm_sqr() * weight;
        of_gains += balance * weight;
        of_error += drop.conj() * balance * weight;
    }
    let determinant = ones * squares - mixed.norm_sqr();
    let error = (of_error * ones - mixed.conj() * of_gains) / determinant;
    let deviation = (ones / determinant).sqrt();
    error.norm().hypot(deviation).max(LEAST)
}

fn drop(evidence: &Evidence) -> Complex64 {
    let drop = evidence.negative_drop();
    Complex64::new(f64::from(drop.re), f64::from(drop.im))
}

fn balance(evidence: &Evidence) -> Complex64 {
    let rows = evidence.in_channels();
    let row = Row::Negative as usize;
    Complex64::new(f64::from(rows[row]), f64::from(rows[row + 1]))
}
