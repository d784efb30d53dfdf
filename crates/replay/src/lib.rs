//! Replaying a recording through the very core that the board runs.
//!
//! ```
//! use monitor::Monitor;
//! use motor::MotorFile;
//! use audit::{Expectation, audit};
//! use formats::read_recording;
//! use recording::Mapping;
//! use replay::{Samples, config_for, replay};
//!
//! let motor = MotorFile::read("../../tests/data/peer/none/motor.toml").expect("a motor file");
//! let file = "../../tests/data/peer/none/recording.csv.gz".as_ref();
//! let recording = read_recording(file, &Mapping::default(), &mut |_| {}).expect("readable");
//! let config = config_for(&motor, &recording).expect("effects of the library");
//! let monitor = Monitor::new(config).expect("a valid configuration");
//! let audit = audit(&recording, &Expectation::from(&motor));
//! let timeline = replay(&monitor, &Samples::new(&recording, &audit), &mut |_| {});
//! assert_eq!(timeline.verdict(&audit.findings).state, replay::VerdictState::Healthy);
//! ```

mod alarm_causes;
pub mod calibrate;
pub mod causes;
pub mod channels;
pub mod check;
mod judgement;
mod moving;
pub mod operating_points;
mod rotor;
mod run;
mod samples;
pub mod speed;
mod timeline;
pub mod words;

pub use judgement::{Direction, NotJudgedShare, Unjudged};
pub use moving::{Follower, MotionFault, MotionShare, MotionSummary};
pub use rotor::{RotorCage, RotorSummary};
pub use run::{Replay, replay};
pub use samples::{Before, Samples, Timed};
pub use timeline::{
    BeyondCalibration, LampState, SequenceSummary, Timeline, Trace, Verdict, VerdictState,
    WindowOperation, WindowResiduals,
};

use monitor::{
    ActiveEffects, ComparatorConfig, Converter, FieldCurrent, Frame, LoadKind, MonitorConfig,
    ParameterDoubt,
};
use motor::FileError;
use motor::{Mechanics, MotorFile, TParams};
use recording::{LoadTorque, Recording};

fn sampled_wrongly(t_sample: f64) -> String {
    let [shortest, longest] = MonitorConfig::SAMPLING_TIMES;
    format!(
        "it is sampled every {} s, {} times a second; {:.0} to {:.0} times a second can be judged. Is its clock in another unit? Then say \
         --unit t=ms or --unit t=us; otherwise record at 5 to 20 kHz",
        audit::digits(t_sample, 6),
        audit::digits(1.0 / t_sample, 6),
        1.0 / longest,
        1.0 / shortest
    )
}

/// The configuration for a recording: the motor file's, with the sampling time and the load knowledge of the recording.
///
/// # Errors
/// As [`MonitorConfig::from_motor_file`], and a recording that is sampled too slowly or too fast for the core.
pub fn config_for(motor: &MotorFile, recording: &Recording) -> Result<MonitorConfig, FileError> {
    let t_sample = recording.t_sample();
    let [shortest, longest] = MonitorConfig::SAMPLING_TIMES;
    if !(shortest..=longest).contains(&(t_sample as f32)) {
        return Err(FileError::whole(
            recording.name(),
            sampled_wrongly(t_sample),
        ));
    }
    let mut config = MonitorConfig::from_motor_file(motor, recording.t_sample())?;
    config.load = match recording.metadata.load_torque {
        LoadTorque::Measured if recording.torque().is_some() => LoadKind::Measured,
        LoadTorque::Measured | LoadTorque::Free => LoadKind::Free,
        LoadTorque::Friction | LoadTorque::Undeclared => config.load,
    };
    Ok(config)
}

/// A configuration for a recording of an unknown motor: it measures sequence components and judges nothing.
///
/// The scales come from the recording's own peaks; the parameters are those of a typical small motor on these
/// scales, and no residual is ever formed from them because the speed is left out.
pub fn stand_in_config(recording: &Recording) -> MonitorConfig {
    let peak = |channels: Option<[&[f64]; 3]>| {
        let values = channels.into_iter().flatten().flatten();
        values.fold(0.0_f64, |peak, x| peak.max(x.abs())) as f32
    };
    let at_least = |x: f32| if x > 0.0 { x } else { 1.0 };
    let volt = at_least(peak(recording.voltages()));
    let amp = at_least(peak(recording.currents()));
    let ohm = volt / amp;
    MonitorConfig {
        t_sample: recording.t_sample() as f32,
        converter: Converter::bipolar(volt, amp, 12),
        encoder_counts_per_revolution: 4096.0,
        params: TParams {
            r_s: 0.05 * ohm,
            r_r: 0.05 * ohm,
            l_ls: 0.1 * ohm / STAND_IN_OMEGA,
            l_lr: 0.1 * ohm / STAND_IN_OMEGA,
            l_m: 2.0 * ohm / STAND_IN_OMEGA,
        },
        effects: ActiveEffects::default(),
        laws: Default::default(),
        channel_gain: [1.0; monitor::CHANNELS],
        mechanics: Mechanics {
            n_p: 2.0,
            inertia: 0.01,
            friction: 0.0,
            load_friction: 0.0,
        },
        rated_voltage: volt,
        rated_current: amp,
        rated_omega: STAND_IN_OMEGA,
        rated_torque: 1.0,
        frame: Frame::RotorFlux,
        field: FieldCurrent::Live,
        load: LoadKind::Free,
        thresholds: [1.0; 4],
        window_cycles: 5,
        comparator: ComparatorConfig {
            persistence: 3,
            hysteresis: 0.8,
        },
        healthy: None,
        cage: monitor::Cage::UNKNOWN,
        doubt: ParameterDoubt::default(),
    }
}

/// 50 Hz, rad/s.
const STAND_IN_OMEGA: f32 = 314.16;

#[cfg(test)]
mod tests {
    use super::*;
    use recording::Metadata;

    fn load(declared: LoadTorque) -> LoadKind {
        let text = include_str!("../../../motors/assumed-300w.toml");
        let motor = MotorFile::parse(text, "motor").expect("it ships");
        let metadata = Metadata {
            load_torque: declared,
            ..Metadata::default()
        };
        let recording = Recording::new("x", vec![0.0, 1e-4], metadata).expect("a clock");
        config_for(&motor, &recording).expect("it ships").load
    }

    #[test]
    fn a_recording_that_declares_its_load_unknown_overrules_the_motor_file() {
        assert_eq!(load(LoadTorque::default()), LoadKind::Friction);
        assert_eq!(load(LoadTorque::Free), LoadKind::Free);
        // Nothing was recorded of what is called measured.
        assert_eq!(load(LoadTorque::Measured), LoadKind::Free);
    }
}
