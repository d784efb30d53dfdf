//! docs/modbus.md shows the tables of the code. `UPDATE_DOCS=1 cargo test -p board` writes them there.

use board::EventCause;
use board::modbus::{Kind, MAP, Object, UNLOCK_KEY, address};

const PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/modbus.md");
const END: &str = "<!-- end -->";

fn document() -> String {
    std::fs::read_to_string(PATH).expect("part of the source tree")
}

fn registers() -> String {
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

fn objects() -> String {
    let row = |object: Object| format!("| `{:#04X}` | {} |\n", object as u8, object.label());
    "| object | what |\n|---|---|\n".to_owned() + &Object::ALL.map(row).concat()
}

fn events() -> String {
    let row = |cause: EventCause| {
        let [first, second] = cause.values();
        let (number, label) = (cause as u16, cause.label());
        format!("| {number} | {label} | {first} | {second} |\n")
    };
    "| cause | event | first value | second value |\n|---|---|---|---|\n".to_owned()
        + &EventCause::ALL.map(row).concat()
}

#[test]
fn the_document_shows_the_tables() {
    let mut text = document();
    for (name, table) in [
        ("registers", registers()),
        ("objects", objects()),
        ("events", events()),
    ] {
        let begin = format!("<!-- from the code: {name} -->\n");
        let (before, rest) = text.split_once(&begin).expect("the mark of the table");
        let (shown, after) = rest.split_once(END).expect("the mark behind the table");
        if std::env::var_os("UPDATE_DOCS").is_some() {
            text = format!("{before}{begin}{table}{END}{after}");
        } else {
            let remedy = "write it with UPDATE_DOCS=1 cargo test -p board";
            assert_eq!(shown, table, "{name}: {remedy}");
        }
    }
    if std::env::var_os("UPDATE_DOCS").is_some() {
        std::fs::write(PATH, text).expect("a writable source tree");
    }
}

#[test]
fn the_document_names_the_key() {
    let key = format!("`{UNLOCK_KEY:#06X}`");
    assert!(document().contains(&key), "{key}");
}
