//! The motor file: one TOML file per machine, the only configuration there is.
//!
//! Everything is validated once, here, the effects by their library; what a [`MotorFile`] holds is physically possible.

mod effects;
mod healthy;
mod monitor;
mod nameplate;
mod parameters;
mod sensors;
mod uncertainty;
mod write;

#[cfg(test)]
mod malformed;
#[cfg(test)]
mod malformed_cases;
#[cfg(test)]
mod tests;

pub use effects::{EffectEntry, EffectParameter, EffectValue};
pub use healthy::{CalibratedRange, EVIDENCE_ROWS, HealthyRotor, HealthySettings};
pub use monitor::{FieldCurrent, Frame, LoadKind, MonitorSettings};
pub use nameplate::{Connection, Nameplate};
pub use sensors::Sensors;
pub use uncertainty::{Correlation, ParameterInterval, Uncertainty};

use crate::{Mechanics, TParams};
use document::{Document, FileError, Section, read_text};
use std::path::Path;

/// Everything that is known about one motor and the instrument at its terminals.
#[derive(Clone, Debug, PartialEq)]
pub struct MotorFile {
    /// What people call the machine.
    pub name: String,
    /// The plate on its housing.
    pub nameplate: Nameplate,
    /// T model per equivalent star phase, rotor referred to the stator.
    pub parameters: TParams<f64>,
    /// Temperature at which `parameters` hold, degC, when it is known.
    pub parameter_temperature_degc: Option<f64>,
    /// Inertia, friction and pole pairs.
    pub mechanics: Mechanics<f64>,
    /// What is known about the load torque.
    pub load: LoadKind,
    /// Ranges, resolution and corrections of the sensors.
    pub sensors: Sensors,
    /// How the residuals are formed and judged.
    pub monitor: MonitorSettings,
    /// Statistics of the healthy motor, once it was calibrated.
    pub healthy: Option<HealthySettings>,
    /// Physical effects beyond the T model, in the order of the file.
    pub effects: Vec<EffectEntry>,
    /// Intervals of parameters that were not measured on this motor.
    pub uncertainty: Option<Uncertainty>,
}

impl MotorFile {
    /// Reads and validates a motor file.
    ///
    /// # Errors
    /// An unreadable file, or all problems of its content with line, key, range and remedy.
    pub fn read(path: impl AsRef<Path>) -> Result<MotorFile, FileError> {
        let path = path.as_ref();
        let text = read_text(path)?;
        MotorFile::parse(&text, &path.display().to_string())
    }

    /// Validates the text of a motor file; `file_label` is the name that errors print.
    ///
    /// # Errors
    /// All problems of the content with line, key, range and remedy.
    pub fn parse(text: &str, file_label: &str) -> Result<MotorFile, FileError> {
        let document = Document::parse(text, file_label)?;
        if is_plate(&document.root()) {
            const ADVICE: &str = "this is a plate and no motor file: give it with --plate, or make a motor file of it with `drivemon motor new`";
            document.report(1, "", ADVICE);
            return document.finish(None);
        }
        let motor = read_document(&document);
        document.finish(motor)
    }

    /// The constant field current `i_f`, A: as written, or the magnetizing current of the unloaded motor at
    /// rated voltage.
    pub fn nominal_field_current(&self) -> f64 {
        let plate = &self.nameplate;
        let no_load = || {
            let reactance = plate.omega_sync() * self.parameters.l_s();
            plate.phase_voltage_amplitude() / self.parameters.r_s.hypot(reactance)
        };
        self.monitor
            .nominal_field_current_amp
            .unwrap_or_else(no_load)
    }

    /// The file as TOML text; [`MotorFile::parse`] reads the same motor back.
    pub fn to_toml(&self) -> String {
        write::to_toml(self)
    }
}

/// A plate has its values at the top of the file, a motor file in sections.
fn is_plate(root: &Section<'_>) -> bool {
    let has_power = root.has("power_kw") || root.has("power_hp");
    has_power && !root.has("nameplate") && !root.has("parameters")
}

/// Reads `[[effects]]` of a file's top level: motor files and scenario files share the form.
///
/// `None` after a problem, which has then been reported.
pub fn read_effects(root: &Section<'_>) -> Option<Vec<EffectEntry>> {
    effects::read(root)
}

fn read_document(document: &Document) -> Option<MotorFile> {
    let root = document.root();
    let name = root.text("name", "what people call this machine");
    let nameplate = nameplate::read(&root);
    let electrical = parameters::read(&root, nameplate.as_ref());
    let load = monitor::read_load(&root);
    let sensors = sensors::read(&root, nameplate.as_ref());
    let monitor = monitor::read(&root);
    let healthy = healthy::read(&root);
    let effects = read_effects(&root);
    if let (Some(plate), Some(effects)) = (&nameplate, &effects) {
        crate::effect::check(document, plate, effects);
    }
    let uncertainty = uncertainty::read(&root, effects.as_deref().unwrap_or_default());
    root.finish();
    let electrical = electrical?;
    Some(MotorFile {
        name: name?,
        nameplate: nameplate?,
        parameters: electrical.t_model,
        parameter_temperature_degc: electrical.temperature_degc,
        mechanics: electrical.mechanics,
        load: load?,
        sensors: sensors?,
        monitor: monitor?,
        healthy: healthy?,
        effects: effects?,
        uncertainty: uncertainty?,
    })
}
