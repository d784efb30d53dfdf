//! Errors over the noise below each other, a name and a bar each.

use crate::cli::arguments::study::bar;
use crate::cli::printing::terminal::say;

/// Longest bar, characters.
pub const WIDTH: usize = 36;
/// Width of the names that a longer one moves, characters.
const NAME_WIDTH: usize = 34;

/// Prints them, a line each; an error of `full` times the noise has the longest bar.
pub fn print<Name: AsRef<str>>(errors: &[(Name, f64)], full: f64) {
    for line in lines(errors, full) {
        say!("{line}");
    }
}

fn lines<Name: AsRef<str>>(errors: &[(Name, f64)], full: f64) -> Vec<String> {
    let names = errors.iter().map(|(name, _)| name.as_ref().chars().count());
    let widest = names.fold(NAME_WIDTH, usize::max);
    let line = |(name, error): &(Name, f64)| {
        let (name, bar) = (name.as_ref(), bar(*error, full, WIDTH));
        format!("  {name:<widest$} {error:8.3} x noise  {bar}")
    };
    errors.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_name_moves_the_errors_and_bars_of_all_lines() {
        let long = "with stator-phase-b that comes and goes";
        let lines = lines(&[("all parameters refitted", 4.0), (long, 1.0)], 4.0);
        let column = |line: &String| line.find(" x noise  ");
        assert!(column(&lines[0]).is_some());
        assert_eq!(column(&lines[0]), column(&lines[1]));
    }
}
