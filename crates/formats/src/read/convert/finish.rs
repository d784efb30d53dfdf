//! From raw columns to a recording in SI: units, line voltages, the third current, encoder counts.

use super::{clock, encoder, spikes};
use crate::read::plan::Plan;
use crate::read::samples::{Piece, Raw};
use recording::{
    Channel, Column, Error, Factor, Mapping, Metadata, Recording, Target, Unit, UnknownScale, delay,
};
use std::ops::Range;

/// The channels of a piece of a file; the rows beside it, which belong to other pieces, help to convert its ends.
pub(in crate::read) fn piece(
    file: &str,
    piece: Piece,
    plan: Plan,
    metadata: Metadata,
) -> Result<Recording, Error> {
    let kept = piece.kept;
    recording(file, piece.raw, plan, metadata, kept.clone())?.cut(kept)
}

/// The channels of all rows; spikes are counted in those that are `kept`.
pub(in crate::read) fn recording(
    file: &str,
    mut raw: Raw,
    plan: Plan,
    metadata: Metadata,
    kept: Range<usize>,
) -> Result<Recording, Error> {
    let mapping = &plan.mapping;
    let clock = clock::clock(file, &mut raw, mapping)?;
    let mut recording = Recording::over(file, clock.t, metadata)?;
    recording.assumptions = plan.notes;
    recording.assumptions.extend(clock.assumption);
    recording.reading = Box::new(plan.reading);
    recording.unknown_speed_scale = unknown_speed_scale(file, mapping)?;
    note_clock(&mut recording, &raw, mapping, plan.rate_is_declared);
    for (target, values) in raw.columns {
        if let Target::Channel(channel) = target {
            let values = converted(&recording, channel, values, mapping)?;
            let values = sound(&mut recording, channel, values, mapping, &kept);
            recording.set_column(channel, values)?;
        }
    }
    if plan.line_voltages {
        phase_voltages(&mut recording)?;
    }
    third_of_three(&mut recording, Channel::CURRENTS, "no neutral conductor")?;
    Ok(recording)
}

/// What the mapping leaves open of the speed.
///
/// # Errors
/// A count of encoder edges, whose scale is the encoder's.
fn unknown_speed_scale(file: &str, mapping: &Mapping) -> Result<Option<Box<UnknownScale>>, Error> {
    let speed = mapping.columns.get(&Target::Channel(Channel::SPEED));
    let Some(map) = speed.filter(|map| map.scale == Some(Factor::Unknown)) else {
        return Ok(None);
    };
    let unit = map
        .unit
        .unwrap_or_else(|| Unit::si(Channel::SPEED.quantity()));
    if unit.counts {
        let message = "a count of edges cannot have an unknown scale";
        let remedy = "give the encoder's pulses: --pulses-per-revolution N";
        return Err(Error::at(file, 0, "speed", message, remedy));
    }
    Ok(Some(Box::new(UnknownScale {
        unit,
        offset: map.offset,
    })))
}

fn note_clock(recording: &mut Recording, raw: &Raw, mapping: &Mapping, rate_is_declared: bool) {
    if let Some(rate_hz) = mapping.sample_rate_hz.filter(|_| !rate_is_declared) {
        let note = format!("one sample every 1/{rate_hz} s, user's assumption");
        recording.assumptions.push(note);
    }
    if raw.skipped > 0 {
        let note = format!(
            "{} rows without a number were dropped, as the user asked",
            raw.skipped
        );
        recording.assumptions.push(note);
    }
}

fn converted(
    recording: &Recording,
    channel: Channel,
    mut values: Column,
    mapping: &Mapping,
) -> Result<Column, Error> {
    let Some(map) = mapping.columns.get(&Target::Channel(channel)) else {
        return Ok(values);
    };
    let quantity = channel.quantity();
    let period = map.unit.and_then(|unit| unit.period);
    // Lent numbers stay where they are.
    if map.is_plain(quantity) {
        return Ok(values);
    }
    let readings = values.to_mut().iter_mut();
    readings.for_each(|x| *x = map.to_si(quantity, *x));
    if period.is_none() && !map.unit.is_some_and(|unit| unit.counts) {
        return Ok(values);
    }
    let mut sensors = recording.metadata.sensors.clone();
    let pulses = mapping.encoder_pulses_per_revolution;
    sensors.encoder_pulses_per_revolution = pulses.or(sensors.encoder_pulses_per_revolution);
    let speed = match period {
        Some(of) => encoder::speed_of_periods(recording.name(), &values, of, &sensors),
        None => encoder::speed(recording.name(), recording.t(), &values, &sensors),
    };
    speed.map(Column::from)
}

/// The values at the rows' times, free of spikes.
fn sound(
    recording: &mut Recording,
    channel: Channel,
    mut values: Column,
    mapping: &Mapping,
    kept: &Range<usize>,
) -> Column {
    if let Some(bridged) = spikes::bridge(recording.t(), &mut values, channel.quantity(), kept) {
        recording.note_bridged(channel, bridged);
    }
    let map = mapping.columns.get(&Target::Channel(channel));
    match map.and_then(|map| map.delay) {
        Some(delay) => {
            delay::at_row_times(recording.t(), &values, delay, recording.t_sample()).into()
        }
        None => values,
    }
}

/// Phase voltages from line voltages, zero sequence taken as 0: `va = (vab - vca)/3`, cyclically.
fn phase_voltages(recording: &mut Recording) -> Result<(), Error> {
    third_of_three(recording, Channel::VOLTAGES, "line voltages add up to 0")?;
    let Some([ab, bc, ca]) = recording.voltages() else {
        let message = "phase voltages need at least two line voltages";
        return Err(Error::at(
            recording.name(),
            0,
            "va",
            message,
            "add the columns vab and vbc",
        ));
    };
    let third = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| (x - y) / 3.0).collect();
    let phases: [Vec<f64>; 3] = [third(ab, ca), third(bc, ab), third(ca, bc)];
    for (channel, values) in Channel::VOLTAGES.into_iter().zip(phases) {
        recording.derive(channel, values)?;
    }
    Ok(())
}

/// Computes the one that is missing of three which add up to zero.
fn third_of_three(recording: &mut Recording, three: [Channel; 3], why: &str) -> Result<(), Error> {
    let missing = three.map(|channel| recording.channel(channel).is_none());
    let Some(k) = missing.iter().position(|missing| *missing) else {
        return Ok(());
    };
    let [first, second] = [three[(k + 1) % 3], three[(k + 2) % 3]];
    let (Some(x), Some(y)) = (recording.channel(first), recording.channel(second)) else {
        return Ok(());
    };
    let values = x.iter().zip(y).map(|(x, y)| -(x + y)).collect();
    recording.derive(three[k], values)?;
    if three == Channel::CURRENTS {
        let note = format!("{} = -({first} + {second}): {why}, assumed", three[k]);
        recording.assumptions.push(note);
    }
    Ok(())
}
