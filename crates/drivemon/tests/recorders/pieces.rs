//! A recording that is judged piece by piece has the alarms and numbers that it has as a whole.

use discovery::Given;
use formats::{read_in_pieces, read_recording, write_recording};
use motor::MotorFile;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::RowAccessor;
use recording::{Error, Mapping, Recording, Source};
use replay::calibrate::{Pieces, Refusal, Surroundings, calibrate, calibrate_pieces};
use replay::check::{Checking, Reference, check};
use report::study::{Checkup, Known, Monitored, Monitoring, Taken};
use scenario::Scenario;
use scenario::simulate::{self, record};
use serde_json::Value;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::Command;

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
    read_in_pieces(path, &flags, rows, &mut |_| {}, &mut |piece, _| {
        pieces += 1;
        monitoring.take(piece, &mut |_| {}).expect("a motor");
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

impl Reference for InPieces {
    fn head(&self) -> &Recording {
        &self.0[0]
    }

    fn samples(&self) -> usize {
        self.0.iter().map(Recording::len).sum()
    }

    fn given(&self, _motor: &MotorFile, _alone: bool) -> Result<Given, Error> {
        let whole = Recording::of_parts(&self.0)?;
        Ok(Given::Source(Source::Recording(whole)))
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

#[test]
fn a_reference_in_pieces_teaches_what_the_whole_teaches() {
    let (whole, pieces, motor) = shipped("healthy-2k2", "peer-2k2");
    let known = Known::of_file(motor.clone(), motor.to_toml());
    let asked = |healthy: &dyn Reference, judged: &[Recording]| {
        let mut read = |_: usize, take: &mut Taken<'_>| judged.iter().try_for_each(&mut *take);
        let names = ["today".to_owned()];
        Checkup::of_pieces::<String>(&known, &[healthy], &names, &mut |_, _| {}, &mut read)
            .expect("healthy")
    };
    let (by_whole, learnt) = asked(&whole, std::slice::from_ref(&whole));
    let (by_pieces, again) = asked(&pieces, &pieces.0);
    assert!(learnt.healthy.is_some(), "{:?}", by_whole.notes);
    assert_eq!(again.to_toml(), learnt.to_toml());
    assert!(by_whole.recordings[0].is_reference && by_pieces.recordings[0].is_reference);
    let (other, _) = asked(&pieces, &pieces.0[..2]);
    assert!(
        !other.recordings[0].is_reference,
        "half of it is another one"
    );
}

/// The rows are the windows of the JSON, number by number; several recordings have no file together.
#[test]
fn a_trace_holds_every_window() {
    let folder = scratch("trace");
    let (whole, _, _) = shipped("direct-on-line-start", "peer-2k2");
    let path = folder.join("start.parquet");
    write_recording(&path, &whole).expect("written");
    let (trace, json) = (folder.join("windows.parquet"), folder.join("answer.json"));
    let asked = |recordings: &[&Path]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_drivemon"));
        command.arg("monitor").args(recordings);
        command.arg("--motor").arg(project("motors/peer-2k2.toml"));
        command.arg("--trace").arg(&trace).arg("--json").arg(&json);
        command.output().expect("the program runs")
    };
    let two = asked(&[&path, &path]);
    assert_eq!(two.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&two.stderr).contains("--trace"));
    assert!(!trace.exists());
    asked(&[&path]);
    let text = std::fs::read_to_string(&json).expect("an answer");
    let answer: Value = serde_json::from_str(&text).expect("JSON");
    let file = File::open(&trace).expect("a trace");
    let reader = SerializedFileReader::new(file).expect("Parquet");
    let rows = reader.get_row_iter(None).expect("rows");
    let rows: Vec<_> = rows.map(|row| row.expect("a row")).collect();
    assert_eq!(
        rows.len() as u64,
        answer["windows"].as_u64().expect("a number")
    );
    let judged = rows.iter().filter(|row| row.get_bool(1).expect("judged"));
    assert_eq!(
        judged.count() as u64,
        answer["judged"].as_u64().expect("a number")
    );
    let with_residuals: Vec<[f64; 2]> = rows
        .iter()
        .map(|row| {
            [
                row.get_double(0).expect("t_s"),
                row.get_double(4).expect("r1"),
            ]
        })
        .filter(|[_, r1]| !r1.is_nan())
        .collect();
    let told: Vec<[f64; 2]> = answer["residuals"]
        .as_array()
        .expect("residuals")
        .iter()
        .map(|one| [&one["t"], &one["r_percent"][0]].map(|x| x.as_f64().expect("a number")))
        .collect();
    assert!(with_residuals.len() > 100);
    assert_eq!(with_residuals.len(), told.len());
    // JSON is read to the last digit but one.
    let same = |(a, b): (f64, f64)| (a - b).abs() <= 2.0 * f64::EPSILON * a.abs();
    let pairs = with_residuals.iter().zip(&told);
    assert!(
        pairs
            .flat_map(|(a, b)| [(a[0], b[0]), (a[1], b[1])])
            .all(same)
    );
}

/// The samples of all pieces are those of the whole, and only the last piece is longer.
#[test]
fn a_scenario_in_pieces_is_the_scenario() {
    let path = project("sim-host/scenarios/direct-on-line-start.toml");
    let scenario = Scenario::read(&path).expect("it ships");
    let whole = record(&scenario, |_| {}).expect("it runs");
    let mut share = 0.0;
    let pieces = simulate::Pieces::new(&scenario, 7_001, |done| share = done).expect("it runs");
    let pieces: Vec<Recording> = pieces.collect::<Result<_, _>>().expect("it runs");
    assert!(pieces.len() > 3 && share == 1.0);
    let (last, others) = pieces.split_last().expect("pieces");
    assert!(others.iter().all(|piece| piece.len() == 7_001) && last.len() <= 7_001 + 7_001 / 30);
    let joined = Recording::of_parts(&pieces).expect("they follow one another");
    assert_eq!(joined.t(), whole.t());
    assert!(joined.channels().eq(whole.channels()));
}
