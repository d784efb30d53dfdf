//! Where the commands of a page run.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::pieces::File;
use crate::{arguments, root};

/// What the commands of the documentation may read.
const INPUTS: [&str; 4] = ["motors", "sim-host/scenarios", "tests/data", "campaigns"];

/// A folder for one run, with copies of the inputs, removed at the end.
pub struct Workplace(PathBuf);

impl Workplace {
    /// A folder of this name with the inputs.
    pub fn new(name: &str) -> Workplace {
        let folder =
            std::env::temp_dir().join(format!("drivemon-docs-{name}-{}", std::process::id()));
        for input in INPUTS {
            copy(&root().join(input), &folder.join(input));
        }
        Workplace(folder)
    }

    /// What a command prints; comments after two blanks and `#` are for the reader. [`Workplace::json`] reads what the commands
    /// of the discovery say beside that.
    pub fn run(&self, command: &str) -> Vec<String> {
        let arguments = arguments(command).and_then(|all| all.split("  #").next());
        let arguments = arguments.unwrap_or_default().trim();
        let mut program = Command::new(env!("CARGO_BIN_EXE_drivemon"));
        program.args(arguments.split_whitespace());
        if arguments.starts_with("explain ") || arguments.starts_with("adopt ") {
            program.arg("--json").arg(report_of(arguments));
        }
        let output = program
            .current_dir(&self.0)
            .env("NO_COLOR", "1")
            .output()
            .expect("the program starts");
        let code = output.status.code();
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(matches!(code, Some(0..=3)), "{command}: {code:?}\n{errors}");
        let text = String::from_utf8_lossy(&output.stdout).into_owned() + &errors;
        text.trim_end()
            .lines()
            .map(|line| line.trim_end().to_owned())
            .collect()
    }

    /// What a command of the discovery said when it was run last.
    pub fn json(&self, arguments: &str) -> serde_json::Value {
        let path = self.0.join(report_of(arguments));
        let text = fs::read_to_string(path).expect("the page runs this command");
        serde_json::from_str(&text).expect("JSON")
    }

    /// Writes a file that a page shows.
    pub fn write(&self, file: &File) {
        let before = file.after.as_ref().map(|base| self.0.join(base));
        let before = before.map(|path| fs::read_to_string(path).expect("a text beside the page"));
        let text = before.unwrap_or_default() + &file.text;
        let path = self.0.join(&file.path);
        fs::create_dir_all(path.parent().expect("in a folder")).expect("room for a folder");
        fs::write(path, text).expect("writable");
    }
}

/// Name of the file for the JSON of a command.
fn report_of(arguments: &str) -> String {
    arguments.replace([' ', '/'], "-") + ".json"
}

impl Drop for Workplace {
    fn drop(&mut self) {
        // A leftover in the folder for temporary files disturbs no later run.
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Copies a folder.
pub fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a folder for temporary files");
    for entry in fs::read_dir(from).expect("part of the source tree") {
        let path = entry.expect("readable").path();
        let target = to.join(path.file_name().expect("named"));
        if path.is_dir() {
            copy(&path, &target);
        } else {
            fs::copy(&path, &target).expect("room for a copy");
        }
    }
}
