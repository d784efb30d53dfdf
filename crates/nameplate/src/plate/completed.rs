//! A plate with every value set: printed, derived from the others, or expected of motors like it.

use super::synchronous::{Rotation, frequency_of};
use super::values::{self, Value, Values};
use super::{Plate, Printed, Problem, VALUES};
use crate::fit::Targets;
use crate::interval::Interval;
use crate::prior::{Covariance, Population, Prior};

/// Plates with one digit of power factor mean two.
const POWER_FACTOR_HALF_STEP: f64 = 0.005;
/// Power factors and efficiencies that a loaded motor has.
const POWER_FACTORS: [f64; 2] = [0.2, 0.98];
const EFFICIENCIES: [f64; 2] = [0.2, 0.99];
/// A slip that the efficiency excludes is limited to this share of the loss.
const SLIP_OF_LOSS: f64 = 0.97;

/// A plate with every value set.
#[derive(Clone, Debug, PartialEq)]
pub struct Completed {
    /// What the plate printed.
    pub plate: Plate,
    /// Rated shaft power, kW.
    pub power_kw: f64,
    /// Line voltage, V rms.
    pub voltage_volt: f64,
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Pole pairs; two where neither speed nor poles are printed.
    pub pole_pairs: u32,
    /// Inertia of motors of this size and speed, kg m2.
    pub inertia: Interval,
    /// Values for the circuit to meet.
    pub targets: Targets,
    /// Covariance of the six values: rounding of the printed ones, spread between motors of the others.
    pub covariance: Covariance,
    /// Which of the six values are printed or follow from printed ones.
    pub known: [bool; VALUES],
}

impl Completed {
    /// Sets what is missing.
    ///
    /// # Errors
    /// Power, voltage or frequency missing and not to be derived, or numbers that no motor has.
    pub fn of(plate: &Plate, prior: &Prior) -> Result<Completed, Problem> {
        check_ranges(plate)?;
        let frequency_hz = frequency(plate)?;
        let rotation = plate
            .speed_rpm
            .map(|speed| Rotation::of(speed, frequency_hz))
            .transpose()?;
        let (power_kw, voltage_volt) = power_and_voltage(plate, prior)?;
        let population = prior.of_size(power_kw);
        let rated = Rated::of(plate, power_kw, voltage_volt, &population, rotation)?;
        let known = rated.known(plate, rotation);
        let (mean, spread) = population.given(&known);
        let covariance = spread + rounding(plate, &rated, rotation);
        let pole_pairs = rotation.map_or(2, |rotation| rotation.pole_pairs);
        let targets = Targets {
            power_kw,
            slip: 0.0,
            slip_half_step: rotation.map_or(WITHOUT_SPEED, |rotation| rotation.slip_half_step),
            efficiency: 0.0,
            power_factor: 0.0,
            breakdown_torque_ratio: 0.0,
            locked_rotor_torque_ratio: 0.0,
            locked_rotor_current_ratio: 0.0,
            stator_resistance: None,
            current_ratio: 1.0,
        }
        .with_values(&mean);
        let mut completed = Completed {
            plate: *plate,
            power_kw,
            voltage_volt,
            frequency_hz,
            inertia: prior.inertia_kg_m2(power_kw, pole_pairs, frequency_hz),
            pole_pairs,
            targets,
            covariance,
            known: known.map(|value| value.is_some()),
        };
        completed.agree();
        Ok(completed)
    }

    /// Rated current that power, voltage, efficiency and power factor give, A rms.
    pub fn base_current_amp(&self) -> f64 {
        line_current(
            self.power_kw,
            self.voltage_volt,
            self.targets.rating().power,
        )
    }

    /// Whether the plate says anything of breakdown or standstill: only there do two cages differ from one.
    pub fn knows_standstill(&self) -> bool {
        let values = [
            Value::Breakdown,
            Value::LockedRotorTorque,
            Value::LockedRotorCurrent,
        ];
        values.into_iter().any(|value| self.known[value as usize])
    }

    /// Base impedance of the circuit in per unit, ohm per equivalent star phase.
    pub fn base_impedance_ohm(&self) -> f64 {
        self.voltage_volt / (SQRT_3 * self.base_current_amp())
    }

    /// The same plate, had its values been others.
    pub fn with_values(&self, values: &Values) -> Completed {
        let mut moved = Completed {
            targets: self.targets.with_values(values),
            ..self.clone()
        };
        moved.read_measured();
        moved
    }

    /// What was expected of motors like it gives way to what is printed.
    fn agree(&mut self) {
        let targets = &mut self.targets;
        if !self.known[Value::Slip as usize] {
            targets.slip = targets.slip.min(SLIP_OF_LOSS * (1.0 - targets.efficiency));
        }
        if !self.known[Value::Loss as usize] {
            targets.efficiency = targets.efficiency.min(1.0 - targets.slip / SLIP_OF_LOSS);
        }
        self.read_measured();
    }

    /// What is per unit of a base that the other values set.
    fn read_measured(&mut self) {
        let base = self.base_impedance_ohm();
        let resistance = self.plate.dc_resistance;
        self.targets.stator_resistance = resistance.map(|dc| dc.warm_phase_ohm() / base);
        if let Some(current) = self.plate.current_amp {
            self.targets.current_ratio = current.value / self.base_current_amp();
        }
    }
}

/// Circuits fitted to all data of a catalogue motor put the slip at an end of its rounding more often than evenly: half a step
/// counts as one standard deviation (measured: the rotor resistance's interval then holds for 19 of 20 motors, not for 18).
const SLIP_ROUNDING: f64 = SQRT_3;
/// A speed that is not printed is as the prior has it: the targets' slip may move by this share.
const WITHOUT_SPEED: f64 = 0.2;
const SQRT_3: f64 = 1.732_050_807_568_877_2;

fn line_current(power_kw: f64, voltage_volt: f64, efficiency_times_power_factor: f64) -> f64 {
    1000.0 * power_kw / (SQRT_3 * voltage_volt * efficiency_times_power_factor)
}

/// Efficiency and power factor as far as the plate has them.
struct Rated {
    efficiency: Option<Printed>,
    power_factor: Option<Printed>,
}

impl Rated {
    fn of(
        plate: &Plate,
        power_kw: f64,
        voltage_volt: f64,
        population: &Population,
        rotation: Option<Rotation>,
    ) -> Result<Rated, Problem> {
        let efficiency = plate.efficiency_percent.map(|printed| printed.times(0.01));
        let power_factor = plate.power_factor.map(|printed| Printed {
            half_step: printed.half_step.min(POWER_FACTOR_HALF_STEP),
            ..printed
        });
        let Some(current) = plate.current_amp else {
            return Ok(Rated {
                efficiency,
                power_factor,
            });
        };
        let apparent_kva = SQRT_3 * voltage_volt * current.value / 1000.0;
        let product = power_kw / apparent_kva;
        if product > 0.98 {
            return Err(Problem::Apparent {
                apparent_kva,
                power_kw,
            });
        }
        let other = |one: Printed, limits: [f64; 2]| {
            let value = (product / one.value).clamp(limits[0], limits[1]);
            let relative = one.relative().hypot(current.relative());
            Printed {
                value,
                half_step: value * relative,
            }
        };
        Ok(match (efficiency, power_factor) {
            (Some(efficiency), None) => Rated {
                efficiency: Some(efficiency),
                power_factor: Some(other(efficiency, POWER_FACTORS)),
            },
            (None, Some(power_factor)) => Rated {
                efficiency: Some(other(power_factor, EFFICIENCIES)),
                power_factor: Some(power_factor),
            },
            (None, None) => {
                let expected = expected_efficiency(population, rotation);
                Rated {
                    efficiency: None,
                    power_factor: Some(other(expected, POWER_FACTORS)),
                }
            }
            both => Rated {
                efficiency: both.0,
                power_factor: both.1,
            },
        })
    }

    fn known(&self, plate: &Plate, rotation: Option<Rotation>) -> [Option<f64>; VALUES] {
        let ratio = |printed: Option<Printed>| printed.map(|printed| printed.value.ln());
        [
            rotation.map(|rotation| values::of_slip(rotation.slip)),
            self.efficiency.map(|e| values::of_efficiency(e.value)),
            self.power_factor.map(|p| values::of_power_factor(p.value)),
            ratio(plate.breakdown_torque_ratio),
            ratio(plate.locked_rotor_torque_ratio),
            ratio(plate.locked_rotor_current_ratio),
        ]
    }
}

/// Efficiency of motors of this size and slip; its rounding is their spread.
fn expected_efficiency(population: &Population, rotation: Option<Rotation>) -> Printed {
    let mut known = [None; VALUES];
    known[0] = rotation.map(|rotation| values::of_slip(rotation.slip));
    let (mean, covariance) = population.given(&known);
    let loss = Value::Loss as usize;
    let value = values::efficiency(mean[loss]).clamp(EFFICIENCIES[0], EFFICIENCIES[1]);
    Printed {
        value,
        half_step: (1.0 - value) * covariance[(loss, loss)].sqrt(),
    }
}

/// Variances of the logarithms that rounding leaves; a rounding is uniform, its standard deviation half a step over sqrt(3).
fn rounding(plate: &Plate, rated: &Rated, rotation: Option<Rotation>) -> Covariance {
    let relative = |printed: Option<Printed>| printed.map_or(0.0, Printed::relative);
    let half_steps = Values::from([
        SLIP_ROUNDING * rotation.map_or(0.0, |rotation| rotation.slip_half_step),
        rated
            .efficiency
            .map_or(0.0, |e| e.half_step / (1.0 - e.value)),
        rated
            .power_factor
            .map_or(0.0, |p| p.half_step / (p.value * (1.0 - p.value * p.value))),
        relative(plate.breakdown_torque_ratio),
        relative(plate.locked_rotor_torque_ratio),
        relative(plate.locked_rotor_current_ratio),
    ]);
    Covariance::from_diagonal(&half_steps.map(|half| half * half / 3.0))
}

fn frequency(plate: &Plate) -> Result<f64, Problem> {
    match (plate.frequency_hz, plate.speed_rpm) {
        (Some(frequency), _) => Ok(frequency.value),
        (None, Some(speed)) => frequency_of(speed).ok_or(Problem::NoFrequency),
        (None, None) => Err(Problem::NoFrequency),
    }
}

fn power_and_voltage(plate: &Plate, prior: &Prior) -> Result<(f64, f64), Problem> {
    let value = |printed: Option<Printed>| printed.map(|printed| printed.value);
    let product = || {
        let efficiency = value(plate.efficiency_percent)? / 100.0;
        Some(efficiency * value(plate.power_factor)? * SQRT_3 * value(plate.current_amp)? / 1000.0)
    };
    match (value(plate.power_kw), value(plate.voltage_volt)) {
        (Some(power), Some(voltage)) => Ok((power, voltage)),
        (Some(power), None) => Ok((power, power / product().ok_or(Problem::NoVoltage)?)),
        (None, Some(voltage)) => Ok((power_of(plate, voltage, prior)?, voltage)),
        (None, None) => Err(Problem::NoPower),
    }
}

/// Shaft power of the apparent power, kW; what is missing is typical of motors of a few kilowatts.
fn power_of(plate: &Plate, voltage_volt: f64, prior: &Prior) -> Result<f64, Problem> {
    let current = plate.current_amp.ok_or(Problem::NoPower)?.value;
    let apparent_kva = SQRT_3 * voltage_volt * current / 1000.0;
    let typical = prior.of_size(0.7 * apparent_kva).mean;
    let efficiency = plate
        .efficiency_percent
        .map_or(values::efficiency(typical[Value::Loss as usize]), |e| {
            e.value / 100.0
        });
    let power_factor = plate
        .power_factor
        .map_or(values::power_factor(typical[Value::TanPhi as usize]), |p| {
            p.value
        });
    Ok(apparent_kva * efficiency * power_factor)
}

fn check_ranges(plate: &Plate) -> Result<(), Problem> {
    if let Some(dc) = plate.dc_resistance
        && !(1e-6..=1e5).contains(&dc.terminals_ohm)
    {
        return Err(Problem::Range {
            name: "dc_resistance_ohm",
            value: dc.terminals_ohm,
            low: 1e-6,
            high: 1e5,
            unit: "ohm",
        });
    }
    let ranges = [
        ("power_kw", plate.power_kw, 0.01, 50_000.0, "kW"),
        ("voltage_volt", plate.voltage_volt, 10.0, 20_000.0, "V"),
        ("frequency_hz", plate.frequency_hz, 10.0, 1000.0, "Hz"),
        ("speed_rpm", plate.speed_rpm, 20.0, 60_000.0, "rpm"),
        (
            "efficiency_percent",
            plate.efficiency_percent,
            20.0,
            99.0,
            "percent",
        ),
        ("power_factor", plate.power_factor, 0.2, 0.98, ""),
        ("current_amp", plate.current_amp, 0.01, 20_000.0, "A"),
        (
            "breakdown_torque_ratio",
            plate.breakdown_torque_ratio,
            1.05,
            8.0,
            "times rated torque",
        ),
        (
            "locked_rotor_torque_ratio",
            plate.locked_rotor_torque_ratio,
            0.1,
            8.0,
            "times rated torque",
        ),
        (
            "locked_rotor_current_ratio",
            plate.locked_rotor_current_ratio,
            1.5,
            20.0,
            "times rated current",
        ),
    ];
    for (name, printed, low, high, unit) in ranges {
        if let Some(printed) = printed
            && !(low..=high).contains(&printed.value)
        {
            return Err(Problem::Range {
                name,
                value: printed.value,
                low,
                high,
                unit,
            });
        }
    }
    Ok(())
}
