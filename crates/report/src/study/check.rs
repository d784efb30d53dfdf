//! Is this motor in good order? From what is known of it and recordings to an answer on which a technician can act.

use discovery::Progress;
use motor::MotorFile;
use recording::Recording;
use replay::VerdictState;
use replay::check::{Checked, Checking, Knowledge, Reference, begins_like, learn};
use schemars::JsonSchema;
use serde::Serialize;

use super::known::{Known, ParameterRow, PlateRow, parameters};

/// Everything that a check says.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Checkup {
    /// The motor's name.
    pub motor: String,
    /// How well it is known.
    pub knowledge: Knowledge,
    /// Whether it was ever seen in good order: without that only large faults show.
    pub calibrated: bool,
    /// How well it is known, in words.
    pub known_by: &'static str,
    /// Why a step of learning was not possible.
    pub notes: Vec<String>,
    /// What contradicts what on the plate.
    pub contradictions: Vec<String>,
    /// The plate's numbers beside the circuit's.
    pub plate: Vec<PlateRow>,
    /// The motor's parameters with their intervals.
    pub parameters: Vec<ParameterRow>,
    /// The parameters that recordings of the motor in good order told.
    #[serde(skip)]
    pub identified: Option<discovery::IdentifyReport>,
    /// One answer per recording.
    pub recordings: Vec<CheckedRecording>,
    /// The motor file that was written.
    pub motor_file: Option<String>,
}

/// What one recording says.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct CheckedRecording {
    /// Its name.
    pub recording: String,
    /// Its length, s.
    pub duration_s: f64,
    /// Whether it taught itself what is normal: it is then compared with itself.
    pub is_reference: bool,
    /// The answer.
    #[serde(flatten)]
    pub checked: Checked,
}

/// Share of the work that learning takes, where there is something to learn from.
const LEARNING: f64 = 0.8;

impl Checkup {
    /// Learns from healthy recordings what they teach, then judges the others; the motor as it is known in the end comes
    /// with it. `motor_file` is the caller's to fill in.
    ///
    /// # Errors
    /// A motor file or a recording that the core cannot take, in words.
    pub fn new(
        known: &Known,
        healthy: &[&Recording],
        recordings: &[(String, &Recording)],
        progress: &mut Progress<'_>,
    ) -> Result<(Checkup, MotorFile), String> {
        let names: Vec<String> = recordings.iter().map(|(name, _)| name.clone()).collect();
        let mut read = |k: usize, take: &mut Taken<'_>| match recordings.get(k) {
            Some((_, recording)) => take(recording),
            None => Ok(()),
        };
        let healthy: Vec<&dyn Reference> = healthy.iter().map(|one| *one as _).collect();
        Checkup::of_pieces(known, &healthy, &names, progress, &mut read)
    }

    /// The same of recordings of any length: `read` gives the pieces of a recording by its number, one after the other.
    ///
    /// # Errors
    /// As [`Checkup::new`], and what `read` returns.
    pub fn of_pieces<E>(
        known: &Known,
        healthy: &[&dyn Reference],
        names: &[String],
        progress: &mut Progress<'_>,
        read: &mut dyn FnMut(usize, &mut Taken<'_>) -> Result<(), E>,
    ) -> Result<(Checkup, MotorFile), E> {
        let begin = if healthy.is_empty() { 0.0 } else { LEARNING };
        let learnt = learn(&known.motor, healthy, &mut |what, share| {
            progress(what, begin * share);
        });
        let share = (1.0 - begin) / names.len().max(1) as f64;
        let mut checked = Vec::new();
        for (k, name) in names.iter().enumerate() {
            let at = begin + share * k as f64;
            let mut tell = |part: f64| progress("checking", at + share * part);
            let mut one = Pieces::new(&learnt.motor, healthy);
            read(k, &mut |piece| one.take(piece, &mut tell))?;
            checked.push(one.finish(name));
        }
        let checkup = Checkup {
            motor: learnt.motor.name.clone(),
            knowledge: learnt.knowledge,
            calibrated: learnt.motor.healthy.is_some(),
            known_by: known_by(known, learnt.knowledge),
            notes: learnt.notes,
            contradictions: known.contradictions.clone(),
            plate: known.plate.clone(),
            parameters: parameters(&learnt.motor, learnt.identified.as_ref()),
            identified: learnt.identified,
            recordings: checked,
            motor_file: None,
        };
        Ok((checkup, learnt.motor))
    }

    /// The state of all recordings together: a fault outweighs what was not judged.
    pub fn state(&self) -> VerdictState {
        let mut states = self.recordings.iter().map(|one| one.checked.state);
        let worst = |a, b| match (a, b) {
            (VerdictState::Fault, _) | (_, VerdictState::Fault) => VerdictState::Fault,
            (VerdictState::Healthy, VerdictState::Healthy) => VerdictState::Healthy,
            _ => VerdictState::NotJudged,
        };
        let first = states.next().unwrap_or(VerdictState::NotJudged);
        states.fold(first, worst)
    }
}

/// Takes a piece of a recording.
pub type Taken<'t> = dyn FnMut(&Recording) -> Result<(), String> + 't;

/// The pieces of one recording.
struct Pieces<'l> {
    checking: Checking<'l>,
    healthy: &'l [&'l dyn Reference],
    /// Begin and end so far, s.
    span: Option<[f64; 2]>,
    samples: usize,
    /// Lengths of the references that begin as it does.
    alike: Vec<usize>,
}

impl<'l> Pieces<'l> {
    fn new(motor: &'l MotorFile, healthy: &'l [&'l dyn Reference]) -> Pieces<'l> {
        Pieces {
            checking: Checking::new(motor),
            healthy,
            span: None,
            samples: 0,
            alike: Vec::new(),
        }
    }

    fn take(&mut self, piece: &Recording, progress: &mut dyn FnMut(f64)) -> Result<(), String> {
        if self.samples == 0 {
            let alike = self.healthy.iter().filter(|one| begins_like(**one, piece));
            self.alike = alike.map(|one| one.samples()).collect();
        }
        self.samples += piece.len();
        let [begin, end] = [piece.t()[0], piece.t()[piece.len() - 1]];
        self.span = Some([self.span.map_or(begin, |[begin, _]| begin), end]);
        let all = piece.len().max(1) as f64;
        let mut tell = |sample: usize| progress(sample as f64 / all);
        self.checking.take(piece, &mut tell)
    }

    fn finish(self, name: &str) -> CheckedRecording {
        CheckedRecording {
            recording: name.to_owned(),
            duration_s: self.span.map_or(0.0, |[begin, end]| end - begin),
            is_reference: self.alike.contains(&self.samples),
            checked: self.checking.finish(),
        }
    }
}

fn known_by(known: &Known, knowledge: Knowledge) -> &'static str {
    match knowledge {
        Knowledge::AsGiven if known.motor.healthy.is_some() => "known by its calibrated motor file",
        Knowledge::AsGiven if known.plate.is_empty() => "known by its motor file alone",
        Knowledge::AsGiven => "known by its plate alone",
        Knowledge::Identified => "parameters learnt from healthy recordings",
        Knowledge::Calibrated => "calibrated on healthy recordings",
    }
}
