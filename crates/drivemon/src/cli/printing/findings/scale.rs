//! A speed of unknown scale, and what it leaves open.

use discovery::{AtRest, ErrorSource, Inconclusive, SpeedScaleReport};

use crate::cli::arguments::study::{quantity, uncertain, wrapped};
use crate::cli::printing::paint;
use crate::cli::printing::terminal::say;

/// What a standard error means that the recording does not tell.
const UNTOLD: &str = "  No model here explains the recording, so the factor is only as sure as physics makes it: the least slip lies \
                      between none and that of rated load.";

/// Prints the fitted scale and what cannot be concluded beside it.
pub fn print(scale: Option<&SpeedScaleReport>, open: &[Inconclusive]) {
    let Some(scale) = scale else { return };
    say!("\nScale of the speed, fitted because it was declared unknown:");
    let value = uncertain(scale.factor, scale.std_error);
    say!("  {:<30} {value} {}", "factor", scale.unit);
    let at_rest = match scale.offset_is {
        AtRest::Measured => uncertain(scale.offset, scale.offset_std_error),
        AtRest::Given | AtRest::Assumed => format!("{:>10}", quantity(scale.offset)),
    };
    let origin = origin(scale.offset_is);
    say!("  {:<30} {at_rest} {origin}", "column at rest");
    if scale.std_error_is == ErrorSource::Physics {
        say!("{}", wrapped(UNTOLD));
    }
    if open.is_empty() {
        return;
    }
    say!(
        "{}",
        paint::caution("Cannot be concluded with that scale free:")
    );
    for one in open {
        say!("{}", wrapped(&format!("  {}: {}", one.name, one.why)));
    }
}

/// Where the reading at rest comes from.
fn origin(at_rest: AtRest) -> &'static str {
    match at_rest {
        AtRest::Given => "as given",
        AtRest::Measured => "read while the motor stood",
        AtRest::Assumed => "assumed: the recording does not hold the motor at rest",
    }
}
