//! The lines of a configuration and their fields.

use recording::Error;

/// Text that need not be UTF-8: what is not, is taken for Latin-1, as old recorders write.
pub(super) fn text(bytes: &[u8]) -> String {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|byte| char::from(*byte)).collect(),
    }
}

/// Lines with their numbers, counted from 1.
pub(super) struct Lines<'t> {
    /// The file as the user named it.
    pub file: &'t str,
    lines: std::str::Lines<'t>,
    number: u64,
}

/// One line.
pub(super) struct Line<'t> {
    file: &'t str,
    number: u64,
    fields: Vec<&'t str>,
}

impl<'t> Lines<'t> {
    /// The lines of a text.
    pub fn new(file: &'t str, text: &'t str) -> Lines<'t> {
        Lines {
            file,
            lines: text.lines(),
            number: 0,
        }
    }

    /// The next line; `what` it must hold.
    ///
    /// # Errors
    /// The end of the text.
    pub fn next(&mut self, what: &str) -> Result<Line<'t>, Error> {
        match self.optional() {
            Some(line) => Ok(line),
            None => {
                let message = format!("the configuration ends before {what}");
                let remedy = "copy both files from the recorder again";
                Err(Error::at(self.file, self.number, "", message, remedy))
            }
        }
    }

    /// The next line, where there is one.
    pub fn optional(&mut self) -> Option<Line<'t>> {
        let text = self.lines.next()?;
        self.number += 1;
        Some(Line {
            file: self.file,
            number: self.number,
            fields: text
                .split(',')
                .map(|field| field.trim_matches(is_padding))
                .collect(),
        })
    }
}

fn is_padding(c: char) -> bool {
    c.is_whitespace() || c == '\u{1A}' || c == '\0'
}

impl<'t> Line<'t> {
    /// A field, counted from 0; empty when the line is shorter.
    pub fn text(&self, field: usize) -> &'t str {
        self.fields.get(field).copied().unwrap_or_default()
    }

    /// How many fields there are.
    pub fn len(&self) -> usize {
        self.fields.len()
    }

    /// A finite number.
    ///
    /// # Errors
    /// Anything else; `name` is the field's in the standard.
    pub fn number(&self, field: usize, name: &str) -> Result<f64, Error> {
        let text = self.text(field);
        let number = text.parse::<f64>().ok().filter(|x| x.is_finite());
        number.ok_or_else(|| self.wrong(name, text, "a number with a decimal point"))
    }

    /// A count.
    ///
    /// # Errors
    /// Anything else; `name` is the field's in the standard.
    pub fn count(&self, field: usize, name: &str) -> Result<usize, Error> {
        self.count_before(field, name, "")
    }

    /// A count with a letter behind it, `6A`.
    ///
    /// # Errors
    /// Anything else; `name` is the field's in the standard.
    pub fn count_before(&self, field: usize, name: &str, letter: &str) -> Result<usize, Error> {
        let text = self.text(field);
        let upper = text.to_ascii_uppercase();
        let digits = upper.strip_suffix(letter).map(str::trim);
        let count = digits.and_then(|digits| digits.parse::<usize>().ok());
        count.ok_or_else(|| self.wrong(name, text, &format!("a count such as 6{letter}")))
    }

    /// The error for a field that holds something else than `wanted`.
    pub fn wrong(&self, name: &str, text: &str, wanted: &str) -> Error {
        let shown: String = text.chars().take(40).collect();
        let message = format!("`{shown}` is not {wanted}");
        let remedy = "compare the line with IEEE C37.111, or copy the file from the recorder again";
        Error::at(self.file, self.number, name, message, remedy)
    }
}
