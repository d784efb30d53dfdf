//! `[nameplate]`: what the plate on the housing says.

use document::{Bounds, Section};
use std::f64::consts::TAU;

/// How the three windings are connected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Connection {
    /// Star (wye): the phase voltage is the line voltage over the square root of three.
    Star,
    /// Delta: each winding sees the line voltage. Parameters are still per equivalent star phase.
    Delta,
}

/// Rated values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nameplate {
    /// Pole pairs, 1..=50.
    pub pole_pairs: u32,
    /// Rated shaft power, W.
    pub power_watt: f64,
    /// Rated line-to-line voltage, V rms.
    pub voltage_line_rms_volt: f64,
    /// Rated line current, A rms.
    pub current_rms_amp: f64,
    /// Rated supply frequency, Hz, 1..=1000.
    pub frequency_hz: f64,
    /// Rated shaft torque, N m.
    pub torque_nm: f64,
    /// Star or delta.
    pub connection: Connection,
    /// Rated speed, rpm, when the plate gives it.
    pub speed_rpm: Option<f64>,
    /// Bars of the cage, 5..=400, when somebody counted them or the maker says so.
    pub rotor_bars: Option<u32>,
}

impl Nameplate {
    /// Amplitude of the phase voltage of the equivalent star, V: line rms times `sqrt(2/3)`.
    pub fn phase_voltage_amplitude(&self) -> f64 {
        crate::connection::phase_amplitude_of_line_rms(self.voltage_line_rms_volt)
    }

    /// Amplitude of the line current, A; it is also the phase current of the equivalent star.
    pub fn current_amplitude(&self) -> f64 {
        crate::connection::amplitude_of_rms(self.current_rms_amp)
    }

    /// Rated supply angular frequency `w_s`, electrical rad/s.
    pub fn omega_sync(&self) -> f64 {
        TAU * self.frequency_hz
    }

    /// Synchronous speed of the shaft at rated frequency, mechanical rad/s.
    pub fn synchronous_speed_mech(&self) -> f64 {
        self.omega_sync() / f64::from(self.pole_pairs)
    }

    /// Rated speed of the shaft, mechanical rad/s: from `speed_rpm`, else power over torque, limited
    /// to synchronous speed (plates round their torque).
    pub fn rated_speed_mech(&self) -> f64 {
        match self.speed_rpm {
            Some(rpm) => rpm * TAU / 60.0,
            None => (self.power_watt / self.torque_nm).min(self.synchronous_speed_mech()),
        }
    }

    /// Rated slip, 0..1, from [`Nameplate::rated_speed_mech`].
    pub fn rated_slip(&self) -> f64 {
        1.0 - self.rated_speed_mech() / self.synchronous_speed_mech()
    }
}

const POLE_PAIRS: Bounds = Bounds::between(1.0, 50.0, "").hint("a 4-pole motor has 2 pole pairs");
const POWER: Bounds = Bounds::above(0.0, 1e9, "W");
const VOLTAGE: Bounds = Bounds::above(0.0, 1e6, "V");
const CURRENT: Bounds = Bounds::above(0.0, 1e6, "A");
const FREQUENCY: Bounds = Bounds::between(1.0, 1000.0, "Hz").hint("the supply's, not in rad/s");
const TORQUE: Bounds = Bounds::above(0.0, 1e8, "N m");
const SPEED: Bounds = Bounds::above(0.0, 60_000.0, "rpm");
const ROTOR_BARS: Bounds = Bounds::between(5.0, 400.0, "").hint("usually 7 to 30 per pole pair");
const CONNECTIONS: [(&str, Connection); 2] =
    [("star", Connection::Star), ("delta", Connection::Delta)];

pub(super) fn read(root: &Section<'_>) -> Option<Nameplate> {
    let section = root.section("nameplate", "the rated values of the plate")?;
    let nameplate = read_values(&section);
    if let Some(nameplate) = &nameplate {
        check_agreement(&section, nameplate);
    }
    section.finish();
    nameplate
}

fn read_values(section: &Section<'_>) -> Option<Nameplate> {
    let pole_pairs = section.integer("pole_pairs", &POLE_PAIRS, "pole pairs, half the poles");
    let power = section.number("power_watt", &POWER, "rated shaft power");
    let voltage = section.number(
        "voltage_line_rms_volt",
        &VOLTAGE,
        "rated line-to-line voltage, rms",
    );
    let current = section.number("current_rms_amp", &CURRENT, "rated line current, rms");
    let frequency = section.number("frequency_hz", &FREQUENCY, "rated supply frequency");
    let torque = section.number("torque_nm", &TORQUE, "rated shaft torque");
    let connection = section.choice("connection", &CONNECTIONS);
    let speed = section.optional_number("speed_rpm", &SPEED);
    let rotor_bars = section.optional_integer("rotor_bars", &ROTOR_BARS);
    Some(Nameplate {
        pole_pairs: pole_pairs?,
        power_watt: power?,
        voltage_line_rms_volt: voltage?,
        current_rms_amp: current?,
        frequency_hz: frequency?,
        torque_nm: torque?,
        connection: connection?,
        speed_rpm: speed?,
        rotor_bars: rotor_bars?,
    })
}

/// Slips of a unit or of a factor: each value is possible, together they are not.
fn check_agreement(section: &Section<'_>, nameplate: &Nameplate) {
    let apparent = 3.0_f64.sqrt() * nameplate.voltage_line_rms_volt * nameplate.current_rms_amp;
    // Power factor times efficiency is below 1; a fifth is left for the rounding of small plates.
    if nameplate.power_watt > 1.2 * apparent {
        section.report(
            "power_watt",
            format!(
                "{} W cannot come out of sqrt(3) U I = {apparent:.1} VA: check power_watt (W, not kW), \
                 voltage_line_rms_volt and current_rms_amp",
                nameplate.power_watt
            ),
        );
    }
    let synchronous_watt = nameplate.torque_nm * nameplate.synchronous_speed_mech();
    let ratio = nameplate.power_watt / synchronous_watt;
    if !(0.2..=5.0).contains(&ratio) {
        section.report(
            "torque_nm",
            format!(
                "{} N m at synchronous speed is {synchronous_watt:.1} W, but power_watt is {}: they must agree \
                 within a factor of 5; check pole_pairs, frequency_hz, power_watt and torque_nm",
                nameplate.torque_nm, nameplate.power_watt
            ),
        );
    }
    check_speed(section, nameplate);
}

fn check_speed(section: &Section<'_>, nameplate: &Nameplate) {
    let synchronous_rpm = 60.0 * nameplate.frequency_hz / f64::from(nameplate.pole_pairs);
    if let Some(rpm) = nameplate.speed_rpm
        && !(0.5 * synchronous_rpm..synchronous_rpm).contains(&rpm)
    {
        section.report(
            "speed_rpm",
            format!(
                "{rpm} rpm is not a rated speed of {} pole pairs at {} Hz: write at least {} and below \
                 {synchronous_rpm} rpm, or correct pole_pairs",
                nameplate.pole_pairs,
                nameplate.frequency_hz,
                0.5 * synchronous_rpm
            ),
        );
    }
}
