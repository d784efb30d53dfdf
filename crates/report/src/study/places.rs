//! Where a model fails, in three lines.

use discovery::{CompareReport, RegionReport, SignalReport};
use schemars::JsonSchema;
use serde::Serialize;

/// Places that are named.
const PLACES: usize = 3;

/// A part of a recording, or a column of a load table.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Place {
    /// What the motor did there, or the column.
    pub name: String,
    /// Begin, s.
    pub from_s: Option<f64>,
    /// End, s.
    pub to_s: Option<f64>,
    /// How far off the model is there.
    pub error_over_noise: f64,
}

/// The worst places, each kind once.
pub fn worst(report: &CompareReport) -> Vec<Place> {
    let mut all: Vec<Place> = report.regions.iter().map(Place::region).collect();
    if all.is_empty() {
        all.extend(report.signals.iter().map(Place::signal));
    }
    all.sort_by(|a, b| b.error_over_noise.total_cmp(&a.error_over_noise));
    let mut found: Vec<Place> = Vec::new();
    for place in all {
        if found.iter().all(|known| known.name != place.name) {
            found.push(place);
        }
    }
    found.truncate(PLACES);
    found
}

/// Begin of the first of them, s.
pub(super) fn furthest_off(places: &[Place]) -> f64 {
    places.first().and_then(|place| place.from_s).unwrap_or(0.0)
}

impl Place {
    fn region(region: &RegionReport) -> Place {
        Place {
            name: region.name.clone(),
            from_s: Some(region.from_s),
            to_s: Some(region.to_s),
            error_over_noise: region.error_over_noise,
        }
    }

    fn signal(signal: &SignalReport) -> Place {
        Place {
            name: signal.name.clone(),
            from_s: None,
            to_s: None,
            error_over_noise: signal.error_over_noise,
        }
    }
}
