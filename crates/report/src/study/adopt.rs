//! An effect added to a motor file.

use discovery::{AdoptReport, Error, Progress};
use motor::MotorFile;
use schemars::JsonSchema;
use serde::Serialize;

use super::{Inputs, shown};
use crate::overlay::{Model, Overlay, TableOverlay};

/// Everything that an adoption says.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Adopted {
    /// The recordings, the fitted one first.
    pub recordings: Vec<String>,
    /// The motor's name.
    pub motor: String,
    /// What to type next.
    pub next_command: String,
    /// The adoption itself.
    #[serde(flatten)]
    pub report: AdoptReport,
    /// Measured and modelled signals of the last recording, before and after.
    pub overlay: Option<Overlay>,
    /// The same for a load table.
    pub table_overlay: Option<TableOverlay>,
}

impl Adopted {
    /// Adds an effect and refits everything; the new motor comes with it. Names of files are the caller's to fill in.
    ///
    /// # Errors
    /// As [`discovery::adopt`].
    pub fn new(
        effect: &str,
        inputs: Inputs<'_>,
        progress: &mut Progress<'_>,
    ) -> Result<(Self, MotorFile), Error> {
        let Inputs {
            sources,
            motor,
            laws,
            ..
        } = inputs;
        let (report, adopted) = discovery::adopt_with(effect, sources, motor, laws, progress)?;
        let (names, sources) = inputs.as_answered(report.fitted);
        let models = [
            Model::believed(motor),
            Model::new(format!("with {effect}"), &adopted),
        ];
        let scale = report.speed_scale.as_ref();
        let last = sources.last().copied();
        let last = last.and_then(|source| shown(source, scale, 0.0));
        let last = last.as_deref();
        let result = Adopted {
            motor: motor.name.clone(),
            next_command: String::new(),
            overlay: last
                .and_then(|source| Overlay::new(source, &models))
                .map(|overlay| overlay.named(names.last())),
            table_overlay: last
                .and_then(|source| TableOverlay::new(source, motor, &models))
                .map(|overlay| overlay.named(names.last())),
            recordings: names,
            report,
        };
        Ok((result, adopted))
    }
}
