//! The bill of materials: `docs/front-end/parts.csv`, and its table in docs/wiring.md.

use std::path::{Path, PathBuf};

const BEGIN: &str = "<!-- parts: written from front-end/parts.csv by `UPDATE_DOCS=1 cargo test -p drive-monitor --test front_end` -->\n";
const END: &str = "<!-- end of parts -->\n";

fn in_docs(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("docs")
        .join(path)
}

/// Text of the list.
pub fn text() -> String {
    std::fs::read_to_string(in_docs("front-end/parts.csv")).expect("the list of parts")
}

/// A cell holds no comma; a semicolon stands for one.
fn table() -> String {
    let mut table = String::new();
    for (k, line) in text().lines().enumerate() {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), 6, "cells of `{line}`");
        table += &format!("| {} |\n", cells.join(" | ").replace(';', ","));
        if k == 0 {
            table += &format!("{}|\n", "|---".repeat(cells.len()));
        }
    }
    table
}

/// Compares the page's table with the list; writes it where `UPDATE_DOCS` is set.
pub fn check_or_update() {
    let page = in_docs("wiring.md");
    let text = std::fs::read_to_string(&page).expect("the page");
    let (before, rest) = text.split_once(BEGIN).expect("the mark before the table");
    let (printed, after) = rest.split_once(END).expect("the mark behind the table");
    if std::env::var_os("UPDATE_DOCS").is_some() {
        std::fs::write(&page, format!("{before}{BEGIN}{}{END}{after}", table())).expect("writable");
        return;
    }
    assert!(
        printed == table(),
        "docs/wiring.md and docs/front-end/parts.csv differ: run UPDATE_DOCS=1 cargo test -p drive-monitor --test front_end"
    );
}
