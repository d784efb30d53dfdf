//! The library of a functional mock-up unit, by the compiler of this computer.

use std::path::PathBuf;
use std::process::Command;

/// A library and where it lies in the archive.
pub struct Library {
    /// Path within the archive.
    pub path: String,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

/// Compiles sources, each with its name; why not, where that fails.
///
/// The compiler is `$CC`, or `cc`.
///
/// # Errors
/// No compiler, a system without a name in the standard, or what the compiler said.
pub fn library(name: &str, sources: &[(String, String)]) -> Result<Library, String> {
    let (folder, ending) = platform().ok_or("this system has no name in FMI 2.0")?;
    let work = Scratch::new(name)?;
    for (file, text) in sources {
        std::fs::write(work.0.join(file), text).map_err(|error| error.to_string())?;
    }
    let output = work.0.join(format!("{name}.{ending}"));
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".to_owned());
    let units = sources
        .iter()
        .map(|(file, _)| file)
        .filter(|file| file.ends_with(".c"));
    let made = Command::new(&compiler)
        .current_dir(&work.0)
        .args([
            "-O2",
            "-std=c99",
            "-shared",
            "-fPIC",
            "-fvisibility=hidden",
            "-o",
        ])
        .arg(&output)
        .args(units)
        .arg("-lm")
        .output()
        .map_err(|error| format!("{compiler}: {error}"))?;
    if !made.status.success() {
        let said = String::from_utf8_lossy(&made.stderr);
        let first = said
            .lines()
            .find(|line| line.contains("error"))
            .unwrap_or("it failed");
        return Err(format!("{compiler}: {first}"));
    }
    let bytes = std::fs::read(&output).map_err(|error| error.to_string())?;
    Ok(Library {
        path: format!("binaries/{folder}/{name}.{ending}"),
        bytes,
    })
}

/// The folder of this system in the standard, and how libraries end.
fn platform() -> Option<(&'static str, &'static str)> {
    match (std::env::consts::OS, std::env::consts::ARCH) {
        ("linux", "x86_64") => Some(("linux64", "so")),
        ("linux", "x86") => Some(("linux32", "so")),
        ("macos", "x86_64") => Some(("darwin64", "dylib")),
        ("windows", "x86_64") => Some(("win64", "dll")),
        _ => None,
    }
}

/// A folder that goes when it is no longer needed.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Result<Scratch, String> {
        let folder = format!("drivemon-export-{}-{name}", std::process::id());
        let path = std::env::temp_dir().join(folder);
        std::fs::create_dir_all(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(Scratch(path))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // What cannot be removed stays in the folder for temporary files.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
