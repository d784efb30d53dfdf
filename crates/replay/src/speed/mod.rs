//! The speed of a motor without an encoder.
//!
//! The circuit gives a first slip (`circuit.rs`): it is as good as the rotor resistance. The slots of the rotor modulate the
//! air gap and leave lines in the currents whose frequencies follow the speed alone (Hurst and Habetler, IEEE Trans. Power
//! Electron. 11 (1996) 292, doi:10.1109/63.486177). Where they are seen beyond doubt (`search.rs`) they take the circuit's place
//! (`refine.rs`).

mod angle;
mod blocks;
mod circuit;
mod lines;
mod refine;
mod search;
mod spectrum;

use std::f64::consts::TAU;

use motor::MotorFile;
use recording::{Channel, Recording};
use schemars::JsonSchema;
use serde::Serialize;

use circuit::CircuitSlip;

/// Where an estimated speed comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SpeedSource {
    /// The slip that the circuit needs for the measured voltages and currents.
    Circuit,
    /// Lines that the slots of the rotor leave in the currents.
    SlotHarmonics,
}

/// A speed that nobody measured.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct EstimatedSpeed {
    /// Mean over the recording, rpm.
    pub mean_rpm: f64,
    /// Mean slip, percent of synchronous speed.
    pub slip_percent: f64,
    /// Half of the slip's 95 % interval, percent of synchronous speed.
    pub slip_half_width_percent: f64,
    /// Where it comes from.
    pub source: SpeedSource,
    /// Numbers of rotor bars that explain the slot harmonics seen, the likeliest first; empty where none are seen. More than one:
    /// the harmonics are there, but the speed they mean depends on the number.
    pub rotor_bars: Vec<u32>,
}

/// The recording with an estimated speed; `None` where it has a speed, lacks voltages or currents, or the motor does not run.
pub fn with_estimated_speed(
    recording: &Recording,
    motor: &MotorFile,
) -> Option<(Recording, EstimatedSpeed)> {
    if recording.speed().is_some() {
        return None;
    }
    let circuit = CircuitSlip::of(recording, motor)?;
    let found = spectral(&circuit, motor);
    let (slip, half_width, source) = match &found.slip {
        Some(better) => (
            better.per_sample(&circuit),
            better.half_width,
            SpeedSource::SlotHarmonics,
        ),
        None => (
            circuit.slip.clone(),
            circuit.half_width,
            SpeedSource::Circuit,
        ),
    };
    let synchronous = circuit.omega / f64::from(motor.nameplate.pole_pairs);
    let mean = slip.iter().sum::<f64>() / slip.len() as f64;
    let estimated = EstimatedSpeed {
        mean_rpm: synchronous * (1.0 - mean) * 60.0 / TAU,
        slip_percent: 100.0 * mean,
        slip_half_width_percent: 100.0 * half_width,
        source,
        rotor_bars: found.rotor_bars,
    };
    let speed = slip.iter().map(|s| synchronous * (1.0 - s)).collect();
    let with_speed = recording.clone().with_channel(Channel::SPEED, speed).ok()?;
    Some((with_speed, estimated))
}

/// What the spectrum of the currents says.
#[derive(Default)]
struct Spectral {
    slip: Option<refine::Refined>,
    rotor_bars: Vec<u32>,
}

/// Cycles in one block of the spectra: the short ones follow the load, the long ones tell lines from harmonics at little slip.
const BLOCKS_CYCLES: [usize; 2] = [50, 250];

/// Short blocks first; long ones where those show nothing.
fn spectral(circuit: &CircuitSlip, motor: &MotorFile) -> Spectral {
    let mut spectral = Spectral::default();
    let Some(turned) = angle::Turned::of(circuit) else {
        return spectral;
    };
    for cycles in BLOCKS_CYCLES {
        let Some(blocks) = blocks::Blocks::of(&turned, cycles, motor) else {
            continue;
        };
        let found = search::search(&blocks, circuit, motor);
        if !found.rotor_bars.is_empty() {
            spectral.rotor_bars = found.rotor_bars;
        }
        if let Some(unique) = found.unique {
            spectral.slip = refine::refine(&turned, &blocks, &unique);
            break;
        }
    }
    spectral
}
