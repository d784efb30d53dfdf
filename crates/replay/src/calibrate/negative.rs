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

/// What a window shows: what is left of the balance, what the modelled impedance drops, and its vote.
type Shown = (Complex64, Complex64, f64);

/// How far the impedance may be off, a share of it; `of_a_plate`: a plate alone tells the circuit.
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
    let shown = evidence
        .iter()
        .map(|(e, weight)| (balance(e), drop(e), *weight));
    uncorrected(shown, re.hypot(im), [gains, error]).max(LEAST)
}

/// Root mean square of an error that is not corrected: its mean and its standard deviation by least squares over
/// `balance = gains + error drop`, where windows scatter and gains and error have these deviations beforehand.
fn uncorrected(shown: impl Iterator<Item = Shown>, scatter: f64, [gains, error]: [f64; 2]) -> f64 {
    let mut ones = gains.powi(-2);
    let mut squares = error.powi(-2);
    let [mut mixed, mut of_gains, mut of_error] = [Complex64::default(); 3];
    for (balance, drop, weight) in shown {
        let weight = weight / (scatter * scatter);
        ones += weight;
        mixed += drop * weight;
        squares += drop.norm_sqr() * weight;
        of_gains += balance * weight;
        of_error += drop.conj() * balance * weight;
    }
    let determinant = ones * squares - mixed.norm_sqr();
    let mean = (of_error * ones - mixed.conj() * of_gains) / determinant;
    mean.norm().hypot((ones / determinant).sqrt())
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

#[cfg(test)]
mod tests {
    use super::*;

    const BELIEVED: [f64; 2] = [0.001, 0.3];

    fn close(x: f64, y: f64) {
        // The scatter of 1e-7 in a hundred windows leaves less than a thousandth.
        assert!((x - y).abs() < 1e-3 * y, "{x} {y}");
    }

    fn error_of(windows: [(Complex64, Complex64); 2]) -> f64 {
        let shown = windows.map(|(balance, drop)| (balance, drop, 100.0));
        uncorrected(shown.into_iter(), 1e-7, BELIEVED)
    }

    #[test]
    fn two_unbalances_tell_the_error_from_the_gains() {
        let (gain, error) = (Complex64::new(0.002, 0.001), Complex64::new(0.1, -0.2));
        let windows = [Complex64::new(0.003, 0.008), Complex64::new(-0.006, 0.002)]
            .map(|drop| (gain + error * drop, drop));
        close(error_of(windows), error.norm());
    }

    /// Of a balance that one unbalance shows, gains and error take their shares by variance; what is left open is the parallel of both.
    #[test]
    fn one_unbalance_leaves_open_which_it_was() {
        let (drop, balance) = (Complex64::new(0.0, 0.005), Complex64::new(0.002, 0.0));
        let [gains, error] = BELIEVED;
        let by_error = (error * drop.norm()).powi(2);
        let share = by_error / (by_error + gains * gains);
        let mean = share * balance.norm() / drop.norm();
        let open = error * (1.0 - share).sqrt();
        close(error_of([(balance, drop); 2]), mean.hypot(open));
    }

    #[test]
    fn a_balanced_supply_tells_nothing() {
        let nothing = (Complex64::new(0.001, 0.0), Complex64::default());
        close(error_of([nothing; 2]), BELIEVED[1]);
    }
}
