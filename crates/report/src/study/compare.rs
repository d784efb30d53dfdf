//! Where a model fails.

use discovery::{CompareReport, Error, Progress};
use schemars::JsonSchema;
use serde::Serialize;

use super::places::{furthest_off, worst};
use super::{Inputs, shown};
use crate::overlay::{Model, Overlay, TableOverlay};

/// Everything that a comparison says.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Compared {
    /// The recording.
    pub recording: String,
    /// The motor's name.
    pub motor: String,
    /// What to type next.
    pub next_command: String,
    /// The comparison itself.
    #[serde(flatten)]
    pub report: CompareReport,
    /// Measured and modelled signals.
    pub overlay: Option<Overlay>,
    /// The same for a load table.
    pub table_overlay: Option<TableOverlay>,
}

impl Compared {
    /// Compares the first source with the model of the motor file, nothing refitted.
    ///
    /// # Errors
    /// As [`discovery::compare`].
    pub fn new(
        inputs: Inputs<'_>,
        next_command: String,
        progress: &mut Progress<'_>,
    ) -> Result<Self, Error> {
        let Inputs {
            names,
            sources,
            motor,
            ..
        } = inputs;
        let report = discovery::compare(sources, motor, progress)?;
        let models = [Model::believed(motor)];
        let scale = report.speed_scale.as_ref();
        let at_s = furthest_off(&worst(&report));
        let first = sources.iter().next();
        let first = first.and_then(|source| shown(source, scale, at_s));
        let first = first.as_deref();
        Ok(Compared {
            recording: names.first().cloned().unwrap_or_default(),
            motor: motor.name.clone(),
            next_command,
            overlay: first
                .filter(|_| report.overall.is_some())
                .and_then(|source| Overlay::new(source, &models))
                .map(|overlay| overlay.named(names.first())),
            table_overlay: first
                .and_then(|source| TableOverlay::new(source, motor, &models))
                .map(|overlay| overlay.named(names.first())),
            report,
        })
    }
}
