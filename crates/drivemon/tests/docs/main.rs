//! The documentation says what is so: its commands print what it shows, its files work, its links and test names exist.
//!
//! A fenced block ```` ```console ```` whose commands all begin with `$ drivemon` or `$ cargo drivemon` is run, in a copy
//! of the files that it may read. A line `...` stands for any number of lines; a number may differ by one unit of its last
//! digit, because libraries of other platforms round differently. A block marked ```` ```console not-run ```` is left alone.
//! A block ```` ```toml file=mine.toml ```` is that file for the commands that follow on the page; with
//! `after=motors/peer-2k2.toml` it follows the text of that file.
//! `UPDATE_DOCS=1 cargo test -p drivemon --test docs` writes what the commands print into the documents.

mod agree;
mod effects_page;
mod formula;
mod json_page;
mod links;
mod new_effect;
mod pieces;
mod workplace;

use std::fs;
use std::path::{Path, PathBuf};

use agree::agree;
use pieces::{Piece, Shown, pieces};
use workplace::Workplace;

/// How a command begins: the program alone, or by cargo's alias.
const PROMPTS: [&str; 2] = ["$ drivemon", "$ cargo drivemon"];

/// The arguments of a line that is a command of this program.
fn arguments(line: &str) -> Option<&str> {
    PROMPTS.iter().find_map(|prompt| line.strip_prefix(prompt))
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The README and the book, with their texts.
fn documents() -> Vec<(PathBuf, String)> {
    let folders = ["docs", "docs/fleet"].map(|folder| fs::read_dir(root().join(folder)));
    let entries = folders.map(|entries| entries.expect("part of the source tree"));
    let pages = entries.into_iter().flatten();
    let pages = pages.map(|entry| entry.expect("readable").path());
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

/// The document as it should be; wildcards stay where they still fit.
fn updated(pieces: &[Piece], workplace: &Workplace) -> String {
    let mut text = String::new();
    for piece in pieces {
        match piece {
            Piece::Text(line) => text += &format!("{line}\n"),
            Piece::File(file) => {
                workplace.write(file);
                text += &file.text;
            }
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
    let workplace = Workplace::new("pages");
    let (mut commands, mut stale) = (0, Vec::new());
    for (path, text) in documents() {
        let pieces = pieces(&text);
        let count = |piece: &Piece| match piece {
            Piece::Commands(all) => all.len(),
            Piece::Text(_) | Piece::File(_) => 0,
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
    formula::is_found(&workplace);
}
