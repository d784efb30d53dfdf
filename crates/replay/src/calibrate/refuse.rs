//! Recordings that must not be learnt from: faulty ones, and ones that contradict each other.

use monitor::{Healthy, Row, magnitude, unexplained_current};
use motor::MotorFile;
use num_complex::Complex32;

use super::fit::{Beliefs, Fitted};
use super::pieces::Pieces;
use super::windows::{Healthily, Observed};
use super::{MonitorOf, Refusal, configured};
use crate::check::{Jump, LARGEST_CHANGE, jump, middle, strays_allowed};

/// Largest change of `I_2/I_1` inside healthy recordings of unchanged supply.
const LARGEST_UNBALANCE_CHANGE: f32 = LARGEST_CHANGE;

/// Refuses a fit that changed a parameter beyond belief.
pub fn implausible(
    beliefs: &Beliefs<'_>,
    fitted: &Fitted,
    recordings: &[&dyn Pieces],
) -> Result<(), Refusal> {
    let limits = beliefs.largest_changes();
    let mut changes = Fitted::causes().zip(fitted.changes.iter().zip(limits));
    match changes.find(|(_, (change, limit))| change.abs() > *limit) {
        None => Ok(()),
        Some((cause, (change, _))) => Err(Refusal::new(
            &names(recordings),
            format!(
                "{} would have to change by {:+.0} %: the motor file does not describe this motor, or it is not healthy; \
                 see what `drivemon explain` says",
                cause.fault().name(),
                100.0 * change
            ),
        )),
    }
}

/// What may remain of a residual after the fit, a share of its scale: several percent are an effect that the model misses, a fifth is
/// another motor, another scale or a late channel.
const LARGEST_MISFIT: f64 = 0.2;

/// Refuses a fit after which the model is still far from the recordings: thresholds as wide as that would hide every fault.
pub fn misfit(fitted: &Fitted, recordings: &[&dyn Pieces]) -> Result<(), Refusal> {
    let names_of_rows = ["torque balance", "e_d", "e_q"];
    let mut rows = names_of_rows.iter().zip(fitted.misfit);
    match rows.find(|(_, misfit)| *misfit > LARGEST_MISFIT) {
        None => Ok(()),
        Some((row, misfit)) => Err(Refusal::new(
            &names(recordings),
            format!(
                "{:.0} % of the scale of the {row} remain with the parameters that fit best: this is not the motor of the motor file, a scale is \
                 wrong (rms values, a clamp's factor), or channels are late; see what the audit of `drivemon check` and `drivemon explain` say",
                100.0 * misfit
            ),
        )),
    }
}

fn names(recordings: &[&dyn Pieces]) -> String {
    let names: Vec<&str> = recordings.iter().map(|one| one.name()).collect();
    names.join(", ")
}

/// How much the balance of the negative sequence scatters, a share of the voltage.
pub fn negative_scatter(
    motor: &MotorFile,
    observed: &[Observed],
    monitor_of: &MonitorOf<'_>,
) -> f64 {
    let unknown = Healthy::unknown();
    let value = |o: &Observed| {
        let monitor = monitor_of(motor, o.recording).ok()?;
        let rows = monitor.evidence(&unknown, &o.window)?.departure;
        let row = Row::Negative as usize;
        Some([f64::from(rows[row]), f64::from(rows[row + 1])])
    };
    let square = |o: &Observed| value(o).map_or(0.0, |[re, im]| o.weight * (re * re + im * im));
    observed.iter().map(square).sum()
}

/// Refuses recordings that the calibrated monitor would still call faulty: they differ from the others, or from themselves.
pub fn contradictions(
    motor: &MotorFile,
    sources: &[Healthily<'_>],
    observed: &[Observed],
) -> Result<(), Refusal> {
    changing_unbalance(sources, observed)?;
    changing_balance(motor, sources, observed)?;
    for source in sources {
        let config = configured(motor, source.head())?;
        let limit = config.healthy.map_or(f32::INFINITY, |h| h.significance);
        let (mut judged, mut alarms, mut first_s) = (0, 0, None);
        source.monitored(config, &mut |t, report| {
            if let Some(isolation) = &report.isolation {
                judged += 1;
                if isolation.significance > limit {
                    alarms += 1;
                    first_s.get_or_insert(t);
                }
            }
            Ok(())
        })?;
        if alarms > strays_allowed(judged) {
            return Err(Refusal::new(
                source.name(),
                format!(
                    "{alarms} of {judged} steady windows, first at {:.3} s, would light FAULT after calibration: this recording is not of \
                     the same healthy motor as the others, or the model misses an effect: see what `drivemon explain` says of it",
                    first_s.unwrap_or_default()
                ),
            ));
        }
    }
    Ok(())
}

/// The current's unbalance of a healthy motor follows its voltage's; with currents alone it must stand still within each
/// recording, and from one to the next.
fn changing_unbalance(sources: &[Healthily<'_>], observed: &[Observed]) -> Result<(), Refusal> {
    let without_voltage = |o: &&Observed| o.window.u_s.positive.norm_sqr() == 0.0;
    let all: Vec<&Observed> = observed.iter().filter(without_voltage).collect();
    let of = |k: usize| all.iter().copied().filter(move |o| o.recording == k);
    let middles: Vec<Complex32> = (0..sources.len())
        .map(|k| middle(of(k).map(unbalance)))
        .collect();
    let common = middle(middles.iter().copied());
    for (k, source) in sources.iter().enumerate() {
        let astray = |from: Complex32| {
            let beyond =
                move |o: &&Observed| magnitude(unbalance(o) - from) > LARGEST_UNBALANCE_CHANGE;
            let strays: Vec<&Observed> = of(k).filter(beyond).collect();
            let many = strays.len() > strays_allowed(of(k).count());
            strays.first().copied().filter(|_| many)
        };
        let from_others = magnitude(middles[k] - common) > LARGEST_UNBALANCE_CHANGE;
        let from = if from_others { common } else { middles[k] };
        if let Some(stray) = astray(from) {
            return Err(not_one_state(source.name(), stray, from));
        }
    }
    Ok(())
}

/// With voltages: what the supply does not explain of the currents' negative sequence must stand still, as a share of the rated
/// current, however load and supply change.
fn changing_balance(
    motor: &MotorFile,
    sources: &[Healthily<'_>],
    observed: &[Observed],
) -> Result<(), Refusal> {
    for (k, source) in sources.iter().enumerate() {
        let config = configured(motor, source.head())?;
        let of_recording = observed.iter().filter(|o| o.recording == k);
        let seen: Vec<(f64, Complex32)> = of_recording
            .filter_map(|o| {
                let current = unexplained_current(&config, &o.window)?;
                Some((o.t, current / config.rated_current))
            })
            .collect();
        if let Some(Jump { t, share }) = jump(&seen) {
            return Err(Refusal::new(
                source.name(),
                format!(
                    "a negative sequence of the currents that the voltages do not explain changes by {:.1} % of the rated current at {t:.3} s: \
                     this is not one healthy state; calibrate from recordings without a fault in them",
                    100.0 * share
                ),
            ));
        }
    }
    Ok(())
}

fn unbalance(o: &Observed) -> Complex32 {
    o.window.in_channels(o.window.i_s.unbalance())
}

fn not_one_state(name: &str, stray: &Observed, middle: Complex32) -> Refusal {
    let reason = format!(
        "negative over positive sequence of the currents stands {:.1} % from its middle at {:.3} s: this is not one healthy \
         state; calibrate from recordings without a fault in them",
        100.0 * magnitude(unbalance(stray) - middle),
        stray.t
    );
    Refusal::new(name, reason)
}
