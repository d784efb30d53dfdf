//! The bench: plate and table of a motor as a technician would write them, with the errors of plate and instruments.

use std::fmt::Write;

use nameplate::plate::{Plate, Printed};
use rand_pcg::Pcg64Mcg;

use crate::drawn::{Motor, normal};
use crate::machine::Laws;

/// Standard deviations: of an instrument of class 0.2, of a speed and of a temperature.
const CLASS: f64 = 0.002 / 1.732;
const RPM: f64 = 1.0 / 1.732;
const KELVIN: f64 = 2.0 / 1.732;

/// What supply and position add to a reading of a motor with the laws that are fitted.
fn scatter(test: &str) -> f64 {
    match test {
        "no-load" => 0.004,
        "locked-rotor" => 0.01,
        "load" => 0.003,
        _ => 0.001,
    }
}

pub const HEADER: &str = "test,voltage_volt,frequency_hz,current_amp,power_watt,speed_rpm,torque_nm,temperature_degc,resistance_ohm,time_s\n";

/// The plate of the motor's type: its single values differ by the tolerances of IEC 60034-1.
pub fn plate(motor: &Motor, rng: &mut Pcg64Mcg, ratios: bool) -> Plate {
    let [
        slip,
        efficiency,
        power_factor,
        breakdown,
        locked_torque,
        locked_current,
    ] = motor.values;
    let third = 1.0 / 3f64.sqrt();
    let mut off = |limit: f64| limit * third * normal(rng);
    let slip = slip * off(if motor.power_kw < 1.0 { 0.3 } else { 0.2 }).exp();
    let loss = (1.0 - efficiency) * off(if motor.power_kw > 150.0 { 0.1 } else { 0.15 }).exp();
    let step = ((1.0 - power_factor) / 6.0).clamp(0.02, 0.07);
    let tangent = (1.0 / power_factor / power_factor - 1.0).sqrt()
        * off(step / (power_factor * (1.0 - power_factor * power_factor))).exp();
    let power_factor = 1.0 / tangent.hypot(1.0);
    let printed =
        |value: f64, digits: usize| Some(format!("{value:.digits$}").parse::<Printed>().unwrap());
    let exact = |value: f64| Some(Printed::exact(value));
    let mut ratio = |value: f64, limit: f64| match ratios {
        true => printed(value * off(limit).exp(), 2),
        false => None,
    };
    Plate {
        power_kw: exact(motor.power_kw),
        voltage_volt: exact(motor.volt),
        frequency_hz: exact(50.0),
        speed_rpm: printed(3000.0 / f64::from(motor.pole_pairs) * (1.0 - slip), 0),
        efficiency_percent: printed(100.0 * (1.0 - loss), 1),
        power_factor: printed(power_factor.min(0.97), 2),
        current_amp: None,
        breakdown_torque_ratio: ratio(breakdown, 0.1),
        locked_rotor_torque_ratio: ratio(locked_torque, 0.2),
        locked_rotor_current_ratio: ratio(locked_current, 0.2),
        dc_resistance: None,
    }
}

/// Instruments with their own errors, and the table that they fill.
pub struct Bench<'m> {
    motor: &'m Motor,
    rng: Pcg64Mcg,
    /// Of voltage, current, power, its angle, torque, resistance.
    gains: [f64; 6],
    pub table: String,
}

impl<'m> Bench<'m> {
    pub fn new(motor: &'m Motor, mut rng: Pcg64Mcg) -> Bench<'m> {
        let gains = core::array::from_fn(|_| CLASS * normal(&mut rng));
        Bench {
            motor,
            rng,
            gains,
            table: HEADER.to_owned(),
        }
    }

    /// `share`: the instrument's scatter over that of a voltmeter.
    fn read(&mut self, test: &str, truth: f64, gain: usize, share: f64) -> f64 {
        let law = match self.motor.machine.laws {
            Laws::Fitted => scatter(test) * normal(&mut self.rng),
            Laws::Others => 0.0,
        };
        truth * (1.0 + self.gains[gain] + CLASS * share * normal(&mut self.rng) + law)
    }

    fn temperature(&mut self, degc: f64) -> f64 {
        degc + KELVIN * normal(&mut self.rng)
    }

    pub fn dc_resistance(&mut self) {
        let m = &self.motor.machine;
        let ohm = self.motor.volt / 3f64.sqrt() / self.motor.amp;
        let terminals = 2.0 * m.stator_resistance * ohm * (235.0 + 22.0) / (235.0 + m.warm_degc);
        for _ in 0..3 {
            let scatter = 1.0 + CLASS * normal(&mut self.rng) + self.gains[5];
            let degc = self.temperature(22.0);
            let _ = writeln!(
                self.table,
                "dc-resistance,,,,,,,{degc},{},",
                terminals * scatter
            );
        }
    }

    pub fn no_load(&mut self, voltages: &[f64]) {
        for &u in voltages {
            let shown = self.motor.machine.uncoupled(u, 40.0);
            self.row("no-load", u, 1.0, &shown, 40.0, None);
        }
    }

    pub fn locked_rotor(&mut self, frequencies: &[f64]) {
        for &nu in frequencies {
            let (u, shown) = self.motor.machine.locked(1.0, nu, 35.0);
            self.row("locked-rotor", u, nu, &shown, 35.0, None);
        }
    }

    pub fn load(&mut self, shares: &[f64]) {
        for &share in shares {
            let slip = share * self.motor.machine.slip;
            let degc = 40.0 + 50.0 * share;
            let shown = self.motor.machine.at(1.0, slip, 1.0, degc);
            self.row("load", 1.0, 1.0, &shown, degc, Some(slip));
        }
    }

    fn row(
        &mut self,
        test: &str,
        u: f64,
        nu: f64,
        shown: &crate::machine::Shown,
        degc: f64,
        slip: Option<f64>,
    ) {
        let watt = 3f64.sqrt() * self.motor.volt * self.motor.amp;
        let synchronous = 3000.0 / f64::from(self.motor.pole_pairs);
        let volt = self.read(test, u * self.motor.volt, 0, 1.0);
        let amp = self.read(test, shown.current * self.motor.amp, 1, 1.0);
        let late = shown.reactive / shown.active * self.gains[3];
        let share = u * shown.current / shown.active;
        let power = self.read(test, shown.active * watt, 2, share) * (1.0 + late);
        let degc = self.temperature(degc);
        let (rpm, nm) = match slip {
            Some(slip) => {
                let nm = shown.torque * watt / (synchronous * std::f64::consts::TAU / 60.0);
                let rpm = synchronous * (1.0 - slip) + RPM * normal(&mut self.rng);
                (
                    rpm.min(synchronous - 0.01).to_string(),
                    self.read(test, nm, 4, 1.0).to_string(),
                )
            }
            None => (String::new(), String::new()),
        };
        let hz = 50.0 * nu;
        let _ = writeln!(
            self.table,
            "{test},{volt},{hz},{amp},{power},{rpm},{nm},{degc},,"
        );
    }

    /// Running out, integrated in small steps.
    pub fn coast_down(&mut self) {
        let m = &self.motor.machine;
        let rated = 314.159_265_358_979 / f64::from(self.motor.pole_pairs) * (1.0 - m.slip);
        let torque = 1000.0 * self.motor.power_kw / rated / m.rated_torque;
        let rate = |w: f64| -m.friction(w) * torque / (self.motor.inertia * rated);
        let whole = -1.0 / rate(1.0);
        // In rated speeds; the middle of each step.
        let (mut w, steps) = (1.02, 2000);
        let h = 0.8 * whole / f64::from(steps);
        for k in 0..=steps {
            if k % 250 == 0 {
                let rpm = w * rated * 60.0 / std::f64::consts::TAU;
                let read = rpm * (1.0 + scatter("coast-down") * normal(&mut self.rng))
                    + RPM * normal(&mut self.rng);
                let _ = writeln!(self.table, "coast-down,,,,,{read},,,,{}", h * f64::from(k));
            }
            w += h * rate(w + 0.5 * h * rate(w));
        }
    }
}
