//! `modelDescription.xml` of FMI 2.0.

use crate::model::{Model, Quantity, STEP_S};
use crate::print::Job;
use std::fmt::Write as _;

/// The description of a model whose identity is `guid`.
pub fn description(model: &Model, job: &Job<'_>, guid: &str) -> String {
    let mut xml = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let remarks = model.remarks.join(". ");
    // A string takes whatever is written.
    let _ = writeln!(
        xml,
        "<fmiModelDescription fmiVersion=\"2.0\" modelName=\"{}\" guid=\"{guid}\" description=\"{}. {}\" \
         generationTool=\"drivemon {}\" variableNamingConvention=\"structured\" numberOfEventIndicators=\"0\">",
        job.name,
        escaped(&model.title),
        escaped(&remarks),
        job.version,
    );
    let sources = format!(
        "    <SourceFiles>\n      <File name=\"{0}.c\"/>\n      <File name=\"fmi2.c\"/>\n    </SourceFiles>\n",
        job.name
    );
    let kinds: &[&str] = match model.held {
        // What is decided once a step has no meaning for somebody else's integrator.
        Some(_) => &["CoSimulation"],
        None => &["ModelExchange", "CoSimulation"],
    };
    for kind in kinds {
        let variable = match *kind {
            "CoSimulation" => " canHandleVariableCommunicationStepSize=\"true\"",
            _ => "",
        };
        let _ = writeln!(
            xml,
            "  <{kind} modelIdentifier=\"{}\"{variable} canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"true\">\n{sources}  </{kind}>",
            job.name
        );
    }
    let _ = writeln!(
        xml,
        "  <DefaultExperiment startTime=\"0\" stopTime=\"1\" stepSize=\"{STEP_S:?}\"/>"
    );
    xml.push_str(&variables(model));
    xml.push_str(&structure(model));
    xml.push_str("</fmiModelDescription>\n");
    xml
}

/// All variables in the order of their value references.
fn variables(model: &Model) -> String {
    let mut xml = String::from("  <ModelVariables>\n");
    let mut reference = 0;
    let mut one = |q: &Quantity, attributes: &str, real: &str| {
        let unit = match q.unit.as_str() {
            "-" => String::new(),
            unit => format!(" ({unit})"),
        };
        let _ = writeln!(
            xml,
            "    <ScalarVariable name=\"{}\" valueReference=\"{reference}\" description=\"{}{}\" {attributes}><Real{real}/></ScalarVariable>",
            escaped(&q.name),
            escaped(&q.meaning),
            escaped(&unit),
        );
        reference += 1;
    };
    let start = |q: &Quantity| format!(" start=\"{:?}\"", q.value);
    for q in &model.parameters {
        one(
            q,
            "causality=\"parameter\" variability=\"tunable\" initial=\"exact\"",
            &start(q),
        );
    }
    for q in &model.inputs {
        one(
            q,
            "causality=\"input\" variability=\"continuous\"",
            &start(q),
        );
    }
    for q in &model.states {
        one(
            q,
            "causality=\"local\" variability=\"continuous\" initial=\"exact\"",
            &start(q),
        );
    }
    let first = model.parameters.len() + model.inputs.len() + 1;
    for (k, q) in model.states.iter().enumerate() {
        let meaning = format!("rate of change of {} per second", q.name);
        let rate = Quantity::new(&format!("der({})", q.name), 0.0, "-", &meaning);
        let of = format!(" derivative=\"{}\"", first + k);
        one(
            &rate,
            "causality=\"local\" variability=\"continuous\" initial=\"calculated\"",
            &of,
        );
    }
    for q in &model.outputs {
        one(
            q,
            "causality=\"output\" variability=\"continuous\" initial=\"calculated\"",
            "",
        );
    }
    xml.push_str("  </ModelVariables>\n");
    xml
}

/// Outputs, rates and what is unknown at the beginning, by their places in the list of variables, which begin with 1.
fn structure(model: &Model) -> String {
    let states = model.states.len();
    let rates = model.parameters.len() + model.inputs.len() + states;
    let all = |kind: &str, from: usize, count: usize| {
        let lines = (from + 1..=from + count).map(|k| format!("      <Unknown index=\"{k}\"/>\n"));
        format!("    <{kind}>\n{}    </{kind}>\n", lines.collect::<String>())
    };
    format!(
        "  <ModelStructure>\n{}{}{}  </ModelStructure>\n",
        all("Outputs", rates + states, model.outputs.len()),
        all("Derivatives", rates, states),
        all("InitialUnknowns", rates, states + model.outputs.len()),
    )
}

/// Text in an attribute.
fn escaped(text: &str) -> String {
    let one = |c: char| match c {
        '&' => "&amp;".to_owned(),
        '<' => "&lt;".to_owned(),
        '>' => "&gt;".to_owned(),
        '"' => "&quot;".to_owned(),
        c if c.is_control() => " ".to_owned(),
        c => c.to_string(),
    };
    text.chars().map(one).collect()
}
