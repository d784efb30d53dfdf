//! What the calibrated motor still shows: means, scatter, thresholds.

use monitor::{Cause, Conditions, Evidence, Healthy, Monitor, ROWS, Rehearsal, Row};
use motor::MotorFile;
use motor::motor_file::{CalibratedRange, HealthySettings};
use num_complex::Complex64;
use statrs::distribution::{ContinuousCDF, Normal};

use super::fit::Fitted;
use super::windows::Observed;
use super::{MonitorOf, Refusal};
use super::{losses, negative};

/// Least scatter of a row, percent: linearity of transformers and dividers.
const LEAST_SCATTER_PERCENT: f64 = 0.02;
/// Gain of a clamped or uncalibrated current transformer from one recording to the next, percent: between five healthy
/// recordings of one laboratory motor it moved by 5 % in one channel, by less than 1 % in the others.
const TRANSFORMER_REPEATABILITY_PERCENT: f64 = 2.0;
/// Largest uncertainty that a motor file takes, percent.
const LARGEST_SHARE_PERCENT: f64 = 1000.0;
/// Rows of the positive sequence, whose mean is zero by the fit.
const POSITIVE_ROWS: usize = 3;

/// What is known about the surroundings of the healthy motor.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings {
    /// Windings are at most this much warmer or colder than in the recordings, K.
    pub winding_kelvin: f64,
    /// FAULT lamps per judged window that are accepted.
    pub false_alarm_rate: f64,
}

impl Default for Surroundings {
    /// 75 K, the rise of a class-B winding, and one false alarm in a million windows.
    fn default() -> Self {
        Surroundings {
            winding_kelvin: 75.0,
            false_alarm_rate: 1e-6,
        }
    }
}

/// Statistics of the healthy motor over all windows.
///
/// # Errors
/// Values that the core does not take.
pub fn healthy(
    fitted: &Fitted,
    observed: &[Observed],
    surroundings: &Surroundings,
    monitor_of: &MonitorOf<'_>,
) -> Result<HealthySettings, Refusal> {
    let monitors = monitors(&|k| fitted.warmed(k), observed, monitor_of)?;
    let unknown = Healthy::unknown();
    let one = |o: &Observed| {
        Some((
            monitors[o.recording].evidence(&unknown, &o.window)?,
            o.weight,
        ))
    };
    let evidence: Vec<(Evidence, f64)> = observed.iter().filter_map(one).collect();
    let has_voltages = observed
        .iter()
        .all(|o| o.window.u_s.positive.norm_sqr() > 0.0);
    let (mean, scatter) = moments(&evidence);
    let conditions = |o: &Observed| monitors[o.recording].conditions(&o.window);
    let mut settings = HealthySettings {
        significance: significance(surroundings.false_alarm_rate),
        heating_percent: 100.0 * surroundings.winding_kelvin * COPPER_PER_KELVIN,
        ..HealthySettings::default()
    };
    if has_voltages {
        settings.mean_percent = mean;
        settings.scatter_percent = scatter;
        take_uncertainty(&mut settings, fitted);
        settings.range = range(observed.iter().filter_map(conditions));
        let uncertain =
            |o: &Observed| losses::uncertain_current_percent(&monitors[o.recording], &o.window);
        let place = &mut settings.iron_loss_percent;
        *place = place.hypot(observed.first().map_or(0.0, uncertain));
        settings.negative_drop_percent = negative::drop_percent(&evidence);
        let of_a_plate = fitted.motor.uncertainty.is_some();
        settings.negative_impedance_percent =
            100.0 * negative::impedance_error(&evidence, &settings, of_a_plate);
        doubt_half_of_leakage(&mut settings, fitted);
        if of_a_plate {
            doubt_one_inductance(&mut settings);
        }
    } else {
        let zero = Row::ZeroCurrent as usize;
        for row in [zero, zero + 1] {
            settings.mean_percent[row] = mean[row];
            settings.scatter_percent[row] = scatter[row];
        }
        settings.current_gain_percent = TRANSFORMER_REPEATABILITY_PERCENT;
        settings.supply_unbalance_percent *= left_open(observed);
    }
    set_current_unbalance(&mut settings, observed);
    let rated = fitted.motor.nameplate.current_amplitude();
    settings.current_unbalance_at_percent = 100.0 * mean_current(observed) / rated;
    Ok(settings)
}

/// The smallest range that holds them all; `None` without any.
fn range(all: impl Iterator<Item = Conditions>) -> Option<CalibratedRange> {
    let of_one = |at: Conditions| {
        let [current, volt_per_hertz, frequency] =
            [at.current, at.volt_per_hertz, at.frequency].map(|share| 100.0 * f64::from(share));
        CalibratedRange {
            current_percent: current,
            volt_per_hertz_percent: [volt_per_hertz; 2],
            frequency_percent: [frequency; 2],
            active_percent: 100.0 * f64::from(at.active),
        }
    };
    let both = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
    all.map(of_one).reduce(|a, b| CalibratedRange {
        current_percent: a.current_percent.max(b.current_percent),
        volt_per_hertz_percent: both(a.volt_per_hertz_percent, b.volt_per_hertz_percent),
        frequency_percent: both(a.frequency_percent, b.frequency_percent),
        active_percent: a.active_percent.min(b.active_percent),
    })
}

/// Relative change of copper's resistance per kelvin at 20 degC (IEC 60028).
pub(crate) const COPPER_PER_KELVIN: f64 = 0.003_93;

fn monitors(
    motor_of: &dyn Fn(usize) -> MotorFile,
    observed: &[Observed],
    monitor_of: &MonitorOf<'_>,
) -> Result<Vec<Monitor>, Refusal> {
    let last = observed.iter().map(|o| o.recording).max().unwrap_or(0);
    (0..=last).map(|k| monitor_of(&motor_of(k), k)).collect()
}

/// Mean and scatter of every row, percent; 0 where a row is not known.
fn moments(evidence: &[(Evidence, f64)]) -> ([f64; ROWS], [f64; ROWS]) {
    let (mut mean, mut scatter) = ([0.0; ROWS], [0.0; ROWS]);
    let votes: f64 = evidence.iter().map(|(_, weight)| weight).sum();
    for row in 0..ROWS {
        if !evidence.iter().all(|(e, _)| e.known()[row]) {
            continue;
        }
        let value = |e: &Evidence| 100.0 * f64::from(e.in_channels()[row]);
        if row >= POSITIVE_ROWS {
            mean[row] = evidence.iter().map(|(e, w)| w * value(e)).sum::<f64>() / votes;
        }
        let square = |(e, w): &(Evidence, f64)| w * (value(e) - mean[row]).powi(2);
        let variance = evidence.iter().map(square).sum::<f64>() / votes;
        scatter[row] = variance.sqrt().max(LEAST_SCATTER_PERCENT);
    }
    (mean, scatter)
}

/// What the fit leaves uncertain, on top of what a sound installation may drift by.
fn take_uncertainty(settings: &mut HealthySettings, fitted: &Fitted) {
    let places = [
        &mut settings.stator_resistance_percent,
        &mut settings.rotor_resistance_percent,
        &mut settings.magnetizing_inductance_percent,
        &mut settings.leakage_percent,
        &mut settings.friction_percent,
    ];
    let has_friction = fitted.motor.mechanics.total_friction() > 0.0;
    let seen = [true, true, true, true, has_friction];
    for ((place, error), seen) in places.into_iter().zip(&fitted.seen_through).zip(seen) {
        if seen {
            *place = place.hypot(100.0 * error).min(LARGEST_SHARE_PERCENT);
        }
    }
}

/// Recordings at voltages that differ as their loads do let leakage and resistance take what an iron that saturates does, of which a plate
/// says nothing: the one inductance of all of them may be half of their difference off.
fn doubt_one_inductance(settings: &mut HealthySettings) {
    let Some(range) = &settings.range else { return };
    let [low, high] = range.volt_per_hertz_percent;
    let place = &mut settings.magnetizing_inductance_percent;
    *place = place.hypot(0.5 * (high - low)).min(LARGEST_SHARE_PERCENT);
}

/// What a fit has put down to leakage may be an effect, which leaves the negative sequence's impedance as it was.
fn doubt_half_of_leakage(settings: &mut HealthySettings, fitted: &Fitted) {
    let causes = Fitted::causes().zip(&fitted.changes);
    let leakage = causes.filter(|(cause, _)| *cause == Cause::Leakage);
    let place = &mut settings.negative_impedance_percent;
    for (_, change) in leakage {
        let doubt = 100.0 * EFFECT_IN_LEAKAGE * change;
        *place = place.hypot(doubt).min(LARGEST_SHARE_PERCENT);
    }
}

/// Share of a leakage's change that may be an effect which the file lacks: the impedance to the negative sequence, which is mostly leakage,
/// then stays as it was.
const EFFECT_IN_LEAKAGE: f64 = 0.5;

/// What recordings leave of a belief about how the unseen supply changes: they count beside [`BELIEVED_CHANGES`], and what they show of its
/// changes is in their scatter.
fn left_open(observed: &[Observed]) -> f64 {
    let recordings = observed.iter().map(|o| o.recording + 1).max().unwrap_or(1);
    let changes = (recordings - 1) as f64;
    (BELIEVED_CHANGES / (BELIEVED_CHANGES + changes)).sqrt()
}

/// Changes between recordings that weigh as much as what is believed beforehand.
const BELIEVED_CHANGES: f64 = 2.0;

/// Mean of the positive sequence of the currents, A.
fn mean_current(observed: &[Observed]) -> f64 {
    let votes: f64 = observed.iter().map(|o| o.weight).sum();
    let current = |o: &Observed| o.weight * f64::from(o.window.i_s.positive.norm());
    observed.iter().map(current).sum::<f64>() / votes
}

fn set_current_unbalance(settings: &mut HealthySettings, observed: &[Observed]) {
    let ratio = |o: &Observed| {
        let ratio = o.window.in_channels(o.window.i_s.unbalance());
        Complex64::new(f64::from(ratio.re), f64::from(ratio.im)) * 100.0
    };
    let votes: f64 = observed.iter().map(|o| o.weight).sum();
    let mean = observed
        .iter()
        .map(|o| ratio(o) * o.weight)
        .sum::<Complex64>()
        / votes;
    let square: f64 = observed
        .iter()
        .map(|o| o.weight * (ratio(o) - mean).norm_sqr())
        .sum();
    settings.current_unbalance_percent = [mean.re, mean.im];
    // Two real parts share the squared distance.
    let scatter = (0.5 * square / votes).sqrt();
    settings.current_unbalance_scatter_percent = scatter.max(LEAST_SCATTER_PERCENT);
}

/// Standard deviations that any of the causes exceeds in `rate` of the windows by chance: normal, both tails, Bonferroni.
pub fn significance(rate: f64) -> f64 {
    let tail = rate / (2.0 * (monitor::CAUSES as f64 + 1.0));
    -Normal::standard().inverse_cdf(tail)
}

/// Thresholds of r1..r4 that the healthy motor keeps, with gains as far off as a sound installation drifts, percent.
///
/// # Errors
/// Values that the core does not take.
pub fn thresholds(
    motor: &MotorFile,
    observed: &[Observed],
    monitor_of: &MonitorOf<'_>,
) -> Result<[f64; 4], Refusal> {
    let monitors = monitors(&|_| motor.clone(), observed, monitor_of)?;
    let mut largest = [0.0_f64; 4];
    for gains in drifted() {
        for o in observed {
            let monitor = &monitors[o.recording];
            let healthy = monitor.config().healthy.unwrap_or_else(Healthy::unknown);
            let residuals = monitor.residuals(&healthy, &gains, &o.window);
            let residuals = residuals.unwrap_or_default();
            for (largest, r) in largest.iter_mut().zip(residuals.r) {
                *largest = largest.max(100.0 * f64::from(r).abs());
            }
        }
    }
    Ok(largest.map(|r| MARGIN * r + LEAST_SCATTER_PERCENT))
}

/// Gains that are three of their standard uncertainties off: as they are, and voltage or current more or less.
fn drifted() -> [Rehearsal; 5] {
    let as_is = Rehearsal::default();
    let off = (3.0 * HealthySettings::default().voltage_gain_percent / 100.0) as f32;
    let voltage = |gain| Rehearsal {
        voltage_gain: gain,
        ..as_is
    };
    let current = |gain| Rehearsal {
        current_q_gain: gain,
        ..as_is
    };
    let (more, less) = (1.0 + off, 1.0 - off);
    [
        as_is,
        voltage(more),
        voltage(less),
        current(more),
        current(less),
    ]
}

/// Thresholds stand this much beyond the largest healthy residual.
const MARGIN: f64 = 1.2;

#[cfg(test)]
mod tests {
    use super::*;

    /// 0.2 % as of any sound motor, and half of 6 %.
    #[test]
    fn one_inductance_of_two_voltages_may_be_half_of_their_difference_off() {
        let mut settings = HealthySettings {
            range: Some(CalibratedRange {
                current_percent: 100.0,
                volt_per_hertz_percent: [97.0, 103.0],
                frequency_percent: [100.0; 2],
                active_percent: 40.0,
            }),
            ..HealthySettings::default()
        };
        doubt_one_inductance(&mut settings);
        let expected = 0.2_f64.hypot(3.0);
        assert!((settings.magnetizing_inductance_percent - expected).abs() < 1e-12);
    }

    /// Two-sided 42 x 2.4e-8 is the tail beyond 5.46 (tables of the normal distribution: 5.45 leaves 2.5e-8).
    #[test]
    fn a_millionth_over_all_causes_is_five_and_a_half_deviations() {
        assert!(
            (significance(1e-6) - 5.46).abs() < 0.02,
            "{}",
            significance(1e-6)
        );
    }
}
