//! The models that are laid over a recording.

use discovery::{ExplainReport, FitReport, LawReport, WindingsReport};
use motor::MotorFile;
use motor::effect::{Plant, from_motor_file, rated};
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

    /// As the motor file says, with refitted parameters, and with everything that was found; the last two as warm as the motor was in the
    /// recording that proves of this number (from 1), if it is shown on one.
    pub fn of_explanation(
        motor: &MotorFile,
        report: &ExplainReport,
        proof: Option<usize>,
    ) -> Vec<Self> {
        let mut models = Model::of_answer(motor, report);
        let mut windings = report.final_.iter().flat_map(|fit| &fit.windings);
        if let Some(windings) = windings.find(|windings| Some(windings.proof) == proof) {
            let fitted = models.iter_mut().skip(1);
            fitted.for_each(|model| model.warm(windings));
        }
        models
    }

    fn warm(&mut self, windings: &WindingsReport) {
        let factor = |percent: f64| 1.0 + percent / 100.0;
        self.plant.motor.r_s *= factor(windings.stator_resistance_change_percent);
        self.plant.motor.r_r *= factor(windings.rotor_resistance_change_percent);
        self.label.push_str(", as warm as there");
    }

    fn of_answer(motor: &MotorFile, report: &ExplainReport) -> Vec<Self> {
        let mut models = vec![Model::believed(motor)];
        if let Some(baseline) = &report.baseline {
            let refitted = with_parameters(motor, values(baseline));
            models.push(Model::new("parameters refitted".to_owned(), &refitted));
        }
        if let Some(complete) = complete(motor, report) {
            let effects = report.steps.iter().map(|s| s.effect.clone());
            let laws = proven(report).map(LawReport::name);
            let names: Vec<String> = effects.chain(laws).collect();
            models.push(Model::new(
                format!("with {}", names.join(" and ")),
                &complete,
            ));
        }
        models
    }
}

/// The motor with everything that was found; `None` when nothing was, when a part of it comes and goes, which no motor file
/// holds, or when an effect ties with a parameter: the final parameters then belong to the model without the effect.
fn complete(motor: &MotorFile, report: &ExplainReport) -> Option<MotorFile> {
    let last = report
        .final_
        .as_ref()
        .filter(|_| !report.steps.is_empty() || proven(report).next().is_some())?;
    if proven(report).any(|law| law.entry.is_none()) {
        return None;
    }
    let mut ties = report.steps.iter().flat_map(|step| &step.tied_with);
    if ties.any(|tie| last.parameters.iter().any(|p| p.name == *tie)) {
        return None;
    }
    let mut complete = with_parameters(motor, values(last));
    for step in &report.steps {
        let numbers = step.parameters.iter().map(|p| (p.name.as_str(), p.value));
        add(&mut complete, &step.effect, &step.form, numbers);
    }
    complete
        .effects
        .extend(proven(report).filter_map(|law| law.entry.clone()));
    Some(complete)
}

/// Laws that are proven.
fn proven(report: &ExplainReport) -> impl Iterator<Item = &LawReport> {
    report.laws.iter().filter(|law| law.proven)
}

fn values(fit: &FitReport) -> impl Iterator<Item = (&str, f64)> {
    fit.parameters.iter().map(|p| (p.name.as_str(), p.value))
}

fn with_parameters<'p>(
    motor: &MotorFile,
    values: impl Iterator<Item = (&'p str, f64)>,
) -> MotorFile {
    let mut motor = motor.clone();
    values.for_each(|(name, x)| set(&mut motor, name, x));
    motor
}

/// Sets a parameter by its key in the motor file; other names mean effects and change nothing.
fn set(motor: &mut MotorFile, name: &str, x: f64) {
    match name {
        "stator_resistance_ohm" => motor.parameters.r_s = x,
        "rotor_resistance_ohm" => motor.parameters.r_r = x,
        "stator_leakage_henry" => {
            // Fitted as one, at the believed ratio: terminals cannot tell the two apart.
            motor.parameters.l_lr *= x / motor.parameters.l_ls;
            motor.parameters.l_ls = x;
        }
        "magnetizing_inductance_henry" => motor.parameters.l_m = x,
        "inertia_kg_m2" => motor.mechanics.inertia = x,
        "friction_nm_s" => motor.mechanics.friction = x,
        _ => {}
    }
}

/// Adds an effect, or gives new numbers to the entry that holds it already (a formula).
fn add<'p>(
    motor: &mut MotorFile,
    effect: &str,
    form: &str,
    numbers: impl Iterator<Item = (&'p str, f64)>,
) {
    let mut entry = EffectEntry::with_numbers(effect, numbers);
    let is_it =
        |e: &EffectEntry| e.name == effect && e.text("formula").is_none_or(|text| text == form);
    let known = motor.effects.iter().position(is_it);
    let texts = match known {
        Some(k) => motor.effects.remove(k).parameters,
        None if form.is_empty() => Vec::new(),
        None => vec![EffectParameter {
            key: "form".to_owned(),
            line: 0,
            value: EffectValue::Text(form.to_owned()),
        }],
    };
    let is_text = |p: &EffectParameter| matches!(p.value, EffectValue::Text(_));
    let texts = texts.into_iter().filter(is_text);
    entry.parameters.splice(0..0, texts);
    motor.effects.push(entry);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motor() -> MotorFile {
        let text = include_str!("../../../../motors/peer-2k2.toml");
        MotorFile::parse(text, "motor").unwrap()
    }

    #[test]
    fn the_two_leakages_keep_their_ratio() {
        let mut motor = motor();
        motor.parameters.l_lr = 1.5 * motor.parameters.l_ls;
        let found = [("stator_leakage_henry", 0.02), ("friction_nm_s", 0.01)];
        let moved = with_parameters(&motor, found.into_iter());
        assert_eq!(moved.parameters.l_ls, 0.02);
        assert_eq!(moved.mechanics.friction, 0.01);
        // Two roundings.
        assert!((moved.parameters.l_lr - 0.03).abs() < 1e-15);
    }

    #[test]
    fn an_effect_is_added_once_and_then_only_changed() {
        let mut motor = motor();
        for size in [5e-5, 7.5e-5] {
            add(
                &mut motor,
                "windage",
                "",
                [("windage_nm_s2", size)].into_iter(),
            );
        }
        assert_eq!(motor.effects.len(), 1);
        assert_eq!(motor.effects[0].number("windage_nm_s2"), Some(7.5e-5));
        let model = Model::new("with windage".to_owned(), &motor);
        assert_eq!(model.plant.effects.len(), 1);
    }
}
