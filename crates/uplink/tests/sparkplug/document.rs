//! docs/fleet/sparkplug.md shows the metrics of the code, and names tests that exist. `UPDATE_DOCS=1 cargo test -p uplink --test
//! sparkplug` writes the metrics there.

use std::path::{Path, PathBuf};

use uplink::sparkplug::{Group, OF_GATEWAY, OF_MOTOR};

const PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/fleet/sparkplug.md");
const BEGIN: &str = "<!-- from the code: metrics -->\n";
const END: &str = "<!-- end -->";

fn rows(of: &str, groups: &[Group]) -> String {
    let metrics = groups.iter().flat_map(|group| group.metrics());
    let row = |metric: &uplink::sparkplug::Definition| {
        let (name, kind, unit) = (metric.name, metric.datatype, metric.unit);
        let kind = match kind {
            uplink::sparkplug::Datatype::Text => "String".to_owned(),
            other => format!("{other:?}"),
        };
        format!(
            "| {of} | `{name}` | {kind} | {unit} | {} |\n",
            metric.meaning
        )
    };
    metrics.map(row).collect()
}

fn metrics() -> String {
    let head = "| of | metric | type | unit | meaning |\n|---|---|---|---|---|\n";
    format!(
        "{head}{}{}",
        rows("motor", &OF_MOTOR),
        rows("gateway", &OF_GATEWAY)
    )
}

#[test]
fn the_document_shows_the_metrics() {
    let text = std::fs::read_to_string(PATH).expect("part of the source tree");
    let (before, rest) = text.split_once(BEGIN).expect("the mark of the table");
    let (shown, after) = rest.split_once(END).expect("the mark behind the table");
    if std::env::var_os("UPDATE_DOCS").is_some() {
        let text = format!("{before}{BEGIN}{}{END}{after}", metrics());
        return std::fs::write(PATH, text).expect("a writable source tree");
    }
    let remedy = "write it with UPDATE_DOCS=1 cargo test -p uplink --test sparkplug";
    assert_eq!(shown, metrics(), "{remedy}");
}

fn sources(folder: &Path, found: &mut String) {
    for entry in std::fs::read_dir(folder).expect("part of the source tree") {
        let path: PathBuf = entry.expect("readable").path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push_str(&std::fs::read_to_string(&path).expect("UTF-8"));
        }
    }
}

/// Of each assertion that is called covered the last column names a test or a tool, and it exists.
#[test]
fn the_tests_of_the_assertions_exist() {
    let text = std::fs::read_to_string(PATH).expect("part of the source tree");
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut code = String::new();
    sources(&crates.join("uplink"), &mut code);
    sources(&crates.join("fleet/src"), &mut code);
    sources(&crates.join("gateway/src"), &mut code);
    let (_, table) = text
        .split_once("| assertion | state | by what |")
        .expect("the table");
    let mut covered = 0;
    for row in table.lines().filter(|line| line.contains("| covered")) {
        let by = row.rsplit(" | ").next().expect("a last column");
        let mut names = by.split('`').skip(1).step_by(2).peekable();
        assert!(
            names.peek().is_some() || by.contains("the same test") || row.contains("in part"),
            "{row}"
        );
        for name in names.filter(|name| name.contains('_') && !name.ends_with("_file")) {
            assert!(code.contains(&format!("fn {name}(")), "{name} is no test");
        }
        covered += 1;
    }
    assert!(covered > 20, "{covered}");
}
