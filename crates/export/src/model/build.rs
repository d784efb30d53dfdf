//! From a motor file to a model.

use super::parameters::{Constants, Parameters};
use super::parts::{Part, Parts, Source};
use super::{HELD, MOTOR_STATES, Model, Quantity, Section, assemble};
use crate::ExportError;
use crate::algebra::{Body, Expr, Table, Vector, needed, parameters};
use crate::effects::{Equations, Expression, Own, of_curve, of_library, without_equations};
use motor::MotorFile;
use motor::effect::curve::knots_and_values;
use motor::effect::{EffectConfig, Hook, Rated, Role, from_motor_file, rated};
use std::collections::BTreeSet;

/// The model of a motor file, without the effects named `without`.
///
/// # Errors
/// An effect that has no equations here, a formula that is not understood, a name in `without` that the file does not have, a motor without
/// leakage on one side where a saturation needs it.
pub fn model_of(file: &MotorFile, label: &str, without: &[String]) -> Result<Model, ExportError> {
    let configs = from_motor_file(file, label)?;
    check_without(&configs, without)?;
    let name = |config: &EffectConfig| config.effect.descriptor().name;
    let is_left_out = |config: &EffectConfig| without.iter().any(|w| w == name(config));
    let (out, kept): (Vec<_>, Vec<_>) = configs.into_iter().partition(is_left_out);
    let (absent, kept): (Vec<_>, Vec<_>) = kept.into_iter().partition(is_absent);
    let mut builder = Builder::new(file);
    for config in &kept {
        builder.add(config)?;
    }
    let mut model = builder.finish(file)?;
    let mut remark = |text: &str, configs: &[EffectConfig]| {
        if !configs.is_empty() {
            let labels: Vec<_> = configs.iter().map(label_of).collect();
            model.remarks.push(format!("{text}: {}", labels.join(", ")));
        }
    };
    remark("Effects", &kept);
    remark("In the motor file, but left out", &out);
    remark("In the motor file with size zero, hence absent", &absent);
    Ok(model)
}

/// Every size is zero.
fn is_absent(config: &EffectConfig) -> bool {
    let parameters = config.effect.descriptor().parameters.iter();
    let mut sizes = parameters
        .zip(&config.values)
        .filter(|(p, _)| p.role == Role::Size)
        .map(|(_, value)| *value)
        .peekable();
    sizes.peek().is_some() && sizes.all(|size| size == 0.0)
}

/// Every name is that of an effect of the file.
pub fn check_without(configs: &[EffectConfig], without: &[String]) -> Result<(), ExportError> {
    let names: BTreeSet<&str> = configs.iter().map(|c| c.effect.descriptor().name).collect();
    match without.iter().find(|name| !names.contains(name.as_str())) {
        None => Ok(()),
        Some(name) => Err(ExportError::NotThere {
            name: name.clone(),
            known: names.into_iter().map(str::to_owned).collect(),
        }),
    }
}

/// Name and form.
pub fn label_of(config: &EffectConfig) -> String {
    let descriptor = config.effect.descriptor();
    match descriptor.form {
        "" => descriptor.name.to_owned(),
        form => format!("{} ({form})", descriptor.name),
    }
}

struct Builder {
    parameters: Parameters,
    constants: Constants,
    rated: Rated<f64>,
    parts: Parts,
    states: Vec<Quantity>,
    tables: Vec<Table>,
}

impl Builder {
    fn new(file: &MotorFile) -> Builder {
        let mut parameters = Parameters::default();
        Builder {
            constants: parameters.motor(file),
            parameters,
            rated: rated(file),
            parts: Parts::default(),
            states: motor_states(),
            tables: Vec::new(),
        }
    }

    fn add(&mut self, config: &EffectConfig) -> Result<(), ExportError> {
        let (source, p) = match config.effect.law() {
            Some((action, _)) => {
                let table = self.table(config);
                (Source::File(of_curve(action, &table)), Vec::new())
            }
            None => (self.source(config)?, self.parameters.effect(config)),
        };
        let part = Part {
            label: label_of(config),
            number: self.parts.all().len(),
            own: Own {
                p,
                extra: Vec::new(),
            },
            hooks: config.effect.hooks(),
            source,
        };
        let extra = self.add_states(part.equations());
        self.parts.push(Part {
            own: Own { extra, ..part.own },
            ..part
        });
        Ok(())
    }

    fn source(&self, config: &EffectConfig) -> Result<Source, ExportError> {
        let descriptor = config.effect.descriptor();
        if let Some(equations) = of_library(config) {
            return Ok(Source::Library(equations));
        }
        if descriptor.name != motor::effect::expression::NAME {
            return Err(ExportError::NoEquations {
                effect: descriptor.name.to_owned(),
                reason: without_equations(descriptor.name),
            });
        }
        let texts = config.effect.texts();
        let text = |key: &str| texts.iter().find(|t| t.0 == key).map_or("", |t| t.1);
        let names = descriptor.parameters.iter().map(|p| p.name).collect();
        let expression = Expression::new(text("formula"), text("adds_to"), names);
        expression
            .map(|expression| Source::File(Box::new(expression)))
            .map_err(|reason| ExportError::Formula {
                formula: text("formula").to_owned(),
                reason,
            })
    }

    /// Adds the table of a curve: what the simulation reads; its name.
    fn table(&mut self, config: &EffectConfig) -> String {
        let written = config.effect.prepared(&config.values, &self.rated);
        let what = label_of(config);
        let knots = match knots_and_values(config) {
            Some((_, x, y)) => format!("; knots {x:?}, values {y:?}"),
            None => String::new(),
        };
        let name = format!("curve_{}", self.tables.len() + 1);
        self.tables.push(Table {
            name: name.clone(),
            meaning: format!("{what}{knots}"),
            first: written[0],
            per_unit: written[1],
            values: written[2..].to_vec(),
        });
        name
    }

    fn add_states(&mut self, equations: &dyn Equations) -> Vec<Expr> {
        let taken: BTreeSet<String> = self.states.iter().map(|s| s.name.clone()).collect();
        let free = |name: &str| {
            let again = (2..).map(|k| format!("{name}_{k}"));
            let mut names = std::iter::once(name.to_owned()).chain(again);
            names.find(|name| !taken.contains(name)).unwrap_or_default()
        };
        let new: Vec<Quantity> = equations
            .states()
            .iter()
            .map(|(name, unit, meaning)| Quantity::new(&free(name), 0.0, unit, meaning))
            .collect();
        let symbols = new.iter().map(|state| Expr::name(&state.name)).collect();
        self.states.extend(new);
        symbols
    }

    fn finish(self, file: &MotorFile) -> Result<Model, ExportError> {
        self.check_leakage(file)?;
        let (constants, parts) = (&self.constants, &self.parts);
        let held = self.section(|body| {
            let instant = assemble::instant(body, constants, parts, None);
            assemble::held(body, parts, &instant)
        });
        let added = Vector::new(Expr::name(HELD[0]), Expr::name(HELD[1]));
        let added = held.as_ref().map(|_| &added);
        let derivatives = self.section(|body| {
            let instant = assemble::instant(body, constants, parts, added);
            Some(assemble::rates(body, constants, parts, &instant))
        });
        let shown = self.section(|body| {
            let instant = assemble::instant(body, constants, parts, None);
            Some(assemble::shown(body, constants, parts, &instant))
        });
        let held_by: Vec<_> = parts
            .with(Hook::HeldVoltage)
            .map(|part| part.label.as_str())
            .collect();
        let derivatives = derivatives.unwrap_or_default();
        let shown = shown.unwrap_or_default();
        let sections = [&derivatives, &shown].into_iter().chain(&held);
        let used: BTreeSet<String> = sections
            .flat_map(|section| parameters(&section.statements, &section.results))
            .collect();
        let mut constants = self.parameters.into_all();
        constants.retain(|parameter| used.contains(&parameter.name));
        finite(Model {
            title: file.name.clone(),
            remarks: Vec::new(),
            held_by: held_by.join(", "),
            parameters: constants,
            tables: self.tables,
            states: self.states,
            inputs: inputs(&self.rated),
            outputs: outputs(),
            derivatives,
            shown,
            held,
        })
    }

    /// A star of branches needs leakage on both sides.
    fn check_leakage(&self, file: &MotorFile) -> Result<(), ExportError> {
        let is_saturating = self.parts.with(Hook::Magnetizing).next().is_some();
        let has_cage = |part: &Part| {
            part.own
                .extra
                .iter()
                .any(|x| *x == Expr::name("psi_cage_alpha"))
        };
        let is_star = is_saturating || self.parts.all().iter().any(has_cage);
        match is_star && (file.parameters.l_ls == 0.0 || file.parameters.l_lr == 0.0) {
            true => Err(ExportError::NoLeakage),
            false => Ok(()),
        }
    }

    /// A function of the instant, without what it does not need.
    fn section(&self, write: impl FnOnce(&mut Body) -> Option<Vec<Expr>>) -> Option<Section> {
        let inputs = inputs(&self.rated);
        let outputs = outputs();
        let quantities = self.states.iter().chain(&inputs).chain(&outputs);
        let taken = quantities
            .map(|q| q.name.as_str())
            .chain(self.parameters.names());
        let tables = self.tables.iter().map(|table| table.name.as_str());
        let reserved = ["t", "h", "x", "u", "p"];
        let mut body = Body::new(taken.chain(tables).chain(HELD).chain(reserved));
        let results = write(&mut body)?;
        Some(Section {
            statements: needed(body.statements(), &results),
            results,
        })
    }
}

/// No language writes an infinite number in the same way, and none means anything here.
fn finite(model: Model) -> Result<Model, ExportError> {
    let wrong = model.parameters.iter().find(|p| !p.value.is_finite());
    match wrong {
        None => Ok(model),
        Some(parameter) => Err(ExportError::NotFinite {
            parameter: parameter.name.clone(),
        }),
    }
}

fn motor_states() -> Vec<Quantity> {
    let notes = [
        ("V s", "stator flux linkage"),
        ("V s", "stator flux linkage"),
        ("V s", "rotor flux linkage"),
        ("V s", "rotor flux linkage"),
        ("rad/s", "mechanical speed"),
        ("rad", "shaft angle"),
    ];
    let named = MOTOR_STATES.iter().zip(notes);
    named
        .map(|(name, (unit, meaning))| Quantity::new(name, 0.0, unit, meaning))
        .collect()
}

fn inputs(rated: &Rated<f64>) -> Vec<Quantity> {
    vec![
        Quantity::new("u_a", 0.0, "V", "phase voltage against the star point"),
        Quantity::new("u_b", 0.0, "V", "phase voltage against the star point"),
        Quantity::new("u_c", 0.0, "V", "phase voltage against the star point"),
        Quantity::new("tau_load", 0.0, "N m", "load torque"),
        Quantity::new("omega_sync", rated.omega_sync, "rad/s", "supply frequency"),
    ]
}

fn outputs() -> Vec<Quantity> {
    let current = |name| Quantity::new(name, 0.0, "A", "phase current, as its channel shows it");
    vec![
        current("i_a"),
        current("i_b"),
        current("i_c"),
        Quantity::new("speed", 0.0, "rad/s", "speed, as its channel shows it"),
        Quantity::new("angle", 0.0, "rad", "shaft angle"),
        Quantity::new("torque", 0.0, "N m", "electromagnetic torque"),
    ]
}
