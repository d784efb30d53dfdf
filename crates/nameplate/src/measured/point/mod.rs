//! One test point: its readings, what sets it, and what a motor would have shown.

mod circuit;
mod coast_down;
mod made;
mod planned;

use crate::measured::table::{Column, Test};
use crate::measured::unknowns::{Machine, Unknown};

pub(super) use made::points;
pub(super) use planned::planned;

/// Unknowns of one point alone, at most: air-gap voltage or current or first speed; slip; temperature.
pub(super) const OWN: usize = 3;
pub(super) type Own = [f64; OWN];

/// What was read, as it is compared: a logarithm, or plain for slip, temperature and the speeds of a coast-down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reading {
    pub column: Column,
    /// As measured, in SI units.
    pub measured: f64,
    pub value: f64,
    /// Standard deviation of `value` apart from the instrument's common error.
    pub deviation: f64,
}

/// One test point.
#[derive(Clone, Debug)]
pub(super) struct Point {
    pub test: Test,
    /// Rows of the table.
    pub rows: Vec<usize>,
    /// Frequency over rated frequency.
    pub nu: f64,
    /// Reactive over active power, which an angle error works on.
    pub tan_phi: f64,
    /// Times of a coast-down, s.
    pub times: Vec<f64>,
    pub readings: Vec<Reading>,
    /// How many of [`Own`] it has, and where they begin.
    pub own: usize,
    pub start: Own,
}

impl Point {
    /// What a motor would have shown, reading by reading.
    pub fn predicted(&self, machine: &Machine, own: &Own) -> Vec<f64> {
        match self.test {
            Test::DcResistance => self.resistance(machine, own),
            Test::CoastDown => coast_down::speeds(machine, own[0], &self.times),
            Test::NoLoad => self.shown(
                machine,
                &machine.no_load(own[0], degc(own[1]), self.nu),
                0.0,
                own[1],
            ),
            Test::LockedRotor => self.shown(
                machine,
                &machine.locked(own[0], degc(own[1]), self.nu),
                1.0,
                own[1],
            ),
            Test::Load => {
                let slip = own[1].max(1e-6);
                let shown = machine.running(own[0], slip, degc(own[2]), self.nu);
                self.shown(machine, &shown, slip, own[2])
            }
        }
    }

    fn resistance(&self, machine: &Machine, own: &Own) -> Vec<f64> {
        let [stator, _] = machine.warmth(degc(own[0]));
        let ohm = 2.0 * machine.circuit.stator_resistance * stator * machine.base.ohm;
        let of = |reading: &Reading| match reading.column {
            Column::Resistance => ohm.ln() + machine.get(Unknown::ResistanceGain),
            _ => own[0],
        };
        self.readings.iter().map(of).collect()
    }

    fn shown(
        &self,
        machine: &Machine,
        shown: &circuit::Shown,
        slip: f64,
        temperature: f64,
    ) -> Vec<f64> {
        let log = |per_unit: f64, base: f64| (per_unit.max(1e-9) * base).ln();
        let of = |reading: &Reading| match reading.column {
            Column::Voltage => {
                log(shown.voltage, machine.base.volt) + machine.get(Unknown::VoltageGain)
            }
            Column::Current => {
                log(shown.current, machine.base.amp) + machine.get(Unknown::CurrentGain)
            }
            Column::Power => {
                log(shown.active, machine.base.watt)
                    + machine.get(Unknown::PowerGain)
                    + self.tan_phi * machine.get(Unknown::PowerAngle)
            }
            Column::Torque => log(shown.torque, machine.base.nm) + machine.get(Unknown::TorqueGain),
            Column::Speed => slip,
            _ => temperature,
        };
        self.readings.iter().map(of).collect()
    }
}

/// Temperatures are counted in units of 100 K, so that all unknowns are of one size.
pub(super) const KELVINS: f64 = 100.0;

fn degc(hundreds: f64) -> f64 {
    (hundreds * KELVINS).clamp(-100.0, 400.0)
}
