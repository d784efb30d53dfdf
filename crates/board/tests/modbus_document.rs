//! docs/modbus.md shows the table of the code. `UPDATE_DOCS=1 cargo test -p board` writes it there.

use board::modbus::{Kind, MAP, UNLOCK_KEY, address};

const PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/modbus.md");
const BEGIN: &str = "<!-- from the code: registers -->\n";
const END: &str = "<!-- end -->";

fn document() -> String {
    std::fs::read_to_string(PATH).expect("part of the source tree")
}

fn table() -> String {
    let head =
        "| address | registers | type | value | unit | meaning |\n|---|---|---|---|---|---|\n";
    let row = |entry: &board::modbus::Entry| {
        let kind = match entry.kind {
            Kind::Word => "u16",
            Kind::Long => "u32",
            Kind::Float => "float32",
        };
        let (first, words) = (address(entry.field), entry.kind.words());
        let (field, unit, meaning) = (entry.field, entry.unit, &entry.meaning);
        format!("| {first} | {words} | {kind} | {field:?} | {unit} | {meaning} |\n")
    };
    head.to_owned() + &MAP.iter().map(row).collect::<String>()
}

#[test]
fn the_document_shows_the_map() {
    let text = document();
    let (before, rest) = text.split_once(BEGIN).expect("the mark of the table");
    let (shown, after) = rest.split_once(END).expect("the mark behind the table");
    if std::env::var_os("UPDATE_DOCS").is_some() {
        let text = format!("{before}{BEGIN}{}{END}{after}", table());
        std::fs::write(PATH, text).expect("a writable source tree");
    } else {
        let remedy = "write it with UPDATE_DOCS=1 cargo test -p board";
        assert_eq!(shown, table(), "{remedy}");
    }
}

#[test]
fn the_document_names_the_key() {
    let key = format!("`{UNLOCK_KEY:#06X}`");
    assert!(document().contains(&key), "{key}");
}
