//! A machine calibrated as its user would do it: some seconds at several loads and voltages, through the machine's own board.

use monitor::{Monitor, MonitorConfig, SpeedSample};
use motor::MotorFile;
use motor::motor_file::LoadKind;
use rand::Rng;
use rand_pcg::Pcg64;
use recording::{Channel, LoadTorque, Metadata, Recording, StartsFrom, Supply, VoltageKind};
use replay::calibrate::{Surroundings, calibrate};
use scenario::simulate::Simulation;
use scenario::{Load, LoadSpec, Piecewise, Scenario, SupplySpec};

use super::events::{components, sensors};
use super::instrument::Shown;
use super::machine::Machine;
use super::operating::{Conditions, warmed};
use crate::runs::run::T_SAMPLE_S;

/// Length of each recording, s.
const RECORDED_S: f64 = 2.0;
/// Loads and voltages that are recorded, shares of the ordinary ones' range and of the ordinary voltage.
const RECORDED: [(f64, f64); 4] = [(0.0, 1.0), (0.4, 0.97), (0.7, 1.03), (1.0, 1.0)];

/// Why a machine is not watched.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{machine}: {why}")]
pub struct Unlearnt {
    /// The machine in words.
    pub machine: String,
    /// What calibration or simulation said.
    pub why: String,
}

/// A machine with the motor file that its calibration made.
#[derive(Clone, Debug)]
pub struct Watched {
    /// The machine.
    pub machine: Machine,
    /// What the board is told.
    pub motor: MotorFile,
    pub(super) config: MonitorConfig,
    pub(super) monitor: Monitor,
}

impl Watched {
    /// Records the machine and calibrates the motor file that was believed.
    ///
    /// # Errors
    /// What the calibration refuses, in its words.
    pub fn learn(
        machine: Machine,
        surroundings: &Surroundings,
        random: &mut Pcg64,
    ) -> Result<Watched, Unlearnt> {
        let refused = |why: String| Unlearnt {
            machine: machine.words.clone(),
            why,
        };
        let degc = machine.heat.shared([
            random.random_range(30.0..75.0),
            random.random_range(35.0..85.0),
        ]);
        let mut recordings = Vec::new();
        for (load, voltage) in RECORDED {
            let at = conditions(&machine, load, voltage, degc);
            recordings.push(recording(&machine, &at, random).map_err(refused)?);
        }
        let calibrated = calibrate(&machine.believed, &recordings, surroundings)
            .map_err(|refusal| refused(refusal.to_string()))?;
        let motor = calibrated.motor;
        let config = MonitorConfig::from_motor_file(&motor, T_SAMPLE_S)
            .map_err(|error| refused(error.to_string()))?;
        let monitor = Monitor::new(config).map_err(|error| refused(error.to_string()))?;
        Ok(Watched {
            machine,
            motor,
            config,
            monitor,
        })
    }
}

/// Conditions of a calibration.
fn conditions(machine: &Machine, load: f64, voltage: f64, degc: [f64; 2]) -> Conditions {
    let plate = &machine.truth.nameplate;
    let [low, high] = machine.habits.load_range;
    let torque = match machine.truth.load {
        LoadKind::Friction => 0.0,
        _ => (low + (high - low) * load) * plate.torque_nm,
    };
    Conditions {
        volt: machine.voltage * voltage * plate.phase_voltage_amplitude(),
        hertz: plate.frequency_hz,
        unbalance: machine.unbalance,
        torque,
        friction: 1.0,
        degc,
        cabinet_degc: 30.0,
    }
}

/// What the board shows at steady conditions, as a recording.
fn recording(machine: &Machine, at: &Conditions, random: &mut Pcg64) -> Result<Recording, String> {
    let mut scenario = Scenario::of(warmed(&machine.truth, at.degc), RECORDED_S);
    scenario.seed = random.random_range(0..u64::from(u32::MAX));
    scenario.sensors = sensors(&machine.instrument, at.cabinet_degc, &scenario);
    scenario.supply = SupplySpec {
        amplitude_volt: Piecewise::constant(at.volt),
        frequency_hz: Piecewise::constant(at.hertz),
        components: components(machine, at),
        ..SupplySpec::rated(&machine.truth.nameplate)
    };
    scenario.load = LoadSpec {
        friction_factor: at.friction,
        other: Load::Constant {
            torque: at.torque,
            active: true,
        },
    };
    let told = MonitorConfig::from_motor_file(&machine.believed, T_SAMPLE_S)
        .map_err(|error| error.to_string())?;
    let simulation = Simulation::new(&scenario).map_err(|error| error.to_string())?;
    let shown = Shown::new(simulation, told.converter, &machine.instrument, false);
    columns(shown, machine).map_err(|error| error.to_string())
}

fn columns(shown: Shown, machine: &Machine) -> Result<Recording, recording::Error> {
    let mut t = Vec::new();
    let mut channels: [Vec<f64>; 7] = Default::default();
    for (simulated, sample) in shown {
        t.push(simulated.t);
        let [u, i] = [sample.u_s_abc, sample.i_s_abc].map(|x| x.unwrap_or_default().to_array());
        let analogue = u.into_iter().chain(i).map(f64::from);
        let all = analogue.chain([simulated.measured.omega_mech]);
        debug_assert!(matches!(sample.speed, SpeedSample::Count(_)));
        for (column, value) in channels.iter_mut().zip(all) {
            column.push(value);
        }
    }
    let metadata = Metadata {
        voltage: VoltageKind::Instantaneous,
        supply: Supply::Grid,
        supply_belief: "simulated grid".to_owned(),
        load_torque: match machine.truth.load {
            LoadKind::Friction => LoadTorque::Friction,
            _ => LoadTorque::Free,
        },
        starts_from: StartsFrom::Running,
        ..Metadata::default()
    };
    let names = Channel::VOLTAGES
        .into_iter()
        .chain(Channel::CURRENTS)
        .chain([Channel::SPEED]);
    let empty = Recording::new("calibration", t, metadata)?;
    names
        .zip(channels)
        .try_fold(empty, |recording, (channel, values)| {
            recording.with_channel(channel, values)
        })
}
