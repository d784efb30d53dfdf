//! Templates of files, with places that are filled.

use super::infix::{Syntax, expression};
use crate::model::{Quantity, Section};

/// A template with each `@PLACE@` replaced.
pub fn filled(template: &str, places: &[(&str, String)]) -> String {
    let put = |text: String, (place, with): &(&str, String)| text.replace(place, with);
    places.iter().fold(template.to_owned(), put)
}

/// What `one` makes of each quantity, joined.
pub fn each(quantities: &[Quantity], between: &str, one: impl Fn(&Quantity) -> String) -> String {
    let all: Vec<_> = quantities.iter().map(one).collect();
    all.join(between)
}

/// Names with the same around each, separated by commas.
pub fn names(quantities: &[Quantity], around: &str) -> String {
    each(quantities, ", ", |q| format!("{around}{}{around}", q.name))
}

/// Names, with this between them.
pub fn plain_names(quantities: &[Quantity], between: &str) -> String {
    each(quantities, between, |q| q.name.clone())
}

/// Results of a section, each as `one` writes it, its number and its text given.
pub fn results(
    syntax: &dyn Syntax,
    section: &Section,
    between: &str,
    one: impl Fn(usize, String) -> String,
) -> String {
    let texts = section.results.iter().map(|r| expression(syntax, r));
    let all: Vec<_> = texts.enumerate().map(|(k, text)| one(k, text)).collect();
    all.join(between)
}

/// Numbers separated by commas, eight in a line behind `indent`.
pub fn numbers(values: &[f64], indent: &str, go_on: &str) -> String {
    let lines = values.chunks(8).map(|line| {
        let line: Vec<_> = line.iter().map(|x| format!("{x:?}")).collect();
        format!("{indent}{}", line.join(", "))
    });
    lines.collect::<Vec<_>>().join(&format!(",{go_on}\n"))
}

/// A text that cannot end a comment or string of any language.
pub fn harmless(text: &str) -> String {
    let plain = |c: char| match c {
        '"' | '\\' => '\'',
        c if c.is_control() => ' ',
        c => c,
    };
    let text: String = text.chars().map(plain).collect();
    text.replace("*/", "* /")
        .replace("/*", "/ *")
        .replace("@", "(at)")
}
