//! `[supply]`: amplitude, frequency, unbalance, harmonics and their steps.

use document::{Bounds, Section};
use motor::connection::phase_amplitude_of_line_rms;
use motor::dynamic::Harmonic;
use motor::motor_file::Nameplate;
use num_complex::Complex64;

/// A quantity made of straight pieces, in the order of time; the last holds for ever.
#[derive(Clone, Debug, PartialEq)]
pub struct Piecewise {
    pieces: Vec<Piece>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Piece {
    from_s: f64,
    value: f64,
    slope: f64,
    /// Integral from t = 0 to `from_s`.
    integral: f64,
}

impl Piecewise {
    /// The same value at all times.
    pub fn constant(value: f64) -> Piecewise {
        Piecewise {
            pieces: vec![Piece {
                from_s: 0.0,
                value,
                slope: 0.0,
                integral: 0.0,
            }],
        }
    }

    /// Goes on to `value`, beginning at `from_s` (not before the last piece) and within `ramp_s` (0: at once).
    pub fn change(&mut self, from_s: f64, value: f64, ramp_s: f64) {
        let before = self.at(from_s);
        if ramp_s > 0.0 {
            self.push(from_s, before, (value - before) / ramp_s);
        }
        self.push(from_s + ramp_s, value, 0.0);
    }

    fn push(&mut self, from_s: f64, value: f64, slope: f64) {
        let integral = self.integral(from_s);
        self.pieces.push(Piece {
            from_s,
            value,
            slope,
            integral,
        });
    }

    fn piece(&self, t: f64) -> &Piece {
        let next = self.pieces.partition_point(|piece| piece.from_s <= t);
        &self.pieces[next.saturating_sub(1)]
    }

    /// The value at time `t`, s.
    pub fn at(&self, t: f64) -> f64 {
        let piece = self.piece(t);
        piece.value + piece.slope * (t - piece.from_s)
    }

    /// The integral from 0 to `t`, s.
    pub fn integral(&self, t: f64) -> f64 {
        let piece = self.piece(t);
        let dt = t - piece.from_s;
        piece.integral + dt * (piece.value + 0.5 * piece.slope * dt)
    }

    /// The largest value that is ever reached.
    pub fn largest(&self) -> f64 {
        self.pieces
            .iter()
            .map(|piece| piece.value)
            .fold(f64::NEG_INFINITY, f64::max)
    }
}

/// What the supply does.
#[derive(Clone, Debug, PartialEq)]
pub struct SupplySpec {
    /// Phase amplitude of the positive sequence, V.
    pub amplitude_volt: Piecewise,
    /// Frequency, Hz.
    pub frequency_hz: Piecewise,
    /// Angle of the voltage vector at t = 0, rad; 0 puts phase a at its crest.
    pub phase_rad: f64,
    /// Time at which the motor is switched on, s; before it the terminals carry no voltage.
    pub switch_on_s: f64,
    /// Time at which the motor is switched off, s: its terminals are open from then on.
    pub switch_off_s: Option<f64>,
    /// Further rotating components relative to the positive sequence: negative sequence (order -1) and
    /// harmonics.
    pub components: Vec<Harmonic>,
}

impl SupplySpec {
    /// The rated supply, clean, from t = 0.
    pub fn rated(nameplate: &Nameplate) -> SupplySpec {
        SupplySpec {
            amplitude_volt: Piecewise::constant(nameplate.phase_voltage_amplitude()),
            frequency_hz: Piecewise::constant(nameplate.frequency_hz),
            phase_rad: 0.0,
            switch_on_s: 0.0,
            switch_off_s: None,
            components: Vec::new(),
        }
    }

    /// Whether the motor is connected at time `t`, s, or was never yet.
    pub fn is_closed(&self, t: f64) -> bool {
        self.switch_off_s.is_none_or(|off| t < off)
    }

    /// Whether there is neither unbalance nor a harmonic.
    pub fn is_clean(&self) -> bool {
        self.components.is_empty()
    }

    /// The highest fundamental frequency, Hz.
    pub fn highest_frequency_hz(&self) -> f64 {
        self.frequency_hz.largest()
    }
}

const VOLTAGE: Bounds = Bounds::above(0.0, 1e6, "V");
const FREQUENCY: Bounds = Bounds::between(1.0, 1000.0, "Hz");
const PERCENT: Bounds = Bounds::between(0.0, 200.0, "percent");
const SMALL_PERCENT: Bounds = Bounds::between(0.0, 50.0, "percent");
const ANGLE: Bounds = Bounds::between(-360.0, 360.0, "degrees");
const TIME: Bounds = Bounds::between(0.0, 86_400.0, "s");
const ORDER: Bounds = Bounds::between(-49.0, 49.0, "").hint("-5 turns backwards, +7 forwards");

pub(super) fn read(root: &Section<'_>, nameplate: &Nameplate) -> Option<SupplySpec> {
    let Some(section) = root.optional_section("supply")? else {
        return Some(SupplySpec::rated(nameplate));
    };
    let spec = read_values(&section, nameplate);
    section.finish();
    spec
}

fn read_values(section: &Section<'_>, nameplate: &Nameplate) -> Option<SupplySpec> {
    let rated = nameplate.voltage_line_rms_volt;
    let line_rms = section.number_or("voltage_line_rms_volt", &VOLTAGE, rated);
    let frequency = section.number_or("frequency_hz", &FREQUENCY, nameplate.frequency_hz);
    let phase = section.number_or("phase_deg", &ANGLE, 0.0);
    let switch_on = section.number_or("switch_on_s", &TIME, 0.0);
    let switch_off = read_switch_off(section, switch_on);
    let unbalance = read_unbalance(section);
    let harmonics = read_harmonics(section);
    let amplitude = line_rms.map(phase_amplitude_of_line_rms);
    let steps = read_steps(section, amplitude, frequency);
    let mut components = unbalance?;
    components.extend(harmonics?);
    let (amplitude_volt, frequency_hz) = steps?;
    Some(SupplySpec {
        amplitude_volt,
        frequency_hz,
        phase_rad: phase?.to_radians(),
        switch_on_s: switch_on?,
        switch_off_s: switch_off?,
        components,
    })
}

fn read_switch_off(section: &Section<'_>, on: Option<f64>) -> Option<Option<f64>> {
    let off = section.optional_number("switch_off_s", &TIME)?;
    if let (Some(on), Some(off)) = (on, off)
        && off <= on
    {
        section.report(
            "switch_off_s",
            format!("{off} s is not after switch_on_s = {on}: write a later time"),
        );
    }
    Some(off)
}

fn read_unbalance(section: &Section<'_>) -> Option<Vec<Harmonic>> {
    let percent = section.number_or("unbalance_percent", &SMALL_PERCENT, 0.0);
    let angle = section.number_or("unbalance_angle_deg", &ANGLE, 0.0);
    Some(component(-1.0, percent?, angle?).into_iter().collect())
}

fn read_harmonics(section: &Section<'_>) -> Option<Vec<Harmonic>> {
    let harmonics = section.sections("harmonics")?;
    let read: Option<Vec<_>> = harmonics.into_iter().map(read_harmonic).collect();
    Some(read?.into_iter().flatten().collect())
}

fn read_harmonic(section: Section<'_>) -> Option<Option<Harmonic>> {
    let order = section.number("order", &ORDER, "order and direction, such as -5 or 7");
    let percent = section.number("percent", &SMALL_PERCENT, "share of the fundamental");
    let angle = section.number_or("angle_deg", &ANGLE, 0.0);
    if let Some(order) = order
        && (order.fract() != 0.0 || [0.0, 1.0, -1.0].contains(&order))
    {
        section.report(
            "order",
            format!(
                "{order} is no harmonic: write a whole number other than -1, 0 and 1 \
                 (unbalance has its own key, unbalance_percent)"
            ),
        );
    }
    section.finish();
    Some(component(order?, percent?, angle?))
}

fn component(order: f64, percent: f64, angle_deg: f64) -> Option<Harmonic> {
    let amplitude = Complex64::from_polar(percent / 100.0, angle_deg.to_radians());
    (percent > 0.0).then_some(Harmonic { order, amplitude })
}

/// Steps of voltage (in percent of the supply's own) and frequency, each with its ramp.
fn read_steps(
    section: &Section<'_>,
    amplitude: Option<f64>,
    frequency: Option<f64>,
) -> Option<(Piecewise, Piecewise)> {
    let steps = section.sections("steps")?;
    let steps: Option<Vec<_>> = steps.into_iter().map(read_step).collect();
    let (amplitude, frequency) = (amplitude?, frequency?);
    let mut voltage = Piecewise::constant(amplitude);
    let mut hertz = Piecewise::constant(frequency);
    let mut free_from = 0.0;
    for step in steps? {
        if step.at_s < free_from {
            section.report(
                "steps",
                format!(
                    "the step at {} s begins before the one before it has ended, at {free_from} s: sort them",
                    step.at_s
                ),
            );
            return None;
        }
        free_from = step.at_s + step.ramp_s;
        if let Some(percent) = step.voltage_percent {
            voltage.change(step.at_s, amplitude * percent / 100.0, step.ramp_s);
        }
        if let Some(value) = step.frequency_hz {
            hertz.change(step.at_s, value, step.ramp_s);
        }
    }
    Some((voltage, hertz))
}

struct Step {
    at_s: f64,
    ramp_s: f64,
    voltage_percent: Option<f64>,
    frequency_hz: Option<f64>,
}

fn read_step(section: Section<'_>) -> Option<Step> {
    let at = section.number("at_s", &TIME, "when the step begins");
    let ramp = section.number_or("ramp_s", &TIME, 0.0);
    let voltage = section.optional_number("voltage_percent", &PERCENT);
    let frequency = section.optional_number("frequency_hz", &FREQUENCY);
    if voltage == Some(None) && frequency == Some(None) {
        section.report(
            "at_s",
            "this step changes nothing: add voltage_percent or frequency_hz",
        );
    }
    section.finish();
    Some(Step {
        at_s: at?,
        ramp_s: ramp?,
        voltage_percent: voltage?,
        frequency_hz: frequency?,
    })
}
