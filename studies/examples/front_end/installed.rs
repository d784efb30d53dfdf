//! A board of the documented parts where it hangs: on a grid or behind an inverter, colder or warmer than at its calibration.

use std::error::Error;
use std::f64::consts::TAU;

use crate::board::{Board, Known, Variant};
use crate::judge::{raw, sensors};
use campaign::T_SAMPLE_S;
use monitor::MonitorConfig;
use motor::MotorFile;
use motor::dynamic::Harmonic;
use motor::motor_file::LoadKind;
use num_complex::Complex64;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use recording::{Channel, LoadTorque, Metadata, Recording, StartsFrom, Supply};
use replay::calibrate::{Surroundings, calibrate};
use scenario::simulate::Simulation;
use scenario::{
    CHANNELS, Carrier, Inl, InlShape, LoadSpec, Piecewise, Scenario, SensorSpec, SignalChain,
    SpeedSensor, SupplySpec,
};

/// Carriers of inverters, Hz.
const CARRIER_HZ: [f64; 2] = [2e3, 16e3];
/// Temperatures of the board, degC, and those of its calibration.
pub const DEGC: [f64; 2] = [0.0, 50.0];
const CALIBRATED_DEGC: [f64; 2] = [20.0, 30.0];
/// Resistances of a motor that is colder or warmer than in its calibration, shares.
pub const WARMTH: [f64; 2] = [-0.08, 0.24];
/// Gain of a voltage channel, ppm/K, of the bill of materials: the divider's high and low side, the amplifier, the stage's two.
const VOLTAGE_PPM: [f64; 5] = [25.0, 25.0, 45.0, 25.0, 25.0];
/// The same of a current channel: the transducer, the stage's two.
const CURRENT_PPM: [f64; 3] = [40.0, 25.0, 25.0];
/// Of all channels alike: what the chip's own reference leaves of the supply's drift, ppm/K; believed, to be checked on silicon.
const COMMON_PPM: f64 = 50.0;
/// Offset that a calibration leaves, a share of full scale: half a code of 12 bits.
const OFFSET: f64 = 2e-4;
/// Largest non-linearity of the converter, LSB.
const INL_LSB: f64 = 2.0;
/// First group of a carrier's sidebands, a share of the phase voltage; their current meets the leakages.
const CARRIER_SHARE: f64 = 0.5;
/// Unbalance and fifth harmonic of a grid at most, shares.
const UNBALANCE: f64 = 0.01;
const FIFTH: f64 = 0.03;
/// Seconds and loads of the recordings that calibrate a motor: from idle to rated, as docs/calibrate.md asks.
const RECORDED_S: f64 = 1.5;
const RECORDED_LOADS: [f64; 3] = [0.1, 0.5, 1.0];

/// What lies behind the terminals, and where.
#[derive(Clone, Debug)]
pub struct Conditions {
    /// Share of rated torque.
    pub load: f64,
    pub hertz: f64,
    /// Change of both resistances, a share.
    pub warmth: f64,
    pub degc: f64,
}

/// A board with what its temperature does to it, and its supply.
pub struct Installed<'m> {
    pub plant: &'m MotorFile,
    pub told: MotorFile,
    board: Board,
    per_kelvin: [f64; 6],
    common_per_kelvin: f64,
    offsets: [f64; 6],
    inl: Inl,
    /// Hz, of an inverter.
    carrier_hz: Option<f64>,
    grid: Vec<Harmonic>,
}

/// What draws board number `k` of a seed, the same whichever boards are drawn besides.
pub fn random_of(seed: u64, k: u64) -> Pcg64 {
    Pcg64::new(u128::from(seed) << 64 | u128::from(k), 0xA02_BDBF_7BB3_C0A7)
}

impl<'m> Installed<'m> {
    /// Draws a board's parts and where it hangs.
    pub fn draw(plant: &'m MotorFile, random: &mut Pcg64) -> Self {
        let board = Board::draw(
            Variant::StageBoth,
            &mut Pcg64::seed_from_u64(random.random()),
        );
        let mut drift = |ppm: &[f64]| {
            let sum: f64 = ppm
                .iter()
                .map(|ppm| ppm * random.random_range(-1.0..1.0))
                .sum();
            1e-6 * sum
        };
        let per_kelvin = std::array::from_fn(|k| match k {
            0..3 => drift(&VOLTAGE_PPM),
            _ => drift(&CURRENT_PPM),
        });
        let common_per_kelvin = drift(&[COMMON_PPM]);
        let is_inverter = random.random_bool(0.5);
        let told = told(&board, plant);
        let mut turned = |size: f64, order: f64| Harmonic {
            order,
            amplitude: Complex64::from_polar(
                random.random_range(0.0..size),
                random.random_range(0.0..TAU),
            ),
        };
        let grid = match is_inverter {
            true => Vec::new(),
            false => vec![turned(UNBALANCE, -1.0), turned(FIFTH, -5.0)],
        };
        let full_scale = |k: usize| match k {
            0..3 => told.sensors.voltage_full_scale_volt,
            _ => told.sensors.current_full_scale_amp,
        };
        let offsets =
            std::array::from_fn(|k| full_scale(k) * OFFSET * random.random_range(-1.0..1.0));
        Installed {
            offsets,
            inl: Inl {
                lsb: random.random_range(0.0..INL_LSB),
                shape: match random.random_bool(0.5) {
                    true => InlShape::Bow,
                    false => InlShape::Bits,
                },
            },
            carrier_hz: is_inverter.then(|| between(CARRIER_HZ, random)),
            plant,
            told,
            board,
            per_kelvin,
            common_per_kelvin,
            grid,
        }
    }

    /// What feeds the motor, in words.
    pub fn supply(&self) -> String {
        match self.carrier_hz {
            Some(hertz) => format!("inverter with a carrier of {hertz:.0} Hz"),
            None => "grid".to_owned(),
        }
    }

    /// The same without errors of the instruments: what a fault is measured against.
    pub fn without_errors(self) -> Self {
        let conversions = self.board.chain.conversions;
        // A sample is the mean of its conversions: half their distance late.
        let late_s = 0.5 * T_SAMPLE_S * f64::from(conversions - 1) / f64::from(conversions);
        let board = Board {
            chain: SignalChain {
                conversions,
                ..SignalChain::default()
            },
            known: Some(Known {
                delays_s: [late_s; CHANNELS],
                roll_off_s: 0.0,
            }),
            ..self.board
        };
        Installed {
            told: told(&board, self.plant),
            board,
            per_kelvin: [0.0; CHANNELS],
            common_per_kelvin: 0.0,
            offsets: [0.0; CHANNELS],
            inl: Inl::default(),
            carrier_hz: None,
            ..self
        }
    }

    /// The motor as `drivemon calibrate` makes it of three recordings; `None` where it refuses them. `k` is the board's number.
    ///
    /// # Errors
    /// Conditions that cannot be simulated.
    pub fn calibrated(
        &self,
        random: &mut Pcg64,
        k: u64,
    ) -> Result<Option<MotorFile>, Box<dyn Error>> {
        let mut recordings = Vec::new();
        for load in RECORDED_LOADS {
            let at = Conditions {
                load,
                hertz: self.plant.nameplate.frequency_hz,
                warmth: 0.0,
                degc: between(CALIBRATED_DEGC, random),
            };
            recordings.push(self.recording(&at, random.random())?);
        }
        match calibrate(&self.told, &recordings, &Surroundings::default()) {
            Ok(calibrated) => Ok(Some(calibrated.motor)),
            Err(refusal) => {
                eprintln!(
                    "board {k}, {}, {}: {refusal}",
                    self.plant.name,
                    self.supply()
                );
                Ok(None)
            }
        }
    }

    fn chain(&self, at: &Conditions) -> SignalChain {
        let kelvin = at.degc - 0.5 * (CALIBRATED_DEGC[0] + CALIBRATED_DEGC[1]);
        let mut chain = self.board.chain.clone();
        for (k, channel) in chain.channels.iter_mut().enumerate() {
            channel.gain_error += self.per_kelvin[k] * kelvin;
            channel.offset = self.offsets[k];
        }
        chain.reference.error = self.common_per_kelvin * kelvin;
        chain.inl = self.inl;
        if let Some(carrier_hz) = self.carrier_hz {
            let volt = CARRIER_SHARE * self.plant.nameplate.phase_voltage_amplitude();
            let p = &self.plant.parameters;
            // The first sideband above the carrier.
            let frequency_hz = carrier_hz + 2.0 * at.hertz;
            chain.carrier = Carrier {
                frequency_hz,
                voltage_volt: volt,
                current_amp: volt / (TAU * frequency_hz * (p.l_ls + p.l_lr)),
            };
        }
        chain
    }

    fn scenario(&self, at: &Conditions, seconds: f64, seed: u64) -> Scenario {
        let mut motor = self.plant.clone();
        motor.sensors = self.told.sensors;
        motor.load = LoadKind::Free;
        motor.mechanics.load_friction = 0.0;
        motor.parameters.r_s *= 1.0 + at.warmth;
        motor.parameters.r_r *= 1.0 + at.warmth;
        let plate = &motor.nameplate;
        let volt = plate.phase_voltage_amplitude() * at.hertz / plate.frequency_hz;
        let supply = SupplySpec {
            amplitude_volt: Piecewise::constant(volt),
            frequency_hz: Piecewise::constant(at.hertz),
            components: self.grid.clone(),
            ..SupplySpec::rated(plate)
        };
        let torque = at.load * plate.torque_nm;
        Scenario {
            seed,
            supply,
            load: LoadSpec::constant(torque, true),
            sensors: SensorSpec {
                speed: SpeedSensor::Encoder,
                chain: Some(self.chain(at)),
                ..SensorSpec::of(&motor)
            },
            ..Scenario::of(motor, seconds)
        }
    }

    /// The healthy motor at `at`, sample by sample.
    pub fn simulation(
        &self,
        at: &Conditions,
        seconds: f64,
        seed: u64,
    ) -> Result<Simulation, Box<dyn Error>> {
        Ok(Simulation::new(&self.scenario(at, seconds, seed))?)
    }

    /// What the board sends of its samples.
    fn recording(&self, at: &Conditions, seed: u64) -> Result<Recording, Box<dyn Error>> {
        let scenario = self.scenario(at, RECORDED_S, seed);
        let config = MonitorConfig::from_motor_file(&self.told, T_SAMPLE_S)?;
        let (mut t, mut columns) = (Vec::new(), <[Vec<f64>; 7]>::default());
        for sample in Simulation::new(&scenario)? {
            let shown = config.converter.convert(&raw(&sample.measured));
            let [u, i] = [shown.u_s_abc, shown.i_s_abc].map(|x| x.unwrap_or_default().to_array());
            let analogue = u.into_iter().chain(i).map(f64::from);
            t.push(sample.t);
            for (column, value) in columns
                .iter_mut()
                .zip(analogue.chain([sample.measured.omega_mech]))
            {
                column.push(value);
            }
        }
        let metadata = Metadata {
            supply: match self.carrier_hz {
                Some(_) => Supply::Inverter,
                None => Supply::Grid,
            },
            load_torque: LoadTorque::Free,
            starts_from: StartsFrom::Running,
            ..Metadata::default()
        };
        let names = Channel::VOLTAGES
            .into_iter()
            .chain(Channel::CURRENTS)
            .chain([Channel::SPEED]);
        let mut recording = Recording::new("calibration", t, metadata)?;
        for (channel, values) in names.zip(columns) {
            recording = recording.with_channel(channel, values)?;
        }
        Ok(recording)
    }
}

/// What the board is told: the motor without a load of its own, its ranges, and the nominal delays.
fn told(board: &Board, plant: &MotorFile) -> MotorFile {
    let mut motor = plant.clone();
    motor.sensors = sensors(board, plant);
    motor.load = LoadKind::Free;
    motor.mechanics.load_friction = 0.0;
    motor
}

pub fn between([low, high]: [f64; 2], random: &mut Pcg64) -> f64 {
    random.random_range(low..high)
}
