//! From files to a study: audit, preparation, errors.

use crate::belief::Belief;
use crate::case::{Case, Unsupported};
use crate::study::Study;
use motor::MotorFile;
use motor::effects::{Rated, from_motor_file};
use recording::{Audit, Expectation, LoadTorque, Source, audit, with_sound_probes};
use std::fmt;

/// Why nothing can be answered.
#[derive(Clone, Debug)]
pub enum Error {
    /// The effects of the motor file are wrong.
    MotorFile(motor::document::FileError),
    /// No recording was given, or a mixture of recordings and load tables.
    Recordings(String),
    /// The recording cannot be judged: its audit, and the reason.
    Unsupported(Box<Audit>, Unsupported),
    /// There is no such effect.
    UnknownEffect(String),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::MotorFile(error) => error.fmt(f),
            Self::Recordings(message) | Self::UnknownEffect(message) => f.write_str(message),
            Self::Unsupported(_, why) => write!(f, "{}; {}", why.reason, why.remedy),
        }
    }
}

impl std::error::Error for Error {}

/// A prepared question: the audit of the first source, and the study.
pub(crate) struct Question {
    /// Audit of the fitted recording.
    pub audit: Audit,
    /// The study.
    pub study: Study,
}

impl Question {
    /// Audits and prepares; `progress` hears what is being done.
    ///
    /// # Errors
    /// Wrong effects in the motor file, no source, or sources that cannot be judged.
    pub fn new(
        sources: &[Source],
        motor: &MotorFile,
        progress: &mut dyn FnMut(&str, f64),
    ) -> Result<Self, Error> {
        let Some(first) = sources.first() else {
            return Err(Error::Recordings("give at least one recording".to_owned()));
        };
        let effects = from_motor_file(motor, &motor.name).map_err(Error::MotorFile)?;
        progress("auditing the recordings", 0.0);
        let audited = audit_of(first, motor);
        let mut belief = Belief::new(motor, effects);
        if sources.iter().any(measures_torque) {
            // A measured brake torque holds the friction of the load.
            belief.plant.mechanics.load_friction = 0.0;
        }
        let refuse = |why| Error::Unsupported(Box::new(audited.clone()), why);
        let mut cases = Vec::new();
        for source in sources {
            let audit = audit_of(source, motor);
            if let Some(reason) = refusal(&audit) {
                return Err(Error::Unsupported(Box::new(audit), reason));
            }
            cases.push(case_of(source, &audit, &belief.plant.rated).map_err(refuse)?);
        }
        if cases
            .iter()
            .any(|c| c.table.is_some() != cases[0].table.is_some())
        {
            let message = "recordings and load tables cannot prove each other; give one kind";
            return Err(Error::Recordings(message.to_owned()));
        }
        progress("propagating the noise", 0.05);
        let fitted = cases.remove(0);
        Ok(Self {
            audit: audited,
            study: Study::new(belief, fitted, cases),
        })
    }
}

/// Whether a recording holds the torque at the shaft.
fn measures_torque(source: &Source) -> bool {
    let Source::Recording(rec) = source else {
        return false;
    };
    rec.torque().is_some() && rec.metadata.load_torque != LoadTorque::Friction
}

fn case_of(source: &Source, audit: &Audit, rated: &Rated<f64>) -> Result<Case, Unsupported> {
    match source {
        Source::Recording(recording) => Case::new(&with_sound_probes(recording, audit), rated),
        Source::LoadTable(table) => Case::of_table(table, rated),
    }
}

/// Audit of a source; a load table has nothing to audit beyond its reading.
pub(crate) fn audit_of(source: &Source, motor: &MotorFile) -> Audit {
    match source {
        Source::Recording(recording) => audit(recording, &Expectation::from(&motor.nameplate)),
        Source::LoadTable(_) => Audit {
            supported: true,
            findings: Vec::new(),
            unusable: Vec::new(),
        },
    }
}

fn refusal(audit: &Audit) -> Option<Unsupported> {
    let finding = audit.findings.iter().find(|f| f.refuses)?;
    Some(Unsupported::new(finding.detail.clone(), "see the audit"))
}
