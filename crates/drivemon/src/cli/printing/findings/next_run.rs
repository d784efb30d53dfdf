//! The next experiment in a terminal.

use discovery::{DecidesReport, DesignGoal, DesignReport};
use std::path::Path;

use crate::cli::arguments::study::wrapped;
use crate::cli::printing::paint;
use crate::cli::printing::terminal::say;

/// Prints what to do, what it decides and where the scenario file is.
pub fn print(design: Option<&DesignReport>, written: Option<&Path>) {
    let Some(design) = design else {
        say!("\nNothing is open that another run within these limits would decide.");
        return;
    };
    say!("\n{}", paint::strong("The next experiment"));
    say!("{}", wrapped(&design.summary));
    for (number, line) in design.instructions.iter().enumerate() {
        say!("{}", wrapped(&format!("  {}. {line}", number + 1)));
    }
    say!(
        "{}",
        match design.goal {
            DesignGoal::Narrow => "Of each standard error goes:",
            DesignGoal::Show => "By so much the error of a model without it would be larger:",
            DesignGoal::TellApart =>
                "By so much the error of the wrong explanation would be larger:",
        }
    );
    for decides in &design.decides {
        let standard = design
            .standard_decides
            .iter()
            .find(|s| s.what == decides.what);
        say!("  {}", line(decides, standard));
    }
    say!("The best of the usual runs: {}.", design.best_standard_run);
    if let Some(path) = written {
        let simulate = format!("drivemon simulate {}", path.display());
        say!(
            "Scenario file: {} ({simulate} rehearses the run).",
            path.display()
        );
    }
}

fn line(decides: &DecidesReport, standard: Option<&DecidesReport>) -> String {
    let usual = standard.map_or_else(String::new, |s| {
        format!(", {:.1} % with the best usual run", s.gain_percent)
    });
    format!(
        "{:<52} {:>6.1} % ({}){usual}",
        decides.what,
        decides.gain_percent,
        decides.how_surely.word()
    )
}
