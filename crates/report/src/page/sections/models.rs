//! The models that are laid over a measurement.

use crate::page::elements::place::Place;

/// Colours of the models: what was believed stands out, what was found agrees.
const TWO: [&str; 2] = ["vermillion", "green"];
const THREE: [&str; 3] = ["vermillion", "purple", "green"];

/// Names and colours of the models.
pub fn models(overlay: &Place<'_>) -> Vec<(String, &'static str)> {
    let names: Vec<String> = overlay
        .items("models")
        .iter()
        .map(|name| name.as_text().to_owned())
        .collect();
    let colours: &[&str] = if names.len() > 2 { &THREE } else { &TWO };
    names.into_iter().zip(colours.iter().copied()).collect()
}
