//! Where a model fails, in three lines.

use discovery::{CompareReport, RegionReport, SignalReport};
use serde::Serialize;

use super::study::bar;

/// Places that are named.
const PLACES: usize = 3;
/// Longest bar, characters.
const WIDTH: usize = 24;

/// A part of a recording, or a column of a load table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Place {
    name: String,
    from_s: Option<f64>,
    to_s: Option<f64>,
    error_over_noise: f64,
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

/// Prints them, a line each.
pub fn print(places: &[Place]) {
    let full = places.first().map_or(0.0, |place| place.error_over_noise);
    for place in places {
        anstream::println!(
            "  {:<30} {} {:7.2} x noise  {}",
            place.name,
            place.time(),
            place.error_over_noise,
            bar(place.error_over_noise, full, WIDTH)
        );
    }
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

    fn time(&self) -> String {
        match self.from_s.zip(self.to_s) {
            Some((from, to)) => format!("{from:6.3} .. {to:6.3} s"),
            None => " ".repeat("0.000 ..  0.000 s".len() + 1),
        }
    }
}
