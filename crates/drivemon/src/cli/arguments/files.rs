//! The files of one command: nothing that it writes is anything that it reads, or written twice.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use recording::{Sidecar, companions, sidecar_path};

use crate::cli::arguments::input::InputArgs;
use crate::cli::printing::failure::Failure;
use crate::cli::printing::output::{DASH, OutputArgs};

/// What a command reads and writes, each with what it is to the user.
#[derive(Debug, Default)]
pub struct Files {
    read: Vec<Named>,
    written: Vec<Named>,
}

/// A file and its part in a command.
#[derive(Debug)]
struct Named {
    /// "the motor file", "--json".
    part: String,
    path: PathBuf,
}

impl Files {
    /// Adds a file that is read; `part` says what it is: "the motor file".
    pub fn reads(mut self, part: impl Into<String>, path: &Path) -> Files {
        self.read.push(Named::new(part, path));
        self
    }

    /// Adds a file that may be read.
    pub fn may_read(self, part: &str, path: Option<&PathBuf>) -> Files {
        match path {
            Some(path) => self.reads(part, path),
            None => self,
        }
    }

    /// Adds recordings with what is read beside them: sidecars, the other half of a COMTRADE pair.
    pub fn reads_recordings<'p>(
        mut self,
        paths: impl IntoIterator<Item = &'p PathBuf>,
        input: &InputArgs,
    ) -> Files {
        for path in paths {
            self = self.reads("the recording", path);
            for beside in companions(path) {
                let part = format!("what belongs to {},", path.display());
                self = self.reads(part, &beside);
            }
        }
        self.may_read("the sidecar", input.sidecar())
    }

    /// Adds a file that is written; `part` is the option that names it.
    pub fn writes(mut self, part: impl Into<String>, path: &Path) -> Files {
        self.written.push(Named::new(part, path));
        self
    }

    /// Adds a file that may be written.
    pub fn may_write(self, part: &str, path: Option<&PathBuf>) -> Files {
        match path {
            Some(path) => self.writes(part, path),
            None => self,
        }
    }

    /// Adds a recording that is written, and its sidecar.
    pub fn writes_recording(self, part: &str, path: &Path) -> Files {
        let sidecar = sidecar_path(path);
        self.writes(part, path)
            .writes(format!("the sidecar of {}", path.display()), &sidecar)
    }

    /// Adds the JSON and the page.
    pub fn writes_results(self, output: &OutputArgs) -> Files {
        self.may_write("--json", output.json.file())
            .may_write("--report", output.report.as_ref())
    }

    /// Refuses to go on where something would be lost.
    ///
    /// # Errors
    /// An output that is an input or another output, under whatever name; a sidecar in the place of another kind of file.
    pub fn check(&self) -> Result<(), Failure> {
        self.read_once()?;
        for (k, written) in self.written.iter().enumerate() {
            written.refuse_dash()?;
            written.refuse_missing_folder()?;
            if let Some(read) = self.read.iter().find(|read| read.is(written)) {
                return Err(written.overwrites(read));
            }
            if let Some(other) = self.written[..k].iter().find(|other| other.is(written)) {
                return Err(written.overwrites(other));
            }
        }
        Ok(())
    }

    /// Standard input ends once.
    fn read_once(&self) -> Result<(), Failure> {
        let dashes = self.read.iter().filter(|read| read.is_dash());
        match dashes.count() {
            0 | 1 => Ok(()),
            _ => Err(Failure::Usage(
                "-: standard input is named more than once; name files for the others".to_owned(),
            )),
        }
    }
}

/// Refuses a sidecar in the place of something else.
///
/// # Errors
/// A file that is there and is no sidecar.
pub fn spare_what_is_no_sidecar(recording: &Path) -> Result<(), Failure> {
    let sidecar = sidecar_path(recording);
    if !sidecar.is_file() || Sidecar::read(&sidecar).is_ok() {
        return Ok(());
    }
    Err(Failure::Usage(format!(
        "{}: its sidecar would overwrite {}, which is no sidecar; give the recording another name, or remove that file",
        recording.display(),
        sidecar.display()
    )))
}

impl Named {
    fn new(part: impl Into<String>, path: &Path) -> Named {
        Named {
            part: part.into(),
            path: path.to_owned(),
        }
    }

    fn is_dash(&self) -> bool {
        self.path.as_os_str() == DASH
    }

    fn refuse_dash(&self) -> Result<(), Failure> {
        match self.is_dash() {
            false => Ok(()),
            true => Err(Failure::Usage(format!(
                "{} -: only --json can go to standard output; name a file",
                self.part
            ))),
        }
    }

    /// Told before minutes of work, not after them.
    fn refuse_missing_folder(&self) -> Result<(), Failure> {
        let folder = self
            .path
            .parent()
            .filter(|folder| !folder.as_os_str().is_empty());
        match folder {
            Some(folder) if !folder.is_dir() => Err(Failure::Usage(format!(
                "{}: there is no folder {} for {}; make it, or name another one",
                self.path.display(),
                folder.display(),
                self.part
            ))),
            _ => Ok(()),
        }
    }

    /// Whether both are one file. What is no file, such as a terminal, has nothing to lose.
    fn is(&self, other: &Named) -> bool {
        let device = |path: &Path| path.exists() && !path.is_file();
        !device(&self.path) && identity(&self.path) == identity(&other.path)
    }

    fn overwrites(&self, other: &Named) -> Failure {
        Failure::Usage(format!(
            "{}: {} would overwrite {} {}; give it another name",
            self.path.display(),
            self.part,
            other.part,
            other.path.display()
        ))
    }
}

/// What a path stands for, whatever links and spellings lead there.
#[derive(PartialEq)]
enum Identity {
    /// A file that exists: its device and its number there.
    #[cfg(unix)]
    Number(u64, u64),
    /// A file that exists, as the system spells it, or one that does not exist yet.
    Path(PathBuf),
}

fn identity(path: &Path) -> Identity {
    existing(path).unwrap_or_else(|| Identity::Path(future(path)))
}

#[cfg(unix)]
fn existing(path: &Path) -> Option<Identity> {
    use std::os::unix::fs::MetadataExt;
    let metadata = std::fs::metadata(path).ok()?;
    Some(Identity::Number(metadata.dev(), metadata.ino()))
}

#[cfg(not(unix))]
fn existing(path: &Path) -> Option<Identity> {
    std::fs::canonicalize(path).ok().map(Identity::Path)
}

/// Where a file that does not exist will stand.
fn future(path: &Path) -> PathBuf {
    let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let name = absolute.file_name().map(spelt).unwrap_or_default();
    let folder = absolute.parent().unwrap_or(Path::new(""));
    let folder = std::fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned());
    folder.join(name)
}

/// A name as the usual file systems of this system compare it.
fn spelt(name: &std::ffi::OsStr) -> OsString {
    match cfg!(any(windows, target_os = "macos")) {
        true => name.to_string_lossy().to_lowercase().into(),
        false => name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("files-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        folder
    }

    fn refused(files: Files) -> String {
        match files.check() {
            Ok(()) => String::new(),
            Err(failure) => failure.to_string(),
        }
    }

    #[test]
    fn an_output_is_no_input_under_any_name() {
        let folder = folder("names");
        let input = folder.join("m.toml");
        std::fs::write(&input, "x").expect("written");
        let mut names = vec![input.clone(), folder.join("./m.toml")];
        #[cfg(unix)]
        {
            std::fs::hard_link(&input, folder.join("hard")).expect("linked");
            std::os::unix::fs::symlink(&input, folder.join("soft")).expect("linked");
            std::os::unix::fs::symlink(&folder, folder.join("round")).expect("linked");
            names.extend(["hard", "soft", "round/m.toml"].map(|name| folder.join(name)));
        }
        for name in names {
            let files = Files::default()
                .reads("the motor file", &input)
                .writes("--json", &name);
            let said = refused(files);
            assert!(
                said.contains("--json would overwrite the motor file"),
                "{said}"
            );
        }
        let other = folder.join("m2.toml");
        let files = Files::default().reads("the motor file", &input);
        assert_eq!(refused(files.writes("-o", &other)), "");
        std::fs::remove_dir_all(folder).expect("removed");
    }

    #[test]
    fn two_outputs_are_two_files_before_either_exists() {
        let folder = folder("two");
        let files = Files::default()
            .writes("--json", &folder.join("x"))
            .writes("--report", &folder.join(".").join("x"));
        let said = refused(files);
        assert!(said.contains("--report would overwrite --json"), "{said}");
        let device = Path::new("/dev/null");
        let files = Files::default().writes("--json", device);
        assert_eq!(refused(files.writes("--report", device)), "");
        std::fs::remove_dir_all(folder).expect("removed");
    }

    #[test]
    fn standard_input_is_read_once_and_only_json_goes_to_standard_output() {
        let dash = Path::new("-");
        let files = Files::default().reads("the recording", dash);
        assert_eq!(refused(files.reads("the motor file", Path::new("m"))), "");
        let twice = Files::default().reads("the recording", dash);
        assert!(refused(twice.reads("the recording", dash)).contains("more than once"));
        let page = Files::default().writes("--report", dash);
        assert!(refused(page).contains("only --json"));
    }
}
