//! An effect of the library is one file and one line, as `docs/adding-an-effect.md` says.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::pieces::{self, File};
use crate::root;
use crate::workplace::copy;

const EFFECTS: &str = "crates/motor/src/effects";
const LIST: &str = "crates/motor/src/effects/mod.rs";
/// Where code lives that must name no effect's type.
const CODE: [&str; 13] = [
    "crates/motor/src",
    "crates/parity/src",
    "crates/monitor/src",
    "crates/board/src",
    "crates/estimation/src",
    "crates/discovery/src",
    "crates/scenario/src",
    "crates/replay/src",
    "crates/campaign/src",
    "crates/report/src",
    "crates/panel/src",
    "crates/drivemon/src",
    "src",
];

fn source(path: &str) -> String {
    fs::read_to_string(root().join(path)).expect("part of the source tree")
}

/// The page's Rust: the new file, and the line that registers it.
fn new_effect() -> (File, String) {
    let page = source("docs/adding-an-effect.md");
    let files = pieces::files(&page).into_iter();
    let mut rust = files.filter(|file| file.path.ends_with(".rs"));
    let file = rust.next().expect("a new file");
    assert!(rust.next().is_none(), "more than one new file");
    let opening = format!("```rust line={LIST}\n");
    let (_, rest) = page.split_once(&opening).expect("the line");
    let (line, _) = rest.split_once("```").expect("its end");
    assert_eq!(line.lines().count(), 1, "{line}");
    (file, line.to_owned())
}

/// File and type of a line of the list.
fn entry(line: &str) -> (&str, &str) {
    let entry = line.trim().strip_suffix(',').expect("one effect per line");
    entry.split_once(": ").expect("`file: Type`")
}

/// Files and types of the list `effects!`.
fn registered(list: &str) -> Vec<(&str, &str)> {
    let (_, lines) = list.split_once("\neffects! {\n").expect("the list");
    let (lines, _) = lines.split_once("\n}").expect("its end");
    lines.lines().map(entry).collect()
}

/// All Rust files below a folder.
fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("part of the source tree");
    let paths = entries.map(|entry| entry.expect("readable").path());
    let files = paths.flat_map(|path| match path.is_dir() {
        true => rust_files(&path),
        false => vec![path],
    });
    files
        .filter(|path| path.extension().is_some_and(|x| x == "rs"))
        .collect()
}

fn has_word(text: &str, word: &str) -> bool {
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    text.split(|c| !is_part(c)).any(|found| found == word)
}

#[test]
fn nothing_but_its_own_file_and_one_line_names_an_effect() {
    let list = source(LIST);
    let effects = registered(&list);
    assert!(
        effects.len() > 30,
        "only {} effects were found",
        effects.len()
    );
    let files: Vec<PathBuf> = CODE
        .iter()
        .flat_map(|folder| rust_files(&root().join(folder)))
        .collect();
    for path in files.iter().filter(|path| **path != root().join(LIST)) {
        let text = fs::read_to_string(path).expect("UTF-8");
        for (file, effect) in &effects {
            let own = root().join(EFFECTS).join(format!("{file}.rs"));
            let named = has_word(&text, effect) || text.contains(&format!("{file}::"));
            assert!(!named || *path == own, "{} names {effect}", path.display());
        }
    }
}

/// Code asks an effect what it is; tests may say which one they mean.
#[test]
fn no_code_asks_for_an_effect_by_its_name() {
    let is_test = |path: &Path| {
        let parts = path
            .components()
            .map(|part| part.as_os_str().to_string_lossy());
        let mut names = parts.collect::<Vec<_>>().into_iter().rev();
        names
            .next()
            .is_some_and(|file| file.contains("tests") || file.starts_with("malformed"))
            || names.any(|folder| folder == "tests")
    };
    let own = root().join(EFFECTS);
    let folders = CODE.iter().map(|folder| root().join(folder));
    for path in folders.flat_map(|folder| rust_files(&folder)) {
        let inside = path.strip_prefix(root()).expect("in the source tree");
        if is_test(inside) || path.starts_with(&own) {
            continue;
        }
        let text = fs::read_to_string(&path).expect("UTF-8");
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        for name in motor::effects::names() {
            let asks = code.contains(&format!("\"{name}\""));
            assert!(!asks, "{} names {name}", path.display());
        }
    }
}

#[test]
fn every_effect_of_the_folder_is_in_the_list_once() {
    let list = source(LIST);
    let effects = registered(&list);
    for path in rust_files(&root().join(EFFECTS)) {
        let text = fs::read_to_string(&path).expect("UTF-8");
        // A formula has no type of its own for each effect.
        if !text.contains("steady_effect!(") || path.ends_with("steady.rs") {
            continue;
        }
        let name = path
            .file_stem()
            .and_then(|stem| stem.to_str())
            .expect("a name");
        let lines = effects.iter().filter(|(file, _)| *file == name).count();
        assert_eq!(lines, 1, "{}", path.display());
    }
}

#[test]
fn the_line_of_the_page_belongs_to_its_file() {
    let (new, line) = new_effect();
    let (file, effect) = entry(&line);
    assert_eq!(new.path, format!("{EFFECTS}/{file}.rs"));
    assert!(new.text.contains(&format!("steady_effect!({effect}, ")));
    assert!(
        !root().join(&new.path).exists(),
        "the library has this effect: take another example"
    );
}

/// Builds the crate `motor` anew, which takes a minute.
#[test]
#[ignore = "builds a copy of a crate: a minute or two"]
fn the_file_and_the_line_of_the_page_are_all_that_an_effect_needs() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("new-effect");
    let _ = fs::remove_dir_all(&folder);
    copy(&root().join("crates/motor"), &folder.join("crates/motor"));
    fs::copy(root().join("Cargo.lock"), folder.join("Cargo.lock")).expect("room");
    fs::write(folder.join("Cargo.toml"), workspace_of_motor()).expect("writable");
    let (new, line) = new_effect();
    fs::write(folder.join(&new.path), &new.text).expect("writable");
    let list = source(LIST).replace("\neffects! {\n", &format!("\neffects! {{\n{line}"));
    fs::write(folder.join(LIST), list).expect("writable");
    let done = Command::new(env!("CARGO"))
        .args([
            "test",
            "--offline",
            "-p",
            "motor",
            "--all-features",
            "--test",
            "effects",
            "--",
            "--nocapture",
        ])
        .current_dir(&folder)
        .env("CARGO_TARGET_DIR", folder.join("target"))
        .output()
        .expect("cargo runs");
    let said = String::from_utf8_lossy(&done.stdout) + String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{said}");
    let (file, _) = entry(&line);
    let name = file.replace('_', "-");
    assert!(
        said.contains(&format!("\n{name} ")),
        "{name} was not tested:\n{said}"
    );
}

/// The project's workspace with one member.
fn workspace_of_motor() -> String {
    let mut all: toml::Table = source("Cargo.toml").parse().expect("TOML");
    let mut workspace = all.remove("workspace").expect("a workspace");
    let table = workspace.as_table_mut().expect("a table");
    table.insert("members".into(), toml::Value::from(vec!["crates/motor"]));
    table.remove("default-members");
    let kept = toml::Table::from_iter([("workspace".to_owned(), workspace)]);
    kept.to_string()
}
