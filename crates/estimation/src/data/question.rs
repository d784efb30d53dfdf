//! From files to a study: audit, preparation, errors.

use crate::data::case::{Case, Waveform};
use crate::data::given::{Fitted, One, Sources};
use crate::data::joined::{first_alone, shared};
use crate::data::stretches::{Excerpt, Role, StretchReport, cut, stretches, told};
use crate::data::study::Study;
use crate::data::unsupported::Unsupported;
use crate::model::free_scale::FreeScale;
use crate::model::prior::Prior;
use crate::model::speed_gain::{is_scale, name};
use audit::{Audit, Expectation, audit, with_sound_probes};
use motor::MotorFile;
use motor::effect::{Rated, from_motor_file};
use recording::{LoadTable, LoadTorque, Recording, Source};
use std::fmt;

/// Why nothing can be answered.
#[derive(Clone, Debug)]
pub enum Error {
    /// The effects of the motor file are wrong.
    MotorFile(document::FileError),
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
pub struct Question {
    /// Audit of the fitted recording.
    pub audit: Audit,
    /// Stretches of long recordings that are used, where only those were given.
    pub stretches: Vec<StretchReport>,
    /// The study.
    pub study: Study,
}

/// One of the sources, with its sound probes.
enum Ready<'a> {
    Recording(Box<Recording>),
    LoadTable(&'a LoadTable),
    Excerpt(&'a Excerpt),
}

impl Question {
    /// Audits and prepares; `progress` hears what is being done.
    ///
    /// # Errors
    /// Wrong effects in the motor file, no source, or sources that cannot be judged.
    pub fn new<'a>(
        sources: impl Into<Sources<'a>>,
        motor: &MotorFile,
        progress: &mut dyn FnMut(&str, f64),
    ) -> Result<Self, Error> {
        Self::with(sources.into(), motor, Fitted::AsGiven, progress)
    }

    /// As [`Question::new`], with other recordings fitted; all together are fitted by [`Question::together`].
    ///
    /// # Errors
    /// As [`Question::new`].
    pub fn with(
        sources: Sources<'_>,
        motor: &MotorFile,
        fitted: Fitted,
        progress: &mut dyn FnMut(&str, f64),
    ) -> Result<Self, Error> {
        match fitted {
            Fitted::AsGiven | Fitted::All => Self::about(sources, motor, shared, progress),
            Fitted::First => Self::about(sources, motor, first_alone, progress),
            Fitted::Second => {
                let turned: Vec<One<'_>> = sources.iter().rev().collect();
                Self::about(Sources::Listed(&turned), motor, shared, progress)
            }
        }
    }

    fn about(
        sources: Sources<'_>,
        motor: &MotorFile,
        shared: impl Fn(Vec<Case>) -> Option<(Case, Vec<Case>)>,
        progress: &mut dyn FnMut(&str, f64),
    ) -> Result<Self, Error> {
        let Some(first) = sources.iter().next() else {
            return Err(Error::Recordings("give at least one recording".to_owned()));
        };
        let effects = from_motor_file(motor, &motor.name).map_err(Error::MotorFile)?;
        progress("auditing the recordings", 0.0);
        let mut audited = audit_of(first, motor);
        if let One::Source(Source::Recording(recording)) = first {
            audited.assumptions.extend(told(recording));
        }
        let mut prior = Prior::new(motor, effects);
        if sources.iter().any(measures_torque) {
            // A measured brake torque holds the friction of the load.
            prior.plant.mechanics.load_friction = 0.0;
        }
        let refuse = |why| Error::Unsupported(Box::new(audited.clone()), why);
        let mut ready = Vec::new();
        for source in sources.iter() {
            let audit = audit_of(source, motor);
            if let Some(reason) = refusal(&audit) {
                return Err(Error::Unsupported(Box::new(audit), reason));
            }
            ready.push(Ready::of(source, &audit));
        }
        let scale = speed_scale_of(&ready, &prior)?.map(|start| start.map_err(refuse));
        let scale = scale.transpose()?;
        let rated = &prior.plant.rated;
        let prepared = |scale: Option<FreeScale>| {
            let case = |source: &Ready<'_>| source.case(scale, rated).map_err(refuse);
            let all: Result<(Vec<Case>, Vec<_>), Error> = ready.iter().map(case).collect();
            all.map(|(cases, used)| (cases, used.concat()))
        };
        let (mut cases, mut used) = prepared(scale)?;
        let scale = scale.map(|start| start.fitted(&cases[0], &prior));
        if scale.is_some() {
            cases = prepared(scale)?.0;
        }
        if cases.iter().any(|c| c.is_table() != cases[0].is_table()) {
            let message = "recordings and load tables cannot prove each other; give one kind";
            return Err(Error::Recordings(message.to_owned()));
        }
        progress("propagating the noise", 0.05);
        let none = || Error::Recordings("give at least one recording".to_owned());
        let (fitted, mut proofs) = shared(cases).ok_or_else(none)?;
        if let [Ready::Excerpt(excerpt)] = ready[..]
            && excerpt.proves()
        {
            let (proof, proves) = excerpt.case(Role::Proves, rated).map_err(refuse)?;
            proofs.push(proof.into());
            used.extend(proves);
            used.sort_by(|a, b| a.from_s.total_cmp(&b.from_s));
        }
        Ok(Self {
            audit: audited,
            stretches: used,
            study: Study::new(prior, fitted, proofs, scale),
        })
    }
}

impl Question {
    /// Whether it is about recordings over time of which some prove, none too long to be taken whole.
    pub fn is_of_wholes(&self) -> bool {
        let fitted = self.study.fitted.case.waveform();
        let is_whole = |waveform: &Waveform| waveform.timeline.cuts.iter().all(|cut| cut.is_new);
        fitted.is_some_and(is_whole) && !self.study.proofs.is_empty() && self.stretches.is_empty()
    }

    /// The same recordings, all fitted together; `None` where they do not suit.
    pub fn together(&self) -> Option<Self> {
        Some(self.about_study(self.study.together()?))
    }

    /// The same question about another study of the same recordings.
    pub fn about_study(&self, study: Study) -> Self {
        Self {
            audit: self.audit.clone(),
            stretches: self.stretches.clone(),
            study,
        }
    }
}

/// Whether a recording holds the torque at the shaft.
fn measures_torque(source: One<'_>) -> bool {
    match source {
        One::Source(Source::Recording(rec)) => {
            rec.torque().is_some() && rec.metadata.load_torque != LoadTorque::Friction
        }
        One::Source(Source::LoadTable(_)) => false,
        One::Excerpt(excerpt) => excerpt.measures_torque(),
    }
}

impl<'a> Ready<'a> {
    /// A source with its sound probes.
    fn of(source: One<'a>, audit: &Audit) -> Self {
        match source {
            One::Source(Source::Recording(recording)) => {
                Ready::Recording(Box::new(with_sound_probes(recording, audit)))
            }
            One::Source(Source::LoadTable(table)) => Ready::LoadTable(table),
            One::Excerpt(excerpt) => Ready::Excerpt(excerpt),
        }
    }

    /// What of it is fitted, or proves as a whole, and the stretches that it is made of where it was given in stretches.
    fn case(
        &self,
        scale: Option<FreeScale>,
        rated: &Rated<f64>,
    ) -> Result<(Case, Vec<StretchReport>), Unsupported> {
        let case = match (self, scale) {
            (Ready::Excerpt(excerpt), _) => {
                let (waveform, used) = excerpt.case(Role::Fitted, rated)?;
                return Ok((waveform.into(), used));
            }
            (Ready::LoadTable(table), _) => Case::of_table(table, rated)?,
            (Ready::Recording(recording), None) => waveform_of(recording, rated)?.into(),
            (Ready::Recording(recording), Some(scale)) => Case::from(Waveform {
                speed_scale_is_free: true,
                ..waveform_of(&scale.applied(recording), rated)?
            }),
        };
        Ok((case, Vec::new()))
    }
}

/// A recording whole, or stretches of a long one.
fn waveform_of(recording: &Recording, rated: &Rated<f64>) -> Result<Waveform, Unsupported> {
    let whole = Waveform::new(recording, rated)?;
    Ok(match stretches(recording) {
        None => whole,
        Some(stretches) => cut(&whole, rated, &stretches),
    })
}

/// Where the fit of an unknown scale of the speed starts; `None` when every scale is known.
///
/// # Errors
/// Recordings with known and unknown scales, or a motor file that holds the effect which is to be fitted.
fn speed_scale_of(
    sources: &[Ready<'_>],
    prior: &Prior,
) -> Result<Option<Result<FreeScale, Unsupported>>, Error> {
    let recordings: Vec<&Recording> = sources
        .iter()
        .filter_map(|source| match source {
            Ready::Recording(recording) => Some(&**recording),
            // Its scale is known: a recording whose scale is not is never given in stretches.
            Ready::Excerpt(_) | Ready::LoadTable(_) => None,
        })
        .collect();
    let known_or_not = sources
        .iter()
        .filter(|one| !matches!(one, Ready::LoadTable(_)));
    let known_or_not = known_or_not.count();
    let unknown = |rec: &&&Recording| rec.unknown_speed_scale.is_some() && rec.speed().is_some();
    match recordings.iter().filter(unknown).count() {
        0 => return Ok(None),
        count if count < known_or_not => {
            let message = "the scale of the speed is unknown in some recordings and known in others; declare one of both for all";
            return Err(Error::Recordings(message.to_owned()));
        }
        _ => {}
    }
    let held = &prior.plant.effects;
    if held.iter().any(|e| is_scale(e.effect)) {
        let message = format!(
            "the motor file holds `{}`, and the scale of the speed is declared unknown; remove one of both",
            name()
        );
        return Err(Error::Recordings(message));
    }
    Ok(Some(FreeScale::start(&recordings, &prior.plant.rated)))
}

/// Audit of a source; a load table has nothing to audit beyond its reading.
pub fn audit_of<'a>(source: impl Into<One<'a>>, motor: &MotorFile) -> Audit {
    match source.into() {
        One::Source(Source::Recording(recording)) => audit(recording, &Expectation::from(motor)),
        One::Excerpt(excerpt) => excerpt.audit.clone(),
        One::Source(Source::LoadTable(table)) => Audit {
            supported: true,
            findings: Vec::new(),
            assumptions: table.assumptions.clone(),
            unusable: Vec::new(),
        },
    }
}

fn refusal(audit: &Audit) -> Option<Unsupported> {
    let finding = audit.findings.iter().find(|f| f.refuses)?;
    Some(Unsupported::new(finding.detail.clone(), "see the audit"))
}

#[cfg(test)]
mod tests;
