//! A recording that is judged piece by piece has the alarms and numbers that it has as a whole.

use formats::{read_in_pieces, read_recording, write_recording};
use motor::MotorFile;
use recording::{Error, Mapping, Recording};
use replay::calibrate::{Pieces, Refusal, Surroundings, calibrate, calibrate_pieces};
use replay::check::{Checking, check};
use report::study::{Monitored, Monitoring};
use scenario::Scenario;
use scenario::simulate::record;
use serde_json::Value;
use std::path::{Path, PathBuf};

use crate::common::{PROJECT, scratch};

fn project(path: &str) -> PathBuf {
    Path::new(PROJECT).join(path)
}

/// The answer without its audit, which each piece has for itself.
fn without_audit(result: &Monitored) -> Value {
    let mut answer = serde_json::to_value(result).expect("JSON");
    let keys = answer.as_object_mut().expect("an object");
    keys.remove("audit").expect("an audit");
    keys.remove("assumptions").expect("assumptions");
    answer
}

/// Answers about a recording as a whole and in pieces of `rows` samples, and how many pieces there were.
fn both(path: &Path, motor: &MotorFile, rows: usize) -> ([Monitored; 2], usize) {
    let flags = Mapping::default();
    let recording = read_recording(path, &flags, &mut |_| {}).expect("readable");
    let whole = Monitored::new(&recording, Some(motor), &mut |_| {}).expect("a motor");
    let (mut monitoring, mut pieces) = (Monitoring::new(Some(motor)), 0);
    read_in_pieces(path, &flags, rows, &mut |_| {}, &mut |piece| {
        pieces += 1;
        monitoring.take(&piece, &mut |_| {}).expect("a motor");
        Ok::<(), Error>(())
    })
    .expect("readable");
    ([whole, monitoring.finish()], pieces)
}

/// Faults, load steps and a start: pieces end in the middle of windows, of transients, of alarms.
#[test]
fn alarms_and_numbers_are_those_of_the_whole_to_the_last_bit() {
    let folder = scratch("pieces");
    let cases = [
        (
            "direct-on-line-start",
            "peer-2k2-calibrated",
            "parquet",
            3_517,
        ),
        ("broken-bars", "peer-2k2-calibrated", "parquet", 9_001),
        ("sensor-faults", "assumed-300w-calibrated", "csv", 7_777),
        ("supply-steps", "peer-2k2", "csv.gz", 10_000),
    ];
    let (mut faults, mut in_motion) = (0, 0);
    for (scenario, motor, extension, rows) in cases {
        let path = project(&format!("sim-host/scenarios/{scenario}.toml"));
        let recording = record(&Scenario::read(&path).expect("it ships"), |_| {}).expect("it runs");
        let path = folder.join(format!("{scenario}.{extension}"));
        write_recording(&path, &recording).expect("written");
        let motor = MotorFile::read(project(&format!("motors/{motor}.toml"))).expect("it ships");
        let ([whole, in_pieces], pieces) = both(&path, &motor, rows);
        assert!(pieces > 3, "{scenario}: {pieces} pieces");
        assert_eq!(
            without_audit(&in_pieces),
            without_audit(&whole),
            "{scenario}"
        );
        assert!(in_pieces.audit.supported);
        faults += usize::from(whole.timeline.first_alarm_s.is_some());
        in_motion += whole.timeline.motion.judged;
    }
    assert!(faults >= 2 && in_motion > 0, "{faults} {in_motion}");
}

/// A recording that comes in pieces each time that it is asked for.
struct InPieces(Vec<Recording>);

impl Pieces for InPieces {
    fn name(&self) -> &str {
        self.0[0].name()
    }

    fn each(&self, take: &mut dyn FnMut(&Recording) -> Result<(), Refusal>) -> Result<(), Refusal> {
        self.0.iter().try_for_each(take)
    }
}

fn shipped(scenario: &str, motor: &str) -> (Recording, InPieces, MotorFile) {
    let path = project(&format!("sim-host/scenarios/{scenario}.toml"));
    let whole = record(&Scenario::read(&path).expect("it ships"), |_| {}).expect("it runs");
    let cuts = (0..whole.len()).step_by(13_001);
    let piece = |from: usize| whole.slice(from..(from + 13_001).min(whole.len()));
    let pieces = cuts.map(piece).collect::<Result<_, _>>().expect("pieces");
    let motor = MotorFile::read(project(&format!("motors/{motor}.toml"))).expect("it ships");
    (whole, InPieces(pieces), motor)
}

#[test]
fn a_motor_is_learnt_from_pieces_as_from_the_whole() {
    let (whole, pieces, motor) = shipped("healthy-2k2", "peer-2k2");
    let surroundings = Surroundings::default();
    let learnt = calibrate(&motor, &[whole], &surroundings).expect("healthy");
    assert!(pieces.0.len() > 3);
    let again = calibrate_pieces(&motor, &[&pieces], &surroundings).expect("healthy");
    assert_eq!(again.motor.to_toml(), learnt.motor.to_toml());
    assert_eq!(again.windows, learnt.windows);
}

#[test]
fn a_check_in_pieces_says_what_a_check_of_the_whole_says() {
    let (whole, pieces, motor) = shipped("broken-bars", "peer-2k2-calibrated");
    let all = check(&whole, &motor, &mut |_| {}).expect("a motor");
    let mut checking = Checking::new(&motor);
    for piece in &pieces.0 {
        checking.take(piece, &mut |_| {}).expect("a motor");
    }
    let in_pieces = checking.finish();
    assert_eq!(in_pieces.verdict, all.verdict);
    assert_eq!(in_pieces.told, all.told);
    assert_eq!(
        (in_pieces.windows, in_pieces.rotor),
        (all.windows, all.rotor)
    );
    assert_eq!(in_pieces.residuals, all.residuals);
    assert_eq!(all.verdict.state, replay::VerdictState::Fault);
}
