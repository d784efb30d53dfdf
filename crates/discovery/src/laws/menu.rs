//! Which laws can be asked about in a recording.

use crate::laws::modes::Modes;
use crate::laws::motion::Motion;
use crate::laws::sensitivity::Sensitivities;
use estimation::data::case::Waveform;
use estimation::data::study::{Study, Trial};
use motor::effect::curve::{Action, Coordinate, Place};
use motor::effect::{EffectConfig, Plant};

/// Least change of the supply frequency, Hz.
const LEAST_FREQUENCY: f64 = 5.0;
/// Least change of the load, share of rated torque.
const LEAST_LOAD: f64 = 0.2;
/// Least change of the speed, share of synchronous speed.
const LEAST_SPEED: f64 = 0.02;
/// Least change of the voltage at one frequency, share of rated voltage.
const LEAST_VOLTAGE: f64 = 0.1;
/// Least range of any other coordinate, share of its largest value.
const LEAST_RANGE: f64 = 1e-3;

/// Share of what a recording visits by which a curve is continued at each end where other recordings go on.
const CONTINUED: f64 = 0.5;

/// Laws of nothing over what the recording visits.
pub(crate) fn menu(waveform: &Waveform, plant: &Plant, motion: &Motion) -> Vec<EffectConfig> {
    let ask = |action: Action| {
        let range = motion.range(action.place, action.coordinate);
        let asked = is_judged(waveform, action) && varies(motion, plant, action, range);
        asked.then(|| Modes::absent(action, range))
    };
    Action::all().filter_map(ask).collect()
}

/// Motions of the recordings that prove, as a trial predicts them; none of load tables.
pub(super) fn elsewhere(study: &Study, trial: &Trial) -> Vec<Motion> {
    let waveforms = study.proofs.iter().filter_map(|s| s.case.waveform());
    let motion = |waveform| Sensitivities::of(waveform, &study.prior, &trial.fit).into_motion();
    waveforms.map(motion).collect()
}

/// Whether a curve over this coordinate can be continued: a turn is whole, and what rises over time in one recording need not rise in
/// the next.
fn goes_on(action: Action) -> bool {
    !action.coordinate.is_angle() && action.coordinate != Coordinate::Time
}

/// A range on to where the motor is `elsewhere`, of a coordinate that goes on.
pub(super) fn continued(action: Action, [low, high]: [f64; 2], elsewhere: &[Motion]) -> [f64; 2] {
    if !goes_on(action) {
        return [low, high];
    }
    let most = CONTINUED * (high - low);
    let range = |motion: &Motion| motion.range(action.place, action.coordinate);
    elsewhere.iter().map(range).fold([low, high], |of, there| {
        [
            of[0].min(there[0].max(low - most)),
            of[1].max(there[1].min(high + most)),
        ]
    })
}

/// Whether the recording can judge this place at all.
fn is_judged(waveform: &Waveform, action: Action) -> bool {
    match action.place {
        Place::Torque | Place::Friction => !waveform.speed_is_input,
        Place::SensorSpeed => waveform.judges_speed() && !waveform.speed_scale_is_free,
        _ => true,
    }
}

fn varies(motion: &Motion, plant: &Plant, action: Action, [low, high]: [f64; 2]) -> bool {
    let rated = &plant.rated;
    let change = high - low;
    let frequency = motion.range(Place::Torque, Coordinate::Frequency);
    let drive = frequency[1] - frequency[0] > LEAST_FREQUENCY;
    match action.coordinate {
        Coordinate::Frequency => drive,
        // Behind a drive voltage and frequency go together.
        Coordinate::Voltage => !drive && change > LEAST_VOLTAGE * rated.voltage,
        Coordinate::LoadTorque => change > LEAST_LOAD * rated.torque,
        Coordinate::Speed => change > LEAST_SPEED * rated.speed(),
        Coordinate::Angle | Coordinate::AngleElectrical | Coordinate::Time => true,
        _ => change > LEAST_RANGE * high.abs().max(low.abs()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A curve goes on to where the other recordings go, by half of its own range at most; over time and angles it does not.
    #[test]
    fn a_range_goes_on_to_where_other_recordings_go() {
        let place = Place::Torque;
        let over = |coordinate, range, elsewhere: &[Motion]| {
            continued(Action { place, coordinate }, range, elsewhere)
        };
        let to = |high: f64| Motion::of_frequencies(vec![10.0, high, high, high]);
        let range = [20.0, 50.0];
        assert_eq!(over(Coordinate::Frequency, range, &[]), range);
        assert_eq!(
            over(Coordinate::Frequency, range, &[to(40.0)]),
            [10.0, 50.0]
        );
        assert_eq!(
            over(Coordinate::Frequency, range, &[to(40.0), to(57.0)]),
            [10.0, 57.0]
        );
        assert_eq!(
            over(Coordinate::Frequency, range, &[to(100.0)]),
            [10.0, 65.0]
        );
        assert_eq!(over(Coordinate::Time, range, &[to(57.0)]), range);
        assert_eq!(over(Coordinate::Angle, range, &[to(57.0)]), range);
    }
}
