//! What is typed behind a subcommand to ask about the same recordings again.

use recording::quoted;
use std::path::Path;

/// Recordings, the motor file and the flags of reading, as they are typed.
#[derive(Clone, Copy, Debug)]
pub struct Typed<'a> {
    /// The recordings' names.
    pub names: &'a [String],
    /// The motor file.
    pub motor: &'a Path,
    /// The flags, each with a blank before it.
    pub flags: &'a str,
}

impl Typed<'_> {
    /// The line behind the subcommand.
    pub fn line(&self) -> String {
        self.with(self.motor)
    }

    /// The same with another motor file.
    pub fn with(&self, motor: &Path) -> String {
        let names: Vec<String> = self.names.iter().map(|name| quoted(name)).collect();
        let motor = quoted(&motor.display().to_string());
        format!("{} --motor {motor}{}", names.join(" "), self.flags)
    }

    /// What adds `addition` to the motor file; `more` are further flags, each with a blank before it.
    pub fn adopt(&self, addition: &str, more: &str) -> String {
        let stem = self.motor.file_stem().unwrap_or_default();
        let name = format!("{}-{addition}.toml", stem.to_string_lossy());
        let file = quoted(&self.motor.with_file_name(name).display().to_string());
        format!("drivemon adopt {addition} {}{more} -o {file}", self.line())
    }
}
