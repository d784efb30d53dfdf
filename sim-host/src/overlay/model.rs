//! The models that are laid over a recording.

use discovery::{ExplainReport, FitReport, StepReport};
use motor::MotorFile;
use motor::effects::{Plant, from_motor_file, rated};
use motor::motor_file::{EffectEntry, EffectParameter, EffectValue};

/// A motor with its effects, and what people call it.
#[derive(Clone, Debug)]
pub struct Model {
    /// Name in figures.
    pub label: String,
    /// The motor.
    pub plant: Plant,
}

impl Model {
    /// The motor of a motor file under a name; effects that are not in the library are left out.
    pub fn new(label: String, motor: &MotorFile) -> Self {
        Model {
            label,
            plant: Plant {
                motor: motor.parameters,
                mechanics: motor.mechanics,
                rated: rated(motor),
                effects: from_motor_file(motor, &motor.name).unwrap_or_default(),
            },
        }
    }

    /// The motor as its file says.
    pub fn believed(motor: &MotorFile) -> Self {
        Model::new("as the motor file says".to_owned(), motor)
    }

    /// As the motor file says, with refitted parameters, and with everything that was found.
    pub fn of_explanation(motor: &MotorFile, report: &ExplainReport) -> Vec<Self> {
        let mut models = vec![Model::believed(motor)];
        if let Some(baseline) = &report.baseline {
            let refitted = with_parameters(motor, baseline);
            models.push(Model::new("parameters refitted".to_owned(), &refitted));
        }
        if let (Some(last), false) = (&report.final_, report.steps.is_empty()) {
            let mut complete = with_parameters(motor, last);
            for name in report.steps.iter().flat_map(|step| &step.tied_with) {
                // Either the effect or the parameter: with the effect, the parameter stays as believed.
                let believed = last.parameters.iter().find(|p| p.name == *name);
                believed
                    .into_iter()
                    .for_each(|p| set(&mut complete, name, p.believed));
            }
            complete.effects.extend(report.steps.iter().map(entry));
            let names: Vec<&str> = report
                .steps
                .iter()
                .map(|step| step.effect.as_str())
                .collect();
            models.push(Model::new(
                format!("with {}", names.join(" and ")),
                &complete,
            ));
        }
        models
    }
}

fn with_parameters(motor: &MotorFile, fit: &FitReport) -> MotorFile {
    let mut motor = motor.clone();
    for parameter in &fit.parameters {
        set(&mut motor, &parameter.name, parameter.value);
    }
    motor
}

/// Sets a parameter by its key in the motor file; other names mean effects and change nothing.
fn set(motor: &mut MotorFile, name: &str, x: f64) {
    match name {
        "stator_resistance_ohm" => motor.parameters.r_s = x,
        "rotor_resistance_ohm" => motor.parameters.r_r = x,
        // Fitted as one: terminals cannot tell the two apart.
        "stator_leakage_henry" => (motor.parameters.l_ls, motor.parameters.l_lr) = (x, x),
        "magnetizing_inductance_henry" => motor.parameters.l_m = x,
        "inertia_kg_m2" => motor.mechanics.inertia = x,
        "friction_nm_s" => motor.mechanics.friction = x,
        _ => {}
    }
}

fn entry(step: &StepReport) -> EffectEntry {
    let numbers = step.parameters.iter().map(|p| (p.name.as_str(), p.value));
    let mut entry = EffectEntry::with_numbers(&step.effect, numbers);
    if !step.form.is_empty() {
        entry.parameters.insert(
            0,
            EffectParameter {
                key: "form".to_owned(),
                line: 0,
                value: EffectValue::Text(step.form.clone()),
            },
        );
    }
    entry
}
