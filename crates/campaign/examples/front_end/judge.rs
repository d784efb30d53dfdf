//! A healthy motor behind a board, judged by the core.

use crate::board::Board;
use audit::{Expectation, audit};
use formats::{read_recording, write_recording};
use monitor::{Lamp, Monitor};
use motor::MotorFile;
use motor::load::Load;
use motor::motor_file::Sensors;
use recording::{Channel, Mapping, Recording, Target};
use replay::{Samples, config_for};
use scenario::simulate::record;
use scenario::{LoadSpec, Scenario, SensorSpec};
use std::error::Error;

/// Enough for FAULT: windows of five cycles, three of them in a row.
const DURATION_S: f64 = 0.8;
/// Noise of the converter, LSB of 12 bits.
const NOISE_LSB: f64 = 0.7;
const FULL_SCALE_LSB: f64 = 2048.0;

/// What the core said.
pub struct Judged {
    pub fault: bool,
    pub sensor: bool,
    pub r4_percent: f64,
}

pub fn judge(board: &Board, motor: &MotorFile) -> Result<Judged, Box<dyn Error>> {
    let scenario = scenario(board, motor);
    let recording = record(&scenario, |_| ())?;
    let recording = match board.known_delays {
        Some(delays) => told(&recording, delays)?,
        None => recording,
    };
    let audit = audit(&recording, &Expectation::from(&scenario.motor));
    let monitor = Monitor::new(config_for(&scenario.motor, &recording)?)?;
    let timeline = replay::replay(&monitor, &Samples::new(&recording, &audit), &mut |_| ());
    let (means, _) = timeline
        .residual_percent()
        .ok_or("no window was judged: the table would be empty")?;
    let lit = |lamp: Lamp| lamp == Lamp::On;
    Ok(Judged {
        fault: timeline.lamps.iter().any(|lamps| lit(lamps.fault)),
        sensor: timeline.lamps.iter().any(|lamps| lit(lamps.sensor)),
        r4_percent: means[3],
    })
}

/// Rated load, its torque measured; ranges as the board has them.
fn scenario(board: &Board, motor: &MotorFile) -> Scenario {
    let mut motor = motor.clone();
    motor.sensors = Sensors {
        voltage_full_scale_volt: board.voltage_full_scale,
        current_full_scale_amp: board.current_headroom * motor.nameplate.current_amplitude(),
        noise_sigma_fraction_of_full_scale: NOISE_LSB / FULL_SCALE_LSB,
        adc_bits: 12,
        ..motor.sensors
    };
    let torque = motor.nameplate.torque_nm;
    Scenario {
        seed: board.seed,
        load: LoadSpec {
            friction_factor: 0.0,
            other: Load::Constant {
                torque,
                active: false,
            },
        },
        sensors: SensorSpec {
            torque: true,
            chain: Some(board.chain.clone()),
            ..SensorSpec::of(&motor)
        },
        ..Scenario::of(motor, DURATION_S)
    }
}

/// The recording as its reader gives it when a sidecar says by how much each channel is late.
fn told(recording: &Recording, delays: [f64; 6]) -> Result<Recording, Box<dyn Error>> {
    let file = format!("drivemon-front-end-{}.csv", std::process::id());
    let path = std::env::temp_dir().join(file);
    write_recording(&path, recording)?;
    let mut mapping = Mapping::default();
    let channels = Channel::VOLTAGES.into_iter().chain(Channel::CURRENTS);
    for (channel, late) in channels.zip(delays) {
        // A channel that shows what was before counts as sampled earlier.
        mapping.entry(Target::Channel(channel)).delay = Some(-late);
    }
    let read = read_recording(&path, &mapping, &mut |_| ());
    std::fs::remove_file(&path)?;
    // Beside the recording there may be its sidecar.
    let _ = std::fs::remove_file(recording::sidecar_path(&path));
    Ok(read?)
}
