//! docs/fleet/modbus-map.md shows the map of the code. `UPDATE_DOCS=1 cargo test -p uplink --test modbus` writes it there.

use uplink::modbus::{Kind, MAP, address};

const PATH: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../docs/fleet/modbus-map.md"
);
const BEGIN: &str = "<!-- from the code: registers -->\n";
const END: &str = "<!-- end -->";

fn registers() -> String {
    let head =
        "| address | registers | type | value | unit | meaning |\n|---|---|---|---|---|---|\n";
    let row = |entry: &uplink::modbus::Entry| {
        let kind = match entry.kind {
            Kind::Word => "u16",
            Kind::Long => "u32",
            Kind::Float => "float32",
            Kind::Text(_) => "text",
        };
        let (first, words) = (address(entry.field), entry.kind.words());
        let (field, unit, meaning) = (entry.field, entry.unit, entry.meaning);
        format!("| {first} | {words} | {kind} | {field:?} | {unit} | {meaning} |\n")
    };
    head.to_owned() + &MAP.iter().map(row).collect::<String>()
}

#[test]
fn the_document_shows_the_map() {
    let text = std::fs::read_to_string(PATH).expect("part of the source tree");
    let (before, rest) = text.split_once(BEGIN).expect("the mark of the table");
    let (shown, after) = rest.split_once(END).expect("the mark behind the table");
    if std::env::var_os("UPDATE_DOCS").is_some() {
        let text = format!("{before}{BEGIN}{}{END}{after}", registers());
        return std::fs::write(PATH, text).expect("a writable source tree");
    }
    let remedy = "write it with UPDATE_DOCS=1 cargo test -p uplink --test modbus";
    assert_eq!(shown, registers(), "{remedy}");
}
