//! A table of a file, read key by key; what was asked for is what is known.

use super::{Bounds, Document, Entry, Table, Value};
use std::cell::RefCell;

/// The words that a key may take, each with what it stands for.
pub type Choice<'c, T> = [(&'c str, T)];

/// One table of a [`Document`].
///
/// Every getter records its key as known and reports what is wrong; [`Section::finish`] then reports
/// unknown keys and missing keys.
#[derive(Debug)]
pub struct Section<'d> {
    document: &'d Document,
    table: &'d Table,
    path: String,
    line: usize,
    known: RefCell<Vec<String>>,
    missing: RefCell<Vec<(String, String)>>,
}

/// Below this similarity (Jaro-Winkler, 0 to 1) two keys are two words, not one misspelt.
const SIMILAR: f64 = 0.85;

impl<'d> Section<'d> {
    pub(super) fn new(
        document: &'d Document,
        table: &'d Table,
        path: String,
        line: usize,
    ) -> Section<'d> {
        Section {
            document,
            table,
            path,
            line,
            known: RefCell::default(),
            missing: RefCell::default(),
        }
    }

    /// Line of the section's header, counted from 1.
    pub fn line(&self) -> usize {
        self.line
    }

    /// Line of a key, or the section's own when the key is absent.
    pub fn line_of(&self, key: &str) -> usize {
        self.peek(key).map_or(self.line, |entry| entry.line)
    }

    /// The entries in the order of the file; none of them becomes known by looking.
    pub fn entries(&self) -> &'d [Entry] {
        &self.table.entries
    }

    /// Whether a key is present.
    pub fn has(&self, key: &str) -> bool {
        self.peek(key).is_some()
    }

    /// Reports a problem with a key of this section.
    pub fn report(&self, key: &str, message: impl Into<String>) {
        self.document
            .report(self.line_of(key), &self.full(key), message);
    }

    /// A number that must be present; `meaning` says what it is when it is missing.
    pub fn number(&self, key: &str, bounds: &Bounds, meaning: &str) -> Option<f64> {
        if self.has(key) {
            return self.optional_number(key, bounds).flatten();
        }
        let description = format!("{meaning}, {}", bounds.describe());
        self.require(key, &description);
        None
    }

    /// A number that may be absent: `None` after a problem, `Some(None)` when absent.
    pub fn optional_number(&self, key: &str, bounds: &Bounds) -> Option<Option<f64>> {
        let Some(entry) = self.entry(key) else {
            return Some(None);
        };
        let Value::Number(number) = entry.value else {
            self.report(key, wrong_kind(&entry.value, &bounds.describe()));
            return None;
        };
        if let Some(complaint) = bounds.complaint(number) {
            self.report(key, complaint);
            return None;
        }
        Some(Some(number))
    }

    /// A number with a default.
    pub fn number_or(&self, key: &str, bounds: &Bounds, default: f64) -> Option<f64> {
        Some(self.optional_number(key, bounds)?.unwrap_or(default))
    }

    /// A whole number with a default.
    pub fn integer_or(&self, key: &str, bounds: &Bounds, default: u32) -> Option<u32> {
        match self.optional_number(key, bounds)? {
            Some(number) => self.whole(key, number),
            None => Some(default),
        }
    }

    /// A whole number that may be absent.
    pub fn optional_integer(&self, key: &str, bounds: &Bounds) -> Option<Option<u32>> {
        match self.optional_number(key, bounds)? {
            Some(number) => self.whole(key, number).map(Some),
            None => Some(None),
        }
    }

    /// A whole number that must be present.
    pub fn integer(&self, key: &str, bounds: &Bounds, meaning: &str) -> Option<u32> {
        let number = self.number(key, bounds, meaning)?;
        self.whole(key, number)
    }

    fn whole(&self, key: &str, number: f64) -> Option<u32> {
        if number.fract() != 0.0 || !(0.0..=f64::from(u32::MAX)).contains(&number) {
            self.report(key, format!("{number} is not a whole number: write one"));
            return None;
        }
        // Checked to be a whole number inside u32 on the line above.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        Some(number as u32)
    }

    /// `N` numbers that may be absent.
    pub fn optional_numbers<const N: usize>(
        &self,
        key: &str,
        bounds: &Bounds,
    ) -> Option<Option<[f64; N]>> {
        let Some(entry) = self.entry(key) else {
            return Some(None);
        };
        let numbers = self.numbers_of(entry, bounds)?;
        let count = numbers.len();
        let Ok(array) = numbers.try_into() else {
            self.report(key, format!("has {count} values: write {N} in brackets"));
            return None;
        };
        Some(Some(array))
    }

    /// A list of numbers of any length; empty when absent.
    pub fn list(&self, key: &str, bounds: &Bounds) -> Option<Vec<f64>> {
        match self.entry(key) {
            Some(entry) => self.numbers_of(entry, bounds),
            None => Some(Vec::new()),
        }
    }

    fn numbers_of(&self, entry: &Entry, bounds: &Bounds) -> Option<Vec<f64>> {
        let Value::Array(items) = &entry.value else {
            let wanted = format!("a list of numbers, each {}", bounds.describe());
            self.report(&entry.key, wrong_kind(&entry.value, &wanted));
            return None;
        };
        items
            .iter()
            .map(|(_, value)| self.element(entry, value, bounds))
            .collect()
    }

    fn element(&self, entry: &Entry, value: &Value, bounds: &Bounds) -> Option<f64> {
        let complaint = match value {
            Value::Number(number) => match bounds.complaint(*number) {
                None => return Some(*number),
                Some(complaint) => complaint,
            },
            other => wrong_kind(other, &bounds.describe()),
        };
        self.report(&entry.key, complaint);
        None
    }

    /// Text that must be present and not blank.
    pub fn text(&self, key: &str, meaning: &str) -> Option<String> {
        if !self.has(key) {
            self.require(key, &format!("{meaning}, text in double quotes"));
        }
        self.optional_text(key)?
    }

    /// Text that may be absent; blank text is a problem.
    pub fn optional_text(&self, key: &str) -> Option<Option<String>> {
        match self.entry(key).map(|entry| &entry.value) {
            None => Some(None),
            Some(Value::Text(text)) if !text.trim().is_empty() => Some(Some(text.clone())),
            Some(Value::Text(_)) => {
                self.report(key, "is blank: write a text in double quotes");
                None
            }
            Some(other) => {
                self.report(key, wrong_kind(other, "text in double quotes"));
                None
            }
        }
    }

    /// One of a few words that must be present.
    pub fn choice<T: Copy>(&self, key: &str, choice: &Choice<'_, T>) -> Option<T> {
        if !self.has(key) {
            self.require(key, &format!("one of {}", words(choice)));
            return None;
        }
        self.optional_choice(key, choice).flatten()
    }

    /// One of a few words, with a default.
    pub fn choice_or<T: Copy>(&self, key: &str, choice: &Choice<'_, T>, default: T) -> Option<T> {
        Some(self.optional_choice(key, choice)?.unwrap_or(default))
    }

    fn optional_choice<T: Copy>(&self, key: &str, choice: &Choice<'_, T>) -> Option<Option<T>> {
        let Some(text) = self.optional_text(key)? else {
            return Some(None);
        };
        if let Some((_, meaning)) = choice.iter().find(|(word, _)| *word == text) {
            return Some(Some(*meaning));
        }
        self.report(
            key,
            format!("\"{text}\" is not known: write one of {}", words(choice)),
        );
        None
    }

    /// `true` or `false`, with a default.
    pub fn flag_or(&self, key: &str, default: bool) -> Option<bool> {
        match self.entry(key).map(|entry| &entry.value) {
            None => Some(default),
            Some(Value::Bool(flag)) => Some(*flag),
            Some(other) => {
                self.report(key, wrong_kind(other, "true or false, without quotes"));
                None
            }
        }
    }

    /// A sub-table that must be present.
    pub fn section(&self, key: &str, meaning: &str) -> Option<Section<'d>> {
        if !self.has(key) {
            self.require(key, &format!("the section [{}], {meaning}", self.full(key)));
        }
        self.optional_section(key)?
    }

    /// A sub-table that may be absent.
    pub fn optional_section(&self, key: &str) -> Option<Option<Section<'d>>> {
        let Some(entry) = self.entry(key) else {
            return Some(None);
        };
        match &entry.value {
            Value::Table(table) => Some(Some(self.child(table, self.full(key), entry.line))),
            other => {
                let wanted = format!("a section, [{}]", self.full(key));
                self.report(key, wrong_kind(other, &wanted));
                None
            }
        }
    }

    /// The sub-tables of a list of tables, `[[key]]`; empty when absent.
    pub fn sections(&self, key: &str) -> Option<Vec<Section<'d>>> {
        let Some(entry) = self.entry(key) else {
            return Some(Vec::new());
        };
        let wanted = format!("a list of sections, [[{}]]", self.full(key));
        let Value::Array(items) = &entry.value else {
            self.report(key, wrong_kind(&entry.value, &wanted));
            return None;
        };
        items
            .iter()
            .enumerate()
            .map(|(i, (line, item))| match item {
                Value::Table(table) => {
                    Some(self.child(table, format!("{}[{}]", self.full(key), i + 1), *line))
                }
                other => {
                    self.report(key, wrong_kind(other, &wanted));
                    None
                }
            })
            .collect()
    }

    fn child(&self, table: &'d Table, path: String, line: usize) -> Section<'d> {
        Section::new(self.document, table, path, line)
    }

    /// Reports unknown and missing keys. A missing key that is misspelt there is reported once.
    pub fn finish(self) {
        let known = self.known.borrow();
        let mut missing = self.missing.borrow().clone();
        let absent: Vec<_> = known.iter().filter(|key| !self.has(key)).cloned().collect();
        for entry in &self.table.entries {
            if known.contains(&entry.key) {
                continue;
            }
            let meant = closest(&entry.key, &absent);
            missing.retain(|(key, _)| Some(key) != meant);
            let message = unknown(meant, &known);
            self.document
                .report(entry.line, &self.full(&entry.key), message);
        }
        for (key, description) in &missing {
            let message = format!("is missing: add {description}");
            self.document.report(self.line, &self.full(key), message);
        }
    }

    fn require(&self, key: &str, description: &str) {
        self.learn(key);
        let pair = (key.to_owned(), description.to_owned());
        self.missing.borrow_mut().push(pair);
    }

    fn entry(&self, key: &str) -> Option<&'d Entry> {
        self.learn(key);
        self.peek(key)
    }

    fn peek(&self, key: &str) -> Option<&'d Entry> {
        self.table.entries.iter().find(|entry| entry.key == key)
    }

    fn learn(&self, key: &str) {
        let mut known = self.known.borrow_mut();
        if !known.iter().any(|other| other == key) {
            known.push(key.to_owned());
        }
    }

    fn full(&self, key: &str) -> String {
        if self.path.is_empty() {
            key.to_owned()
        } else {
            format!("{}.{key}", self.path)
        }
    }
}

fn wrong_kind(found: &Value, wanted: &str) -> String {
    let quotes = match found {
        Value::Text(text) if text.trim().parse::<f64>().is_ok() => "; remove the quotes",
        _ => "",
    };
    format!("is {}: write {wanted}{quotes}", found.kind())
}

fn words<T>(choice: &Choice<'_, T>) -> String {
    let quoted: Vec<_> = choice
        .iter()
        .map(|(word, _)| format!("\"{word}\""))
        .collect();
    quoted.join(", ")
}

fn closest<'k>(key: &str, candidates: &'k [String]) -> Option<&'k String> {
    candidates
        .iter()
        .map(|candidate| (strsim::jaro_winkler(key, candidate), candidate))
        .filter(|(similarity, _)| *similarity >= SIMILAR)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

fn unknown(meant: Option<&String>, known: &[String]) -> String {
    match meant {
        Some(meant) => format!("is not a known key: did you mean `{meant}`?"),
        None => format!(
            "is not a known key: remove it, or use one of {}",
            known.join(", ")
        ),
    }
}
