//! The documentation says what is so: its commands print what it shows, its links and test names exist.
//!
//! A fenced block ```` ```console ```` whose commands all begin with `$ drivemon` is run, in a copy of the files that
//! it may read. A line `...` stands for any number of lines; a number may differ by one unit of its last
//! digit, because libraries of other platforms round differently. A block marked ```` ```console not-run ```` is left alone.
//! `UPDATE_DOCS=1 cargo test -p sim-host --test docs` writes what the commands print into the documents.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const PROMPT: &str = "$ drivemon";
const ANY_LINES: &str = "...";
/// What the commands of the documentation may read.
const INPUTS: [&str; 3] = ["motors", "sim-host/scenarios", "tests/data"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The README and the book, with their texts.
fn documents() -> Vec<(PathBuf, String)> {
    let entries = fs::read_dir(root().join("docs")).expect("part of the source tree");
    let pages = entries.map(|entry| entry.expect("readable").path());
    let mut paths: Vec<_> = pages
        .filter(|path| path.extension().is_some_and(|extension| extension == "md"))
        .chain([root().join("README.md")])
        .filter(|path| path.is_file())
        .collect();
    paths.sort();
    let read = |path: PathBuf| {
        let text = fs::read_to_string(&path).expect("UTF-8");
        (path, text)
    };
    paths.into_iter().map(read).collect()
}

/// A text in pieces: what is left as it is, and blocks of commands with the output that they show.
enum Piece {
    Text(String),
    Commands(Vec<Shown>),
}

struct Shown {
    command: String,
    output: Vec<String>,
}

fn pieces(text: &str) -> Vec<Piece> {
    let mut pieces = Vec::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        pieces.push(Piece::Text(line.to_owned()));
        if line != "```console" {
            continue;
        }
        let block: Vec<&str> = lines.by_ref().take_while(|line| *line != "```").collect();
        if !block.is_empty() {
            pieces.push(commands(&block));
        }
        pieces.push(Piece::Text("```".to_owned()));
    }
    pieces
}

/// Blocks with other commands are not this test's.
fn commands(block: &[&str]) -> Piece {
    let foreign = |line: &&str| line.starts_with("$ ") && !line.starts_with(PROMPT);
    if block.iter().any(foreign) || !block.first().is_some_and(|line| line.starts_with(PROMPT)) {
        return Piece::Text(block.join("\n"));
    }
    let mut shown: Vec<Shown> = Vec::new();
    for line in block {
        match shown.last_mut() {
            Some(last) if !line.starts_with(PROMPT) => last.output.push((*line).to_owned()),
            _ => shown.push(Shown {
                command: (*line).to_owned(),
                output: Vec::new(),
            }),
        }
    }
    Piece::Commands(shown)
}

/// A folder for one run, with copies of the inputs, removed at the end.
struct Workplace(PathBuf);

impl Workplace {
    fn new() -> Workplace {
        let folder = std::env::temp_dir().join(format!("drivemon-docs-{}", std::process::id()));
        for input in INPUTS {
            copy(&root().join(input), &folder.join(input));
        }
        Workplace(folder)
    }

    /// What a command prints; comments after two blanks and `#` are for the reader.
    fn run(&self, command: &str) -> Vec<String> {
        let arguments = command.trim_start_matches(PROMPT).split("  #").next();
        let output = Command::new(env!("CARGO_BIN_EXE_drivemon"))
            .args(arguments.unwrap_or_default().split_whitespace())
            .current_dir(&self.0)
            .env("NO_COLOR", "1")
            .output()
            .expect("the program starts");
        let code = output.status.code();
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(matches!(code, Some(0..=3)), "{command}: {code:?}\n{errors}");
        let text = String::from_utf8_lossy(&output.stdout).into_owned() + &errors;
        text.trim_end()
            .lines()
            .map(|line| line.trim_end().to_owned())
            .collect()
    }
}

impl Drop for Workplace {
    fn drop(&mut self) {
        // A leftover in the folder for temporary files disturbs no later run.
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a folder for temporary files");
    for entry in fs::read_dir(from).expect("part of the source tree") {
        let path = entry.expect("readable").path();
        let target = to.join(path.file_name().expect("named"));
        if path.is_dir() {
            copy(&path, &target);
        } else {
            fs::copy(&path, &target).expect("room for a copy");
        }
    }
}

fn agree(shown: &[String], printed: &[String]) -> bool {
    match (shown, printed) {
        ([], []) => true,
        ([any, rest @ ..], _) if any == ANY_LINES => {
            (0..=printed.len()).any(|skipped| agree(rest, &printed[skipped..]))
        }
        ([line, rest @ ..], [other, others @ ..]) => same_line(line, other) && agree(rest, others),
        _ => false,
    }
}

fn same_line(shown: &str, printed: &str) -> bool {
    let (mut ours, mut theirs) = (shown.split_whitespace(), printed.split_whitespace());
    loop {
        match (ours.next(), theirs.next()) {
            (None, None) => return true,
            (Some(a), Some(b)) if a == b || same_number(a, b) => {}
            _ => return false,
        }
    }
}

fn same_number(shown: &str, printed: &str) -> bool {
    let trimmed = |text: &str| text.trim_end_matches([',', ';', ':', '%']).to_owned();
    let (a, b) = (trimmed(shown), trimmed(printed));
    let decimals = |text: &str| text.split_once('.').map_or(0, |(_, digits)| digits.len());
    let (Ok(x), Ok(y)) = (a.parse::<f64>(), b.parse::<f64>()) else {
        return false;
    };
    let unit = 0.1_f64.powi(i32::try_from(decimals(&a)).unwrap_or(i32::MAX));
    decimals(&a) == decimals(&b) && (x - y).abs() < 1.01 * unit
}

/// The document as it should be; wildcards stay where they still fit.
fn updated(pieces: &[Piece], workplace: &Workplace) -> String {
    let mut text = String::new();
    for piece in pieces {
        match piece {
            Piece::Text(line) => text += &format!("{line}\n"),
            Piece::Commands(all) => {
                for Shown { command, output } in all {
                    let printed = workplace.run(command);
                    let kept = if agree(output, &printed) {
                        output
                    } else {
                        &printed
                    };
                    text += &format!("{command}\n");
                    kept.iter().for_each(|line| text += &format!("{line}\n"));
                }
            }
        }
    }
    text
}

#[test]
fn commands_print_what_the_documentation_shows() {
    let update = std::env::var_os("UPDATE_DOCS").is_some();
    let workplace = Workplace::new();
    let (mut commands, mut stale) = (0, Vec::new());
    for (path, text) in documents() {
        let pieces = pieces(&text);
        let count = |piece: &Piece| match piece {
            Piece::Commands(all) => all.len(),
            Piece::Text(_) => 0,
        };
        commands += pieces.iter().map(count).sum::<usize>();
        let fresh = updated(&pieces, &workplace);
        if fresh == text {
            continue;
        }
        if update {
            fs::write(&path, &fresh).expect("writable");
        } else {
            stale.push(format!("{}:\n{fresh}", path.display()));
        }
    }
    assert!(commands >= 8, "only {commands} commands were found");
    assert!(
        stale.is_empty(),
        "these pages show something else than the program prints; look at it, then run with UPDATE_DOCS=1\n{}",
        stale.join("\n")
    );
}

#[test]
fn links_lead_somewhere() {
    let mut links = 0;
    for (path, text) in documents() {
        let folder = path.parent().expect("in a folder");
        for target in text
            .split("](")
            .skip(1)
            .filter_map(|rest| rest.split(')').next())
        {
            let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
            if file.contains("://") {
                continue;
            }
            links += 1;
            let target = if file.is_empty() {
                path.clone()
            } else {
                folder.join(file)
            };
            assert!(target.exists(), "{}: {file}", path.display());
            assert!(
                has_heading(&target, anchor),
                "{}: {file}#{anchor}",
                path.display()
            );
        }
    }
    assert!(links > 10, "only {links} links were found");
}

/// Whether a page has a heading with this anchor, as GitHub derives it.
fn has_heading(page: &Path, anchor: &str) -> bool {
    let slug = |line: &str| -> String {
        let title = line.trim_start_matches('#').trim().to_lowercase();
        let kept = title
            .chars()
            .filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
        kept.map(|c| if c == ' ' { '-' } else { c }).collect()
    };
    anchor.is_empty()
        || fs::read_to_string(page)
            .unwrap_or_default()
            .lines()
            .any(|line| line.starts_with('#') && slug(line) == anchor)
}

/// A name in backticks with three underscores or more is that of a test.
#[test]
fn every_test_that_the_theory_names_exists() {
    let theory =
        fs::read_to_string(root().join("docs/theory.md")).expect("part of the source tree");
    let mut sources = String::new();
    for folder in ["crates/motor", "crates/monitor", "sim-host/tests", "tests"] {
        collect(&root().join(folder), &mut sources);
    }
    let is_name = |text: &&str| {
        let plain = text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        plain && text.matches('_').count() >= 3
    };
    let names: Vec<&str> = theory.split('`').filter(is_name).collect();
    assert!(names.len() >= 8, "{names:?}");
    for name in names {
        assert!(
            sources.contains(&format!("fn {name}(")),
            "{name} is no test"
        );
    }
}

fn collect(folder: &Path, into: &mut String) {
    for entry in fs::read_dir(folder).expect("part of the source tree") {
        let path = entry.expect("readable").path();
        if path.is_dir() {
            collect(&path, into);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            *into += &fs::read_to_string(&path).expect("UTF-8");
        }
    }
}

/// Each effect is one file of the library; its page says what that file says.
#[test]
fn the_page_of_effects_says_what_the_library_says() {
    let path = root().join("docs/effects.md");
    let fresh = effects_page();
    if std::env::var_os("UPDATE_DOCS").is_some() {
        fs::write(&path, &fresh).expect("writable");
    }
    let page = fs::read_to_string(&path).unwrap_or_default();
    assert!(
        page == fresh,
        "docs/effects.md is stale: run with UPDATE_DOCS=1\n{fresh}"
    );
}

const EFFECTS_INTRODUCTION: &str = "\
# Physical effects

What the T model leaves out, one effect per file of [`crates/motor/src/effects`](../crates/motor/src/effects). This page is written from
those files by the test `sim-host/tests/docs.rs`. An effect is switched on by an entry `[[effects]]` of a [motor file](motor-file.md), of a
[scenario](scenarios.md), or by `drivemon adopt`. \"Typical\" is the ordinary size for the 2.2 kW motor of `motors/peer-2k2.toml`, as a motor
file writes it; every size may be 0 (or 1 for a gain), which means absent, up to 25 times the typical one.
";

fn effects_page() -> String {
    let motor = motor::MotorFile::read(root().join("motors/peer-2k2.toml")).expect("shipped");
    let rated = motor::effects::rated(&motor);
    let mut page = EFFECTS_INTRODUCTION.to_owned();
    for effect in motor::effects::ALL {
        let known = effect.descriptor();
        let form = match known.form {
            "" => String::new(),
            form => format!(", `form = \"{form}\"`"),
        };
        page += &format!("\n## `{}`{form}\n\n", known.name);
        page += &format!("Missing, one sees: {}.\n\n", known.symptom);
        page += "| key | unit | typical |\n|---|---|---|\n";
        for parameter in known.parameters {
            let typical = parameter.to_file(parameter.typical * parameter.scale.of(&rated));
            page += &format!(
                "| `{}` | {} | {} |\n",
                parameter.name,
                parameter.unit,
                short(typical)
            );
        }
        let look_alikes: Vec<String> = known
            .look_alikes
            .iter()
            .map(|name| format!("`{name}`"))
            .collect();
        if !look_alikes.is_empty() {
            page += &format!(
                "\nLooks like {}. Separated by: {}.\n",
                look_alikes.join(", "),
                known.separating_test
            );
        }
        page += match known.applies {
            motor::effects::Applies::Inverter => "\nBehind a frequency converter only.\n",
            motor::effects::Applies::Samples => {
                "\nShows in samples over time only, not in a load-test table.\n"
            }
            motor::effects::Applies::Always => "",
        };
    }
    page
}

/// Three significant digits.
fn short(x: f64) -> String {
    let digits = if x == 0.0 {
        0.0
    } else {
        2.0 - x.abs().log10().floor()
    };
    if (0.0..8.0).contains(&digits) {
        format!("{x:.0$}", digits as usize)
    } else {
        format!("{x:.2e}")
    }
}
