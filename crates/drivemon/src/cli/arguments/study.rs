//! What compare, explain and adopt share: their inputs, their progress, and how they speak.

use std::path::{Path, PathBuf};

use audit::Audit;
use clap::Args;
use discovery::{Budget, Error, Given, Laws, Progress, Role, Shapes, Sources, StretchReport};
use document::read_text;
use motor::MotorFile;

use crate::cli::arguments::files::Files;
use crate::cli::arguments::input::{InputArgs, read_motor};
use crate::cli::arguments::long::given;
use crate::cli::printing::failure::Failure;
use crate::cli::printing::output::OutputArgs;
use crate::cli::printing::shell::quoted;
use crate::cli::printing::terminal::say;
use crate::cli::printing::{paint, progress};
use report::study::{Inputs, Typed};
use report::{Style, decimals, significant};

/// Recordings, the motor file, and where results go.
#[derive(Debug, Args)]
pub struct StudyArgs {
    /// Recordings (.csv, .csv.gz) or load-test tables
    #[arg(value_name = "REC", required = true)]
    recordings: Vec<PathBuf>,
    /// Motor file
    #[arg(long, value_name = "M")]
    motor: PathBuf,
    #[command(flatten)]
    input: InputArgs,
    #[command(flatten)]
    pub output: OutputArgs,
}

/// Shapes of formulas beside the program's own.
#[derive(Debug, Default, Args)]
pub struct ShapesArgs {
    /// TOML file with shapes that a law's curve is held against, beside the program's own
    #[arg(long, value_name = "FILE")]
    shapes: Option<PathBuf>,
}

impl ShapesArgs {
    /// The file among those that are read.
    pub fn read_by(&self, files: Files) -> Files {
        match &self.shapes {
            Some(path) => files.reads("the file of --shapes", path),
            None => files,
        }
    }

    /// The shapes.
    ///
    /// # Errors
    /// A file that cannot be read, and everything that is wrong with it.
    pub fn shapes(&self) -> Result<Shapes, Failure> {
        let Some(path) = &self.shapes else {
            return Ok(Shapes::default());
        };
        let text = read_text(path)?;
        Ok(Shapes::with(&text, &path.display().to_string())?)
    }

    /// The option as it is typed behind a subcommand.
    pub fn typed(&self) -> String {
        let path = self
            .shapes
            .as_ref()
            .map(|path| quoted(&path.display().to_string()));
        path.map_or_else(String::new, |path| format!(" --shapes {path}"))
    }
}

/// Steps of the progress bar.
const STEPS: f64 = 1000.0;

impl StudyArgs {
    /// What the command reads and writes.
    pub fn files(&self) -> Files {
        Files::default()
            .reads_recordings(&self.recordings, &self.input)
            .reads("the motor file", &self.motor)
            .writes_results(&self.output)
    }

    /// All recordings in the order given; `budget`: what is taken of long ones, with one recording and with several.
    ///
    /// # Errors
    /// Whatever is wrong with flags, file or sidecar.
    pub fn given(
        &self,
        motor: &MotorFile,
        budget: fn(bool) -> Budget,
    ) -> Result<Vec<Given>, Failure> {
        let budget = budget(self.recordings.len() == 1);
        let paths = self.recordings.iter();
        paths
            .map(|path| given(path, &self.input, motor, budget))
            .collect()
    }

    /// The motor file.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub fn motor(&self) -> Result<MotorFile, Failure> {
        read_motor(&self.motor)
    }

    /// The motor file's path.
    pub fn motor_path(&self) -> &PathBuf {
        &self.motor
    }

    /// The recordings' names.
    pub fn names(&self) -> Vec<String> {
        let names = self.recordings.iter();
        names.map(|path| path.display().to_string()).collect()
    }

    /// What a question is asked about.
    pub fn inputs<'a>(
        &self,
        names: &'a [String],
        sources: &'a [Given],
        motor: &'a MotorFile,
    ) -> Inputs<'a> {
        Inputs {
            names,
            sources: Sources::Given(sources),
            motor,
            laws: Laws::default(),
            next_run: None,
        }
    }

    /// The recordings, the motor file and the flags of reading as they are typed behind a subcommand.
    pub fn typed(&self) -> String {
        self.typed_with(&self.motor)
    }

    /// The same with another motor file.
    pub fn typed_with(&self, motor: &Path) -> String {
        self.as_typed(&self.names(), &self.input.typed())
            .with(motor)
    }

    /// What adds `addition` to the motor file, from recordings in this order; `more` are further flags.
    pub fn adopt(&self, addition: &str, names: &[String], more: &str) -> String {
        let flags = self.input.typed();
        self.as_typed(names, &flags).adopt(addition, more)
    }

    fn as_typed<'a>(&'a self, names: &'a [String], flags: &'a str) -> Typed<'a> {
        Typed {
            names,
            motor: &self.motor,
            flags,
        }
    }
}

/// Does some work behind a progress bar.
///
/// # Errors
/// What the work ran into, as the command line says it.
pub fn with_progress<T>(
    work: impl FnOnce(&mut Progress<'_>) -> Result<T, Error>,
) -> Result<T, Failure> {
    let bar = progress::bar("starting", STEPS as u64);
    let mut tell = |what: &str, share: f64| {
        bar.set_message(what.to_owned());
        bar.set_position((share * STEPS) as u64);
    };
    let done = work(&mut tell);
    bar.finish_and_clear();
    done.map_err(|error| match error {
        Error::MotorFile(error) => Failure::File(error),
        Error::Unsupported(..) => Failure::Unsupported(error.to_string()),
        Error::Recordings(_) | Error::UnknownEffect(_) => Failure::Usage(error.to_string()),
    })
}

/// Prints what the audit found.
pub fn print_audit(audit: &Audit) {
    for finding in &audit.findings {
        say!("  {} {}", paint::caution("audit:"), finding.detail);
    }
}

/// Prints which stretches of long recordings are used, and why.
pub fn print_stretches(stretches: &[StretchReport]) {
    if stretches.is_empty() {
        return;
    }
    say!("Of what is too long to be kept these stretches are used:");
    for one in stretches {
        let role = match one.role {
            Role::Fitted => "",
            Role::Proves => "proves  ",
        };
        say!(
            "  {:>10.1} .. {:.1} s  {role}{}",
            one.from_s,
            one.to_s,
            one.why
        );
    }
}

/// Prints what to do next, with the command to type where there is one.
pub fn print_next(why: &str, command: Option<&str>) {
    say!("\n{}", wrapped(why));
    if let Some(command) = command {
        say!("  {}", paint::strong(command));
    }
}

/// Columns of a line of prose.
const COLUMNS: usize = 110;

/// Prose in lines that a terminal shows without breaking words; commands are never wrapped.
pub fn wrapped(text: &str) -> String {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let line = &mut lines[0];
        if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > COLUMNS {
            lines.insert(0, String::new());
        }
        let line = &mut lines[0];
        if !line.is_empty() {
            line.push(' ');
        }
        line.push_str(word);
    }
    lines.reverse();
    lines.join("\n")
}

/// A number as the pages write it, with the minus that can be typed.
pub fn plain(style: Style, x: f64) -> String {
    style.text(x).replace('\u{2212}', "-")
}

/// A quantity of unknown size.
pub fn quantity(x: f64) -> String {
    plain(significant(5), x)
}

/// A value that was fitted, with its standard error, in columns.
pub fn uncertain(value: f64, std_error: f64) -> String {
    let error = match std_error > 0.0 {
        true => format!("+- {}", plain(significant(2), std_error)),
        false => "not fitted".to_owned(),
    };
    format!("{:>10} {error:<12}", quantity(value))
}

/// A change, percent.
pub fn percent(x: f64) -> String {
    plain(decimals(1).signed(), x)
}

/// A bar of `after`, and behind it what is gone of `before`, `width` characters long.
pub fn fall(before: f64, after: f64, width: usize) -> String {
    let rest = bar(after, before, width);
    let gone = width - rest.chars().count();
    rest + &"░".repeat(gone)
}

/// A bar of `value` out of `full`, at most `width` characters long.
pub fn bar(value: f64, full: f64, width: usize) -> String {
    let share = if full > 0.0 { value / full } else { 0.0 };
    let length = (share.clamp(0.0, 1.0) * width as f64).round() as usize;
    "█".repeat(length.max(usize::from(value > 0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_grow_with_their_value_and_never_vanish() {
        assert_eq!(bar(1.0, 2.0, 10).chars().count(), 5);
        assert_eq!(bar(5.0, 2.0, 10).chars().count(), 10);
        assert_eq!(bar(1e-6, 2.0, 10).chars().count(), 1);
        assert_eq!(bar(0.0, 2.0, 10), "");
        assert_eq!(bar(1.0, 0.0, 10).chars().count(), 1);
    }

    #[test]
    fn a_fall_shows_what_is_left_and_what_is_gone() {
        assert_eq!(fall(4.0, 1.0, 4), "█░░░");
        assert_eq!(fall(1.0, 1.1, 4), "████");
    }

    #[test]
    fn quantities_have_five_digits_and_their_errors_two() {
        assert_eq!(quantity(7.485e-5), "7.4850e-5");
        assert_eq!(quantity(0.001_551_4), "0.0015514");
        assert_eq!(quantity(264.159_157), "264.16");
        assert_eq!(uncertain(-1.5, 0.012_34).trim(), "-1.5000 +- 0.012");
        assert_eq!(uncertain(0.12, 0.0).trim(), "0.12000 not fitted");
        assert_eq!(percent(-0.02), "0.0");
    }

    #[test]
    fn prose_is_broken_between_words() {
        let text = wrapped(&"word ".repeat(40));
        assert!(text.lines().all(|line| line.chars().count() <= COLUMNS));
        assert_eq!(text.split_whitespace().count(), 40);
    }

    #[test]
    fn names_with_blanks_are_quoted() {
        assert_eq!(quoted("a/b-1.csv.gz"), "a/b-1.csv.gz");
        assert_eq!(quoted("my file.csv"), "\"my file.csv\"");
    }
}
