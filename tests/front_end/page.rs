//! The tables of docs/wiring.md: the parts (`docs/front-end/parts.csv`) and the simulated channels.

use crate::limits::Point;
use std::path::PathBuf;
use std::sync::Mutex;

const UPDATE: &str = "UPDATE_DOCS=1 cargo test -p behaviour --test front_end";

fn in_docs(path: &str) -> PathBuf {
    behaviour::in_project("docs").join(path)
}

/// Text of the list of parts.
pub fn parts() -> String {
    std::fs::read_to_string(in_docs("front-end/parts.csv")).expect("the list of parts")
}

/// A cell holds no comma; a semicolon stands for one.
pub fn parts_table() -> String {
    let mut table = String::new();
    for (k, line) in parts().lines().enumerate() {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), 6, "cells of `{line}`");
        table += &format!("| {} |\n", cells.join(" | ").replace(';', ","));
        if k == 0 {
            table += &format!("{}|\n", "|---".repeat(cells.len()));
        }
    }
    table
}

/// The channels at the frequencies of the netlists: gain over nominal, and delay in us where a delay means something.
pub fn channel_table(channels: &[(&str, Vec<Point>)]) -> String {
    let mut table = String::from("| simulated |");
    for point in channels.iter().take(1).flat_map(|(_, points)| points) {
        table += &match point.hertz < 1e3 {
            true => format!(" {} Hz |", point.hertz),
            false => format!(" {} kHz |", point.hertz / 1e3),
        };
    }
    let columns = table.matches('|').count() - 1;
    table += &format!("\n{}|\n", "|---".repeat(columns));
    for (name, points) in channels {
        let gains = points.iter().map(|p| format!(" {:.4} |", p.gain));
        table += &format!("| {name}: gain |{}\n", gains.collect::<String>());
        let delays = points.iter().map(|p| match p.hertz < 1e3 {
            true => format!(" {:.2} |", p.delay_us),
            false => " |".to_owned(),
        });
        table += &format!("| {name}: delay, us |{}\n", delays.collect::<String>());
    }
    table
}

/// Compares a table of the page with what it is written from; writes it where `UPDATE_DOCS` is set.
pub fn check_or_update(name: &str, table: &str) {
    // Two tables of one page are not written at once.
    static PAGE: Mutex<()> = Mutex::new(());
    let _alone = PAGE.lock();
    let page = in_docs("wiring.md");
    let text = std::fs::read_to_string(&page).expect("the page");
    let begin = format!("<!-- {name}: written by `{UPDATE}` -->\n");
    let end = format!("<!-- end of {name} -->\n");
    let (before, rest) = text.split_once(&begin).expect("the mark before the table");
    let (printed, after) = rest.split_once(&end).expect("the mark behind the table");
    if std::env::var_os("UPDATE_DOCS").is_some() {
        std::fs::write(&page, format!("{before}{begin}{table}{end}{after}")).expect("writable");
        return;
    }
    assert!(
        printed == table,
        "the table {name} of docs/wiring.md is an old one: run {UPDATE}"
    );
}
