//! A healthy motor behind a board, judged by the core as the board does: from the converter's codes.

use crate::board::{Board, Known};
use monitor::{ClippedChannels, Lamp, Monitor, MonitorConfig, MonitorState, RawSample};
use motor::MotorFile;
use motor::motor_file::{LoadKind, Sensors};
use replay::Timeline;
use scenario::simulate::{Measured, Simulation};
use scenario::{Scenario, SensorSpec};
use std::error::Error;

/// Enough for FAULT: windows of five cycles, three of them in a row.
const DURATION_S: f64 = 0.8;
/// Noise of the converter, LSB of 12 bits.
const NOISE_LSB: f64 = 0.7;
const FULL_SCALE_LSB: f64 = 2048.0;
/// The same as a share of full scale.
pub const NOISE: f64 = NOISE_LSB / FULL_SCALE_LSB;

/// What the core said.
pub struct Judged {
    pub fault: bool,
    pub sensor: bool,
    pub r4_percent: f64,
}

pub fn judge(board: &Board, motor: &MotorFile) -> Result<Judged, Box<dyn Error>> {
    let motor = behind(board, motor)?;
    let scenario = scenario(board, &motor);
    let config = MonitorConfig::from_motor_file(&motor, scenario.t_sample())?;
    let mut timeline = Timeline::new(&config);
    let monitor = Monitor::new(config)?;
    let mut state = MonitorState::default();
    for sample in Simulation::new(&scenario)? {
        if let Some(report) = monitor.update_raw(&mut state, &raw(&sample.measured)) {
            timeline.add(sample.t, &report);
        }
    }
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

/// What the motor file of a board says of it: its ranges, and what is known of its delays.
pub fn sensors(board: &Board, motor: &MotorFile) -> Sensors {
    let known = board.known.unwrap_or(Known::NOTHING);
    let [a, b, c, d, e, f] = known.delays_s;
    Sensors {
        voltage_full_scale_volt: board.voltage_full_scale,
        current_full_scale_amp: board.current_headroom * motor.nameplate.current_amplitude(),
        noise_sigma_fraction_of_full_scale: NOISE,
        adc_bits: 12,
        conversions: board.chain.conversions,
        voltage_delay_s: [a, b, c],
        current_delay_s: [d, e, f],
        roll_off_s: known.roll_off_s,
        ..motor.sensors
    }
}

/// The motor file of the board. The load is a friction that takes the rated
/// torque at rated speed, the only kind of load that a board knows.
fn behind(board: &Board, motor: &MotorFile) -> Result<MotorFile, Box<dyn Error>> {
    let mut motor = motor.clone();
    motor.sensors = sensors(board, &motor);
    motor.load = LoadKind::Friction;
    let plate = &motor.nameplate;
    let rated_speed = plate.synchronous_speed_mech() * (1.0 - plate.rated_slip());
    let friction = plate.torque_nm / rated_speed - motor.mechanics.friction;
    if friction <= 0.0 {
        return Err("the motor's own friction takes more than the rated torque".into());
    }
    motor.mechanics.load_friction = friction;
    Ok(motor)
}

fn scenario(board: &Board, motor: &MotorFile) -> Scenario {
    Scenario {
        seed: board.seed,
        sensors: SensorSpec {
            speed: scenario::SpeedSensor::Encoder,
            chain: Some(board.chain.clone()),
            ..SensorSpec::of(motor)
        },
        ..Scenario::of(motor.clone(), DURATION_S)
    }
}

/// What the board's core gets.
pub fn raw(measured: &Measured) -> RawSample {
    RawSample {
        voltage_codes: measured.voltage_codes,
        current_codes: measured.current_codes,
        encoder_count: measured.encoder_count,
        clipped: ClippedChannels::of(measured.clipped),
    }
}
