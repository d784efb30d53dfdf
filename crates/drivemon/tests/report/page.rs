//! A page, the JSON written beside it, and what must hold between them.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

/// A page and its JSON.
pub struct Page {
    /// The file.
    pub path: String,
    /// Its text.
    pub html: String,
    json: Value,
}

/// A number as it stands on a page.
#[derive(Debug)]
pub struct Number {
    value: f64,
    from: String,
    scale: f64,
    shown: String,
}

/// Runs the command line.
pub fn drivemon(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_drivemon"))
        .args(arguments)
        .output()
        .expect("drivemon runs")
}

/// A file of the project.
pub fn project(name: &str) -> String {
    format!("{}/../../{name}", env!("CARGO_MANIFEST_DIR"))
}

/// A file for this test run.
pub fn scratch(name: &str) -> String {
    format!("{}/{name}", env!("CARGO_TARGET_TMPDIR"))
}

impl Page {
    /// The page and the JSON of one command; a finding is no failure, nor is a recording of which nothing can be judged.
    pub fn of(name: &str, arguments: &[&str]) -> Page {
        let path = scratch(&format!("{name}.html"));
        let json = scratch(&format!("{name}.json"));
        let outputs = ["--json", &json, "--report", &path];
        let done = drivemon(&[arguments, &outputs].concat());
        assert!(matches!(done.status.code(), Some(0 | 1 | 3)), "{done:?}");
        Page {
            html: read(&path),
            json: serde_json::from_str(&read(&json)).expect("JSON"),
            path,
        }
    }

    /// Everything that holds for every page.
    pub fn check(&self) {
        self.check_self_contained();
        self.check_embedded();
        self.check_numbers();
        self.check_tables();
        self.check_figures();
        assert_eq!(self.html.matches("<h1").count(), 1);
    }

    /// Nothing on the page is fetched from anywhere: no attribute, style or script names a source.
    fn check_self_contained(&self) {
        let sources = [
            " src=",
            " href=",
            "url(",
            "@import",
            "<link",
            "<iframe",
            "<object",
            "fetch(",
            "XMLHttpRequest",
            "WebSocket",
            "import(",
            "sendBeacon",
        ];
        for source in sources {
            assert!(!self.html.contains(source), "{source} in {}", self.path);
        }
        assert!(self.html.contains("default-src 'none'"));
    }

    fn check_embedded(&self) {
        let start = "<script type=\"application/json\" id=\"result\">";
        let text = between(&self.html, start, "</script>").expect("the result is embedded");
        let embedded: Value = serde_json::from_str(text).expect("JSON");
        assert_eq!(embedded, self.json);
    }

    /// Every number is the one at its address in the JSON, correct to the last digit shown.
    fn check_numbers(&self) {
        for number in self.numbers() {
            let there = self.json.pointer(&number.from).and_then(Value::as_f64);
            assert_eq!(there, Some(number.value), "{number:?}");
            let (shown, unit) = parse(&number.shown);
            let error = (shown - number.value * number.scale).abs();
            // Half a unit of the last digit, and what binary fractions add to it.
            assert!(error <= 0.5 * unit * (1.0 + 1e-6), "{number:?}");
        }
    }

    /// No cell of a table holds a figure that does not come from the JSON, as a number or within a text.
    fn check_tables(&self) {
        let mut texts = Vec::new();
        strings(&self.json, &mut texts);
        for cell in self.html.split("<td").skip(1) {
            let (_, content) = cell.split_once('>').expect("an opening tag");
            let content = content.split("</td>").next().unwrap_or_default();
            let rest = unescape(&text(&without_data(content)));
            let has_digit = rest.chars().any(|c| c.is_ascii_digit());
            let is_known = texts.contains(&rest.trim());
            assert!(is_known || !has_digit, "{rest} in {}", self.path);
        }
    }

    /// Every address that a figure draws from leads to something.
    fn check_figures(&self) {
        for chart in self.charts() {
            let mut addresses = vec![&chart["x"]["from"]];
            for part in ["series", "limits"] {
                let parts = chart[part].as_array().expect("a list");
                addresses.extend(parts.iter().map(|part| &part["from"]));
            }
            for address in addresses.into_iter().filter_map(Value::as_str) {
                let (head, tail) = address.split_once("/*").unwrap_or((address, ""));
                let rows = self.json.pointer(head).expect(address);
                let first = if address.contains('*') {
                    &rows[0]
                } else {
                    rows
                };
                assert!(first.pointer(tail).is_some(), "{address}");
            }
        }
    }

    /// The figures as the page describes them.
    pub fn charts(&self) -> Vec<Value> {
        let described = self.html.split("data-chart=\"").skip(1);
        let text = described.map(|rest| rest.split('"').next().unwrap_or_default());
        text.map(|text| serde_json::from_str(&unescape(text)).expect("a figure"))
            .collect()
    }

    /// A number of the JSON.
    pub fn number(&self, address: &str) -> f64 {
        let there = self.json.pointer(address).and_then(Value::as_f64);
        there.unwrap_or_else(|| panic!("no number at {address}"))
    }

    /// How many items a list of the JSON has; it has some.
    pub fn items(&self, address: &str) -> usize {
        let there = self.json.pointer(address).and_then(Value::as_array);
        there.map_or_else(|| panic!("no list at {address}"), Vec::len)
    }

    /// A text of the result; empty where there is none.
    pub fn text(&self, address: &str) -> String {
        let text = self.json.pointer(address).and_then(Value::as_str);
        text.unwrap_or_default().to_owned()
    }

    /// The values at an address of the JSON, one for each row of the array before the star.
    pub fn column(&self, address: &str) -> Vec<&Value> {
        let (head, tail) = address.split_once("/*").expect("a star");
        let rows = self.json.pointer(head).and_then(Value::as_array);
        let rows = rows.expect(address).iter();
        rows.map(|row| row.pointer(tail).expect(address)).collect()
    }

    /// All numbers on the page outside figures.
    pub fn numbers(&self) -> Vec<Number> {
        self.html.split("<data ").skip(1).map(number).collect()
    }
}

/// All texts in a result.
fn strings<'a>(value: &'a Value, into: &mut Vec<&'a str>) {
    match value {
        Value::String(text) => into.push(text),
        Value::Array(all) => all.iter().for_each(|value| strings(value, into)),
        Value::Object(all) => all.values().for_each(|value| strings(value, into)),
        _ => {}
    }
}

/// Markup without the numbers that carry their address.
fn without_data(markup: &str) -> String {
    let mut parts = markup.split("<data ");
    let first = parts.next().unwrap_or_default().to_owned();
    let after = parts.map(|part| part.split_once("</data>").expect("an end").1);
    after.fold(first, |all, part| all + part)
}

/// Markup without tags.
fn text(markup: &str) -> String {
    let mut parts = markup.split('<');
    let first = parts.next().unwrap_or_default().to_owned();
    parts
        .filter_map(|part| part.split_once('>'))
        .fold(first, |all, (_, part)| all + part)
}

fn number(tag: &str) -> Number {
    let attribute = |name: &str| between(tag, &format!("{name}=\""), "\"").expect(name);
    Number {
        // Read by the reader of the JSON, so that both round alike.
        value: serde_json::from_str(attribute("value")).expect("a number"),
        from: unescape(attribute("data-from")),
        scale: attribute("data-scale").parse().expect("a number"),
        shown: between(tag, ">", "</data>").expect("text").to_owned(),
    }
}

/// A number as written, and the unit of its last digit.
fn parse(shown: &str) -> (f64, f64) {
    let plain = shown.replace('\u{2212}', "-").replace('+', "");
    let (mantissa, exponent) = plain.split_once('e').unwrap_or((&plain, "0"));
    let after = mantissa.split_once('.').map_or(0, |(_, after)| after.len());
    let exponent: i32 = exponent.parse().expect("an exponent");
    let unit = 10.0_f64.powi(exponent - after as i32);
    (plain.parse().expect("a number"), unit)
}

fn between<'a>(text: &'a str, from: &str, to: &str) -> Option<&'a str> {
    let rest = &text[text.find(from)? + from.len()..];
    Some(&rest[..rest.find(to)?])
}

fn unescape(text: &str) -> String {
    let text = text.replace("&quot;", "\"").replace("&lt;", "<");
    text.replace("&gt;", ">").replace("&amp;", "&")
}

fn read(path: &str) -> String {
    std::fs::read_to_string(Path::new(path)).expect(path)
}
