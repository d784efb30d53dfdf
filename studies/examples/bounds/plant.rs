//! The steady motor with its instrument, in symmetrical components: what is measured, as a function of everything unknown.

use std::f64::consts::{SQRT_2, TAU};

use campaign::{LoadKnowledge, Run};
use monitor::MonitorConfig;
use motor::TParams;
use motor::steady_state::SteadyState;
use num_complex::Complex64;

/// Voltages, currents, speed and the balance of torques.
pub const MEASURED: usize = 14;
/// Unknown shares, then voltages of the three sequences and the speed.
pub const UNKNOWNS: usize = Unknown::ALL.len() + 7;
const J: Complex64 = Complex64::new(0.0, 1.0);

/// What may be off, as a share of its value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Unknown {
    StatorResistance,
    RotorResistance,
    Heating,
    Magnetizing,
    Leakage,
    Friction,
    CurrentA,
    CurrentB,
    CurrentC,
    VoltageA,
    VoltageB,
    VoltageC,
    Speed,
    NegativeReal,
    NegativeImaginary,
    Joint,
    AllCurrents,
    AllVoltages,
}

impl Unknown {
    /// All of them. The last three are faults only: nobody expects them of a healthy motor.
    pub const ALL: [Unknown; 18] = [
        Unknown::StatorResistance,
        Unknown::RotorResistance,
        Unknown::Heating,
        Unknown::Magnetizing,
        Unknown::Leakage,
        Unknown::Friction,
        Unknown::CurrentA,
        Unknown::CurrentB,
        Unknown::CurrentC,
        Unknown::VoltageA,
        Unknown::VoltageB,
        Unknown::VoltageC,
        Unknown::Speed,
        Unknown::NegativeReal,
        Unknown::NegativeImaginary,
        Unknown::Joint,
        Unknown::AllCurrents,
        Unknown::AllVoltages,
    ];

    /// What a fault of the plan changes; `None` for one that is no constant of this circuit.
    pub fn of_fault(name: &str) -> Option<Unknown> {
        Some(match name {
            "Rs" => Unknown::StatorResistance,
            "Rr" => Unknown::RotorResistance,
            "Lm" => Unknown::Magnetizing,
            "leakage" => Unknown::Leakage,
            "Bl" => Unknown::Friction,
            "i" => Unknown::CurrentA,
            "v" => Unknown::VoltageA,
            "speed" => Unknown::Speed,
            "Rs-phase" => Unknown::Joint,
            "i-all" => Unknown::AllCurrents,
            "v-all" => Unknown::AllVoltages,
            _ => return None,
        })
    }

    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Unknown::StatorResistance => "stator resistance",
            Unknown::RotorResistance => "rotor resistance",
            Unknown::Heating => "winding temperature",
            Unknown::Magnetizing => "magnetizing inductance",
            Unknown::Leakage => "leakage",
            Unknown::Friction => "friction",
            Unknown::CurrentA | Unknown::CurrentB | Unknown::CurrentC => {
                "gains of the current sensors"
            }
            Unknown::VoltageA | Unknown::VoltageB | Unknown::VoltageC => {
                "gains of the voltage sensors"
            }
            Unknown::Speed => "speed",
            Unknown::NegativeReal | Unknown::NegativeImaginary => {
                "impedance of the negative sequence"
            }
            Unknown::Joint | Unknown::AllCurrents | Unknown::AllVoltages => "",
        }
    }
}

/// A healthy motor under the conditions of one run.
pub struct Plant {
    params: TParams<f64>,
    pole_pairs: f64,
    omega_sync: f64,
    /// Friction that is declared, N m s; `None` where the load is not known.
    friction: Option<f64>,
    /// Torque that 1 stands for in the balance, N m.
    torque_scale: f64,
    /// Positive, negative and zero sequence at the terminals, V; speed, rad/s.
    pub state: [f64; 7],
    /// Standard deviation of each measured quantity.
    pub sigma: [f64; MEASURED],
    /// Standard deviation of each share before a window is seen.
    pub prior: [f64; Unknown::ALL.len()],
    /// Standard deviation of the zero sequence of the voltages, V.
    pub zero_voltage: f64,
    /// Standard deviations at which FAULT lights.
    pub significance: f64,
}

impl Plant {
    /// `None` where the motor does not carry its load or was not calibrated.
    pub fn of(run: &Run<'_>) -> Option<Plant> {
        let (scenario, monitor) = (run.scenario(), run.monitor_file());
        let frequency = scenario.supply.frequency_hz.at(0.0);
        let amplitude = scenario.supply.amplitude_volt.at(0.0);
        let (pole_pairs, omega_sync) = (
            f64::from(scenario.motor.nameplate.pole_pairs),
            TAU * frequency,
        );
        let params = scenario.motor.parameters;
        let curve = SteadyState::new(&params, pole_pairs, Complex64::from(amplitude), omega_sync);
        let declared = run.place.block.load == LoadKnowledge::Friction;
        let mechanics = scenario.motor.mechanics;
        let friction = declared.then_some(mechanics.friction + mechanics.load_friction);
        let torque =
            |omega: f64| scenario.load.other.torque(0.0, omega) + mechanics.friction * omega;
        let point = match friction {
            Some(friction) => curve.at_friction(friction),
            None => curve.at_load(torque).ok()?,
        };
        let negative = scenario
            .supply
            .components
            .iter()
            .find(|part| part.order == -1.0);
        let negative = amplitude * negative.map_or(Complex64::ZERO, |part| part.amplitude);
        let config =
            MonitorConfig::from_motor_file(&monitor, 1.0 / scenario.sample_rate_hz).ok()?;
        let healthy = config.healthy?;
        let open = healthy.uncertainty;
        let prior = [
            open.stator_resistance,
            open.rotor_resistance,
            open.heating,
            open.magnetizing_inductance,
            open.leakage,
            open.friction,
            open.current_gain,
            open.current_gain,
            open.current_gain,
            open.voltage_gain,
            open.voltage_gain,
            open.voltage_gain,
            open.speed,
            open.negative_impedance,
            open.negative_impedance,
            0.0,
            0.0,
            0.0,
        ];
        let samples = CYCLES / frequency * scenario.sample_rate_hz;
        let sensors = scenario.sensors.instrument;
        let channel = |full_scale: f64| {
            let noise = sensors.noise_sigma_fraction_of_full_scale * full_scale;
            let step = 2.0 * full_scale / f64::from(1_u32 << sensors.adc_bits);
            // Of a component of a sine's amplitude fitted to that many samples; a step of the converter adds its variance / 12.
            ((noise * noise + step * step / 12.0) * 2.0 / samples).sqrt()
        };
        let (u, i) = (
            channel(sensors.voltage_full_scale_volt),
            channel(sensors.current_full_scale_amp),
        );
        let mut sigma = [u; MEASURED];
        sigma[6..12].fill(i);
        let counts = 4.0 * f64::from(sensors.encoder_pulses_per_revolution);
        // The difference of two counts, each rounded down.
        sigma[12] = TAU / counts / 6_f64.sqrt() * frequency / CYCLES;
        // What the noise of the speed makes of the torque that accelerates, from one window to the next.
        let torque_scale = scenario.motor.nameplate.torque_nm;
        sigma[13] = mechanics.inertia * SQRT_2 * sigma[12] * frequency / CYCLES / torque_scale;
        Some(Plant {
            params,
            pole_pairs,
            omega_sync,
            friction,
            torque_scale,
            state: [
                amplitude,
                0.0,
                negative.re,
                negative.im,
                0.0,
                0.0,
                point.omega_mech,
            ],
            sigma,
            prior: prior.map(f64::from),
            zero_voltage: f64::from(healthy.scatter[7]) * amplitude,
            significance: f64::from(healthy.significance),
        })
    }

    /// What is measured with these shares off, and with this state.
    pub fn measured(&self, unknowns: &[f64; UNKNOWNS]) -> [f64; MEASURED] {
        let share = |what: Unknown| unknowns[what as usize];
        let [v1r, v1i, v2r, v2i, v0r, v0i, omega] =
            std::array::from_fn(|k| unknowns[Unknown::ALL.len() + k]);
        let voltages = [
            Complex64::new(v1r, v1i),
            Complex64::new(v2r, v2i),
            Complex64::new(v0r, v0i),
        ];
        let (currents, torque) = self.currents(&share, voltages, omega);
        let mut measured = [0.0; MEASURED];
        let gains = |first: Unknown, all: Unknown| -> [f64; 3] {
            std::array::from_fn(|k| 1.0 + unknowns[first as usize + k] + share(all))
        };
        let u = phases(voltages);
        let i = phases([currents[0], currents[1], Complex64::ZERO]);
        let gains = [
            gains(Unknown::VoltageA, Unknown::AllVoltages),
            gains(Unknown::CurrentA, Unknown::AllCurrents),
        ];
        for (k, (value, gain)) in u.into_iter().chain(i).zip(gains.as_flattened()).enumerate() {
            (measured[2 * k], measured[2 * k + 1]) = (gain * value.re, gain * value.im);
        }
        measured[12] = omega * (1.0 + share(Unknown::Speed));
        measured[13] = self.friction.map_or(0.0, |friction| {
            (torque - friction * (1.0 + share(Unknown::Friction)) * omega) / self.torque_scale
        });
        measured
    }

    /// Currents of positive and negative sequence, and the torque of the former: T circuit at slip and at 2 - slip, with a
    /// resistance in series with phase a that couples the two.
    fn currents(
        &self,
        share: &dyn Fn(Unknown) -> f64,
        [v1, v2, _]: [Complex64; 3],
        omega: f64,
    ) -> ([Complex64; 2], f64) {
        let slip = 1.0 - self.pole_pairs * omega / self.omega_sync;
        let hot = 1.0 + share(Unknown::Heating);
        let r_s = self.params.r_s * hot * (1.0 + share(Unknown::StatorResistance));
        let r_r = self.params.r_r * hot * (1.0 + share(Unknown::RotorResistance));
        let leak = 1.0 + share(Unknown::Leakage);
        let x_m = J * self.omega_sync * self.params.l_m * (1.0 + share(Unknown::Magnetizing));
        let stator = r_s + J * self.omega_sync * self.params.l_ls * leak;
        let rotor = |slip: f64| r_r / slip + J * self.omega_sync * self.params.l_lr * leak;
        let parallel = |slip: f64| x_m * rotor(slip) / (x_m + rotor(slip));
        let off = 1.0 + share(Unknown::NegativeReal) + J * share(Unknown::NegativeImaginary);
        let (z1, z2) = (
            stator + parallel(slip),
            (stator + parallel(2.0 - slip)) * off,
        );
        let third = Complex64::from(self.params.r_s * share(Unknown::Joint) / 3.0);
        let determinant = (z1 + third) * (z2 + third) - third * third;
        let i1 = (v1 * (z2 + third) - third * v2) / determinant;
        let i2 = (v2 * (z1 + third) - third * v1) / determinant;
        let i_r = i1 * x_m / (x_m + rotor(slip));
        // Air-gap power of amplitudes over synchronous speed.
        let torque = 1.5 * self.pole_pairs / self.omega_sync * i_r.norm_sqr() * r_r / slip;
        ([i1, i2], torque)
    }
}

/// Supply cycles of a window.
const CYCLES: f64 = 5.0;

/// Phases from positive, negative and zero sequence.
fn phases([positive, negative, zero]: [Complex64; 3]) -> [Complex64; 3] {
    let turn = |k: f64| Complex64::from_polar(1.0, k * TAU / 3.0);
    [0.0, 1.0, 2.0].map(|k| positive * turn(-k) + negative * turn(k) + zero)
}
