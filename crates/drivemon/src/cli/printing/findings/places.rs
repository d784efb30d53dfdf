//! Where a model fails, in three lines of a terminal.

use crate::cli::arguments::study::bar;
use crate::cli::printing::terminal::say;
use report::study::Place;

/// Longest bar, characters.
const WIDTH: usize = 24;

/// Prints them, a line each.
pub fn print(places: &[Place]) {
    let full = places.first().map_or(0.0, |place| place.error_over_noise);
    for place in places {
        say!(
            "  {:<30} {} {:7.2} x noise  {}",
            place.name,
            time(place),
            place.error_over_noise,
            bar(place.error_over_noise, full, WIDTH)
        );
    }
}

fn time(place: &Place) -> String {
    match place.from_s.zip(place.to_s) {
        Some((from, to)) => format!("{from:6.3} .. {to:6.3} s"),
        None => " ".repeat("0.000 ..  0.000 s".len() + 1),
    }
}
