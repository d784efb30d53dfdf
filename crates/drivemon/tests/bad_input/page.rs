//! docs/bad-input.md, and that what it says is so.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use crate::board::faults;
use crate::common::PROJECT;
use crate::given::{Given, sections};

const HEAD: &str = "\
# What bad input does

Every input that is refused, what is printed first, and the test that proves it; at the end the faults of the board. A test of
`crates/drivemon/tests/bad_input` gives each of these inputs to the program and writes this page: what is quoted is what is printed. Whatever the
input, the program says file, place and remedy, ends with exit code 2 (bad input) or 3 (sound, but not usable), and does not panic;
[fuzzing](fuzzing.md) looks for inputs that the list below does not have.
";

fn page() -> String {
    let mut text = HEAD.to_owned();
    for (title, inputs) in sections() {
        let _ = write!(text, "\n## {title}\n\n");
        tests_of(&inputs, &mut text);
        text += "\n| input | exit | what is printed |\n|---|---|---|\n";
        for given in &inputs {
            let (printed, code) = given.printed();
            let _ = writeln!(
                text,
                "| {} | {code} | {} |",
                cell(&given.what),
                cell(&printed)
            );
        }
    }
    text += "\n## The board, wires and samples\n\n| what happens | what is seen | test |\n|---|---|---|\n";
    for fault in faults() {
        let _ = writeln!(
            text,
            "| {} | {} | `{}` |",
            fault.what, fault.seen, fault.test
        );
    }
    text
}

/// The tests of a section, each once.
fn tests_of(inputs: &[Given], text: &mut String) {
    let mut tests: Vec<_> = inputs.iter().map(|given| given.test).collect();
    tests.sort_unstable();
    tests.dedup();
    for test in tests {
        let count = inputs.iter().filter(|given| given.test == test).count();
        let _ = writeln!(text, "- {count} by `{test}`");
    }
}

/// Text as code in a cell of a table.
fn cell(text: &str) -> String {
    let text = text.replace('|', "\\|");
    match text.contains('`') {
        true if text.contains("``") => format!("``` {text} ```"),
        true => format!("`` {text} ``"),
        false if text.is_empty() => "(nothing)".to_owned(),
        false => format!("`{text}`"),
    }
}

#[test]
fn every_bad_input_prints_what_the_page_says() {
    let path = Path::new(PROJECT).join("docs/bad-input.md");
    let wanted = page();
    if std::env::var_os("UPDATE_DOCS").is_some() {
        fs::write(&path, &wanted).expect("writable");
    }
    let page = fs::read_to_string(&path).unwrap_or_default();
    for (line, wanted) in page.lines().zip(wanted.lines()) {
        assert_eq!(line, wanted, "UPDATE_DOCS=1 writes the page");
    }
    assert_eq!(page.lines().count(), wanted.lines().count());
}

#[test]
fn every_test_that_the_page_names_exists() {
    let inputs = sections();
    let of_inputs = inputs.iter().flat_map(|(_, inputs)| inputs);
    let mut tests: Vec<String> = of_inputs.map(|given| given.test.to_owned()).collect();
    tests.extend(faults().into_iter().map(|fault| fault.test));
    for test in tests {
        let (place, name) = test.split_once("::").expect("file::name");
        let place = Path::new(PROJECT).join(place);
        let function = format!("fn {name}(");
        let files = sources(&place);
        let found = files.iter().any(|file| {
            fs::read_to_string(file)
                .unwrap_or_default()
                .contains(&function)
        });
        assert!(found, "{test} does not exist");
    }
}

/// A file, or the Rust files of a folder.
fn sources(place: &Path) -> Vec<PathBuf> {
    if place.is_file() {
        return vec![place.to_owned()];
    }
    let entries = fs::read_dir(place).into_iter().flatten();
    let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
    paths
        .flat_map(|path| match path.is_dir() {
            true => sources(&path),
            false => vec![path],
        })
        .filter(|path| path.extension().is_some_and(|extension| extension == "rs"))
        .collect()
}
