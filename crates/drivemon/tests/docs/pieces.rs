//! A page in pieces: text, commands with their output, files.

use crate::arguments;

/// What a page consists of.
pub enum Piece {
    /// Left as it is.
    Text(String),
    /// Commands with the output that the page shows.
    Commands(Vec<Shown>),
    /// A file that the following commands may read.
    File(File),
}

/// A command and its output as shown.
pub struct Shown {
    /// The line with the prompt.
    pub command: String,
    /// The lines below it.
    pub output: Vec<String>,
}

/// A file as a page shows it.
pub struct File {
    /// Its path, seen from the project's folder.
    pub path: String,
    /// The file whose text stands before it.
    pub after: Option<String>,
    /// Its text.
    pub text: String,
}

/// A page in pieces.
pub fn pieces(text: &str) -> Vec<Piece> {
    let mut pieces = Vec::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        pieces.push(Piece::Text(line.to_owned()));
        let file = word_after(line, "file=");
        if line != "```console" && file.is_none() {
            continue;
        }
        let block: Vec<&str> = lines.by_ref().take_while(|line| *line != "```").collect();
        pieces.extend(match file {
            None => commands(&block),
            Some(path) => Some(Piece::File(File {
                path,
                after: word_after(line, "after="),
                text: block.iter().map(|line| format!("{line}\n")).collect(),
            })),
        });
        pieces.push(Piece::Text("```".to_owned()));
    }
    pieces
}

/// The files that a page shows.
pub fn files(text: &str) -> Vec<File> {
    let file = |piece| match piece {
        Piece::File(file) => Some(file),
        _ => None,
    };
    pieces(text).into_iter().filter_map(file).collect()
}

/// What the line that opens a block says behind `key`.
fn word_after(line: &str, key: &str) -> Option<String> {
    let words = line.strip_prefix("```")?.split_whitespace();
    words
        .filter_map(|word| word.strip_prefix(key))
        .next()
        .map(str::to_owned)
}

/// Blocks with other commands are not this test's.
fn commands(block: &[&str]) -> Option<Piece> {
    let foreign = |line: &&str| line.starts_with("$ ") && arguments(line).is_none();
    if block.iter().any(foreign) || block.first().is_none_or(|line| arguments(line).is_none()) {
        let text = block.join("\n");
        return (!block.is_empty()).then_some(Piece::Text(text));
    }
    let mut shown: Vec<Shown> = Vec::new();
    for line in block {
        match shown.last_mut() {
            Some(last) if arguments(line).is_none() => last.output.push((*line).to_owned()),
            _ => shown.push(Shown {
                command: (*line).to_owned(),
                output: Vec::new(),
            }),
        }
    }
    Some(Piece::Commands(shown))
}
