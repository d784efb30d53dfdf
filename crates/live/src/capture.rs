//! The samples around an alarm, from their pieces to a recording.

use std::f64::consts::TAU;

use board::{CAPTURE_EVERY, CaptureChunk, MotorImage, captured_samples};
use monitor::{MonitorConfig, RawSample};
use motor::motor_file::{LoadKind, MotorFile};
use recording::{Channel, LoadTorque, Metadata, Recording, Sensors, StartsFrom, delay};

/// s; sampling time of the board.
const T_SAMPLE: f64 = 1e-4;
/// Edges per pulse of the board's counter.
const EDGES_PER_PULSE: f64 = 4.0;
/// Samples on either side over which edges are counted: 5 ms in all, as for any recording of a counter.
const HALF_SPAN: usize = 6;

/// Joins the pieces, in whatever order they come.
#[derive(Debug, Default)]
pub struct Collector {
    pieces: Vec<Option<CaptureChunk>>,
    done: Option<u8>,
}

/// A whole capture.
#[derive(Clone, Debug, PartialEq)]
pub struct Fetched {
    /// What the board calls its motor constants.
    pub motor: u32,
    /// The samples, oldest first.
    pub samples: Vec<RawSample>,
}

/// Why a capture is no recording.
#[derive(Debug, thiserror::Error)]
pub enum CaptureError {
    /// What was kept is no capture.
    #[error("{0} bytes are no samples around an alarm; was the file changed by another program?")]
    Damaged(usize),
    /// The motor file is another one.
    #[error(
        "the board was flashed with other motor constants than those in this motor file; name the file that it was flashed with"
    )]
    OtherMotor,
    /// The motor file has effects that the core cannot take.
    #[error(transparent)]
    Motor(#[from] motor::FileError),
    /// The samples do not make a recording.
    #[error(transparent)]
    Recording(#[from] recording::Error),
}

impl Collector {
    /// Takes a piece; the capture when it is the last one missing. Each capture comes out once.
    pub fn take(&mut self, piece: CaptureChunk) -> Option<Fetched> {
        let begun = self.pieces.iter().flatten().next();
        let other = begun.is_some_and(|begun| {
            (begun.number, begun.count, begun.motor) != (piece.number, piece.count, piece.motor)
        });
        if other || self.pieces.is_empty() {
            self.pieces = vec![None; usize::from(piece.count)];
        }
        if let Some(place) = self.pieces.get_mut(usize::from(piece.index)) {
            *place = Some(piece);
        }
        let whole: Vec<CaptureChunk> = self.pieces.iter().copied().collect::<Option<_>>()?;
        if self.done == Some(piece.number) {
            return None;
        }
        self.done = Some(piece.number);
        Some(Fetched {
            motor: piece.motor,
            samples: whole.iter().flat_map(CaptureChunk::samples).collect(),
        })
    }
}

impl Fetched {
    /// From the instants of a board's file ([`board::captured_samples`]).
    ///
    /// # Errors
    /// Bytes of another length.
    pub fn of_file(motor: u32, instants: &[u8]) -> Result<Self, CaptureError> {
        let samples = captured_samples(instants);
        let samples = samples.ok_or(CaptureError::Damaged(instants.len()))?;
        Ok(Fetched {
            motor,
            samples: samples.collect(),
        })
    }
}

/// The capture in SI units, as the motor file's sensors give them, each channel at the time of its row. The roll-off of the
/// filter stays (0.03 % at 50 Hz on the documented one), and what was learnt on the board is not applied.
///
/// # Errors
/// A motor file that the board was not flashed with.
pub fn recording(fetched: &Fetched, motor: &MotorFile) -> Result<Recording, CaptureError> {
    let config = MonitorConfig::of_board(motor)?;
    if MotorImage::new(&config).identification() != fetched.motor {
        return Err(CaptureError::OtherMotor);
    }
    let step = T_SAMPLE * CAPTURE_EVERY as f64;
    let t: Vec<f64> = (0..fetched.samples.len())
        .map(|k| k as f64 * step)
        .collect();
    let mut columns = [const { Vec::new() }; 6];
    for raw in &fetched.samples {
        let sample = config.converter.convert(raw);
        let (u, i) = (
            sample.u_s_abc.unwrap_or_default(),
            sample.i_s_abc.unwrap_or_default(),
        );
        for (column, x) in columns.iter_mut().zip([u.a, u.b, u.c, i.a, i.b, i.c]) {
            column.push(f64::from(x));
        }
    }
    let speed = speed(&fetched.samples, step, motor);
    let mut recording = Recording::new(&motor.name, t, metadata(motor))?;
    let channels = [Channel::VOLTAGES, Channel::CURRENTS].concat();
    let late = config.converter.chain.delay;
    for ((channel, values), late) in channels.into_iter().zip(columns).zip(late) {
        // A channel that is late shows what was before, as one sampled earlier does.
        let values = delay::at_row_times(recording.t(), &values, -f64::from(late), step);
        recording = recording.with_channel(channel, values)?;
    }
    Ok(recording.with_channel(Channel::SPEED, speed)?)
}

/// Centred difference of the running count, rad/s.
fn speed(samples: &[RawSample], step: f64, motor: &MotorFile) -> Vec<f64> {
    let edges = EDGES_PER_PULSE * f64::from(motor.sensors.encoder_pulses_per_revolution);
    let mut counts = vec![0.0];
    for pair in samples.windows(2) {
        let moved = pair[1].encoder_count.wrapping_sub(pair[0].encoder_count) as i16;
        counts.push(counts[counts.len() - 1] + f64::from(moved));
    }
    let last = counts.len() - 1;
    let slope = |k: usize| {
        let (from, to) = (k.saturating_sub(HALF_SPAN), (k + HALF_SPAN).min(last));
        (counts[to] - counts[from]) / ((to - from).max(1) as f64 * step)
    };
    (0..counts.len()).map(|k| TAU / edges * slope(k)).collect()
}

fn metadata(motor: &MotorFile) -> Metadata {
    Metadata {
        supply_belief: "not known: samples around an alarm, fetched from the board".into(),
        load_torque: match motor.load {
            LoadKind::Friction => LoadTorque::Friction,
            LoadKind::Measured | LoadKind::Free => LoadTorque::Free,
        },
        starts_from: StartsFrom::Running,
        sensors: Sensors {
            voltage_full_scale_volt: Some(motor.sensors.voltage_full_scale_volt),
            current_full_scale_amp: Some(motor.sensors.current_full_scale_amp),
            adc_bits: Some(motor.sensors.adc_bits),
            ..Sensors::default()
        },
        ..Metadata::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAMPLES: usize = 400;
    const LATE_S: f64 = 88.94e-6;

    fn motor() -> MotorFile {
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../motors/assumed-300w.toml"
        );
        let mut motor = MotorFile::read(path).expect("shipped");
        motor.sensors.voltage_delay_s = [LATE_S; 3];
        motor
    }

    fn wave(t: f64) -> f64 {
        (TAU * 50.0 * t).sin()
    }

    /// What a board captures of a wave in all channels, the voltages late.
    fn fetched(motor: &MotorFile) -> Fetched {
        let config = MonitorConfig::of_board(motor).expect("valid");
        let code = |t: f64| (16.0 * (2048.0 + 2000.0 * wave(t))).round() as u16;
        let step = T_SAMPLE * CAPTURE_EVERY as f64;
        let sample = |k: usize| RawSample {
            voltage_codes: [code(k as f64 * step - LATE_S); 3],
            current_codes: [code(k as f64 * step); 3],
            encoder_count: 0,
            ..RawSample::default()
        };
        Fetched {
            motor: MotorImage::new(&config).identification(),
            samples: (0..SAMPLES).map(sample).collect(),
        }
    }

    #[test]
    fn a_late_channel_stands_at_the_time_of_its_row() {
        let motor = motor();
        let recording = recording(&fetched(&motor), &motor).expect("a recording");
        let share = |channels: [&[f64]; 3], scale: f64| -> Vec<f64> {
            channels[0].iter().map(|x| x / (scale * 2000.0)).collect()
        };
        let shown = [
            share(
                recording.voltages().expect("voltages"),
                motor.sensors.volt_per_code(),
            ),
            share(
                recording.currents().expect("currents"),
                motor.sensors.amp_per_code(),
            ),
        ];
        for x in shown {
            // The polynomial lacks points beside the ends. Half a code is 2.5e-4, and the weights of eight roundings add up.
            for (x, t) in x.iter().zip(recording.t()).skip(5).take(SAMPLES - 10) {
                assert!((x - wave(*t)).abs() < 6e-4, "{t}: {x}");
            }
        }
    }
}
