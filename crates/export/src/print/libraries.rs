//! Parameters by the names of other libraries, and what is lost there.

use super::page::{filled, harmless};
use super::{File, Job};
use crate::ExportError;
use crate::circuit_forms::{GammaParams, InvGammaParams};
use crate::model::{check_without, label_of};
use motor::effect::{EffectConfig, from_motor_file, rated};
use motor::{MotorFile, TParams};

/// A library that takes parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Library {
    /// motulator, of Aalto University.
    Motulator,
    /// gym-electric-motor, of Paderborn University.
    GymElectricMotor,
}

impl Library {
    fn template(self) -> &'static str {
        match self {
            Library::Motulator => include_str!("../../templates/motulator.py"),
            Library::GymElectricMotor => include_str!("../../templates/gym_electric_motor.py"),
        }
    }

    /// Whether it has an effect's equation.
    fn holds(self, config: &EffectConfig) -> bool {
        let descriptor = config.effect.descriptor();
        match (descriptor.name, descriptor.form) {
            ("series-inductance", "") | ("windage", _) => true,
            ("coulomb-friction", _) => self == Library::GymElectricMotor,
            _ => false,
        }
    }
}

/// The parameters of a motor for a library, as a Python file.
///
/// # Errors
/// Effects that the motor library refuses, a name in `without` that the file does not have.
pub fn parameters(
    file: &MotorFile,
    library: Library,
    without: &[String],
    job: &Job<'_>,
) -> Result<File, ExportError> {
    let configs = from_motor_file(file, job.source)?;
    check_without(&configs, without)?;
    let is_left_out = |c: &&EffectConfig| without.iter().any(|w| w == c.effect.descriptor().name);
    let (out, rest): (Vec<_>, Vec<_>) = configs.iter().partition(is_left_out);
    let (held, lost): (Vec<_>, Vec<_>) = rest.into_iter().partition(|c| library.holds(c));
    let remarks = [("Held", held.clone()), ("Lost", lost), ("Left out", out)];
    let remarks: Vec<String> = remarks
        .iter()
        .filter(|(_, configs)| !configs.is_empty())
        .map(|(word, configs)| {
            let labels: Vec<_> = configs.iter().map(|c| label_of(c)).collect();
            format!("{word}: {}", labels.join(", "))
        })
        .collect();
    let mut places = values(file, &held);
    let lines: String = remarks
        .iter()
        .map(|r| format!("    {}\n", harmless(r)))
        .collect();
    let nothing = "    it has none\n".to_owned();
    places.extend([
        ("@LOST@", if remarks.is_empty() { nothing } else { lines }),
        ("@NAME@", job.name.clone()),
        ("@VERSION@", job.version.to_owned()),
        ("@SOURCE@", harmless(job.source)),
        ("@TITLE@", harmless(&file.name)),
    ]);
    Ok(File {
        remarks,
        ..File::text(filled(library.template(), &places))
    })
}

/// The size of an effect that is held, 0 without it.
fn size(held: &[&EffectConfig], name: &str) -> f64 {
    let mut found = held.iter().filter(|c| c.effect.descriptor().name == name);
    found
        .next()
        .and_then(|c| c.values.first().copied())
        .unwrap_or(0.0)
}

fn values(file: &MotorFile, held: &[&EffectConfig]) -> Vec<(&'static str, String)> {
    let (plate, rated, mechanics) = (&file.nameplate, rated(file), &file.mechanics);
    let motor = TParams {
        l_ls: file.parameters.l_ls + size(held, "series-inductance"),
        ..file.parameters
    };
    let (gamma, inverse) = (GammaParams::from(&motor), InvGammaParams::from(&motor));
    let omega = rated.speed();
    let text = |x: f64| format!("{x:?}");
    let load_share = 1e-6;
    vec![
        ("@POLE_PAIRS@", plate.pole_pairs.to_string()),
        ("@R_S@", text(motor.r_s)),
        ("@R_R@", text(motor.r_r)),
        ("@L_M@", text(motor.l_m)),
        ("@L_LS@", text(motor.l_ls)),
        ("@L_LR@", text(motor.l_lr)),
        ("@GAMMA_R_R@", text(gamma.r_r)),
        ("@GAMMA_L_ELL@", text(gamma.l_sigma)),
        ("@GAMMA_L_S@", text(gamma.l_m)),
        ("@INV_R_R@", text(inverse.r_r)),
        ("@INV_L_SGM@", text(inverse.l_sigma)),
        ("@INV_L_M@", text(inverse.l_m)),
        ("@INERTIA@", text(mechanics.inertia)),
        ("@J_ROTOR@", text(mechanics.inertia * (1.0 - load_share))),
        ("@J_LOAD@", text(mechanics.inertia * load_share)),
        ("@FRICTION@", text(mechanics.total_friction())),
        ("@WINDAGE@", text(size(held, "windage"))),
        ("@COULOMB@", text(size(held, "coulomb-friction"))),
        ("@NOMINAL_U@", text(nominal_voltage(file))),
        ("@NOMINAL_I@", text(rated.current)),
        ("@LIMIT_I@", text(1.5 * rated.current)),
        ("@NOMINAL_OMEGA@", text(omega)),
        ("@LIMIT_OMEGA@", text(1.5 * omega)),
        ("@NOMINAL_TAU@", text(rated.torque)),
    ]
}

/// Voltage of a DC link whose half is the crest of the rated phase voltage, V.
fn nominal_voltage(file: &MotorFile) -> f64 {
    2.0 * file.nameplate.phase_voltage_amplitude()
}
