//! Runs netlists in ngspice.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicU32, Ordering};

static RUNS: AtomicU32 = AtomicU32::new(0);

fn folder() -> PathBuf {
    behaviour::in_project("docs/front-end/netlists")
}

/// Text of a netlist.
pub fn netlist(name: &str) -> String {
    std::fs::read_to_string(folder().join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The words behind `word` in every line that begins with it; `None`, with a message, where ngspice is not installed.
fn words(text: &str, word: &str) -> Option<Vec<Vec<String>>> {
    let run = RUNS.fetch_add(1, Ordering::Relaxed);
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("front-end-{run}.cir"));
    let library = folder().join("channel.lib");
    let text = text.replace("channel.lib", &library.display().to_string());
    std::fs::write(&file, text).expect("a temporary file");
    let Ok(output) = Command::new("ngspice").arg("-b").arg(&file).output() else {
        println!("skipped: ngspice is not installed (apt install ngspice)");
        return None;
    };
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    let lines = printed
        .lines()
        .map(|line| line.split_whitespace().map(str::to_owned));
    let mut found: Vec<Vec<String>> = lines.map(Iterator::collect).collect();
    found.retain(|line| line.first().is_some_and(|first| first == word));
    assert!(!found.is_empty(), "no `{word}` in:\n{printed}");
    Some(found)
}

/// The numbers behind `word`, line by line.
pub fn lines(text: &str, word: &str) -> Option<Vec<Vec<f64>>> {
    let numbers = |line: &Vec<String>| {
        let behind = line.iter().skip(1).filter(|word| *word != "=");
        behind.map(|word| number(word)).collect()
    };
    Some(words(text, word)?.iter().map(numbers).collect())
}

/// A name and a number behind `word`, line by line.
pub fn named(text: &str, word: &str) -> Option<Vec<(String, f64)>> {
    let pair = |line: &Vec<String>| (line[1].clone(), number(&line[2]));
    Some(words(text, word)?.iter().map(pair).collect())
}

fn number(word: &str) -> f64 {
    word.parse()
        .unwrap_or_else(|_| panic!("`{word}` is no number"))
}
