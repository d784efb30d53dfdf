//! Which motor file belongs to which recordings.

use std::path::{Path, PathBuf};

use document::{Document, Section, read_text};
use glob::{MatchOptions, Pattern};
use motor::MotorFile;

use super::effects_fit;

/// Why a map cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum MapError {
    /// The map or a motor file.
    #[error(transparent)]
    File(#[from] document::FileError),
    /// A folder, an entry, or effects that do not go together.
    #[error("{0}")]
    Entry(String),
}

/// Names that recordings end with.
const ENDS: [&str; 11] = [
    ".csv", ".csv.gz", ".txt", ".tsv", ".parquet", ".mat", ".cfg", ".cff", ".wav", ".xlsx", ".xlsm",
];
/// `*` does not reach into folders.
const WITHIN: MatchOptions = MatchOptions {
    case_sensitive: true,
    require_literal_separator: true,
    require_literal_leading_dot: false,
};

/// A map, with its motor files.
pub struct MotorMap {
    label: String,
    /// In the order of the map.
    pub motors: Vec<MappedMotor>,
}

/// One entry.
pub struct MappedMotor {
    pattern: Pattern,
    /// The motor file as the map names it.
    pub name: String,
    /// Where it is.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
    /// What it says.
    pub file: MotorFile,
}

/// One recording to judge.
pub struct Job {
    /// Its path seen from the folder, with `/` between folders.
    pub name: String,
    /// Its path.
    pub path: PathBuf,
    /// Its motor's place in the map.
    pub motor: usize,
}

impl MotorMap {
    /// Reads a map and the motor files that it names.
    ///
    /// # Errors
    /// Everything that is wrong with the map, or with the first motor file that is wrong.
    pub fn read(path: &Path) -> Result<MotorMap, MapError> {
        let label = path.display().to_string();
        let document = Document::parse(&read_text(path)?, &label)?;
        let entries = entries(&document);
        let entries = document.finish(entries)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let motor = |(pattern, name): (Pattern, String)| {
            let path = folder.join(&name);
            let text = read_text(&path)?;
            let label = path.display().to_string();
            let file = MotorFile::parse(&text, &label)?;
            effects_fit(&label, &file).map_err(MapError::Entry)?;
            Ok(MappedMotor {
                pattern,
                name,
                path,
                text,
                file,
            })
        };
        let motors = entries.into_iter().map(motor);
        let motors = motors.collect::<Result<Vec<_>, MapError>>()?;
        Ok(MotorMap { label, motors })
    }

    /// The recordings of a folder that the map names, by name; what is `written` there, files and folders, is none of them.
    ///
    /// # Errors
    /// A folder that cannot be read, or an entry that fits nothing.
    pub fn jobs(&self, folder: &Path, written: &[&Path]) -> Result<Vec<Job>, MapError> {
        let mut files = Vec::new();
        collect(folder, "", &mut files).map_err(|(path, error)| {
            MapError::Entry(format!(
                "{}: cannot be read: {error}; name a folder with recordings",
                path.display()
            ))
        })?;
        let is_written = |path: &Path| written.iter().any(|out| path.starts_with(out));
        files.retain(|(name, path)| !is_written(path) && is_recording(name));
        files.sort();
        let job = |(name, path): (String, PathBuf)| {
            let fits = |motor: &MappedMotor| motor.pattern.matches_with(&name, WITHIN);
            let motor = self.motors.iter().position(fits)?;
            Some(Job { name, path, motor })
        };
        let jobs: Vec<Job> = files.into_iter().filter_map(job).collect();
        let idle = |k: &usize| jobs.iter().all(|job| job.motor != *k);
        match (0..self.motors.len()).find(idle) {
            None => Ok(jobs),
            Some(k) => Err(MapError::Entry(format!(
                "{}: motors[{}].recordings: \"{}\" fits no recording in {} that an earlier entry leaves; paths are seen from \
                 that folder, ** is any folders",
                self.label,
                k + 1,
                self.motors[k].pattern,
                folder.display()
            ))),
        }
    }
}

fn entries(document: &Document) -> Option<Vec<(Pattern, String)>> {
    let root = document.root();
    let sections = root.sections("motors")?;
    if sections.is_empty() {
        root.report(
            "motors",
            "is missing: add [[motors]] with recordings and motor",
        );
    }
    let entries: Vec<Option<(Pattern, String)>> = sections.into_iter().map(entry).collect();
    root.finish();
    entries.into_iter().collect()
}

fn entry(section: Section<'_>) -> Option<(Pattern, String)> {
    let recordings = section.text("recordings", "a pattern of paths, \"pump-3/*.csv\"");
    let motor = section.text("motor", "the path of a motor file, seen from the map");
    let pattern = recordings.and_then(|text| match Pattern::new(&text) {
        Ok(pattern) => Some(pattern),
        Err(error) => {
            let message = format!(
                "is no pattern ({error}): write * for any part of a name, ** for any folders"
            );
            section.report("recordings", message);
            None
        }
    });
    section.finish();
    Some((pattern?, motor?))
}

/// Files below a folder, with their paths seen from where it begins; links to folders are not followed.
fn collect(
    folder: &Path,
    prefix: &str,
    files: &mut Vec<(String, PathBuf)>,
) -> Result<(), (PathBuf, std::io::Error)> {
    let wrong = |error| (folder.to_owned(), error);
    for entry in std::fs::read_dir(folder).map_err(wrong)? {
        let entry = entry.map_err(wrong)?;
        let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
        match entry.file_type().map_err(wrong)?.is_dir() {
            true => collect(&entry.path(), &format!("{name}/"), files)?,
            false => files.push((name, entry.path())),
        }
    }
    Ok(())
}

fn is_recording(name: &str) -> bool {
    let name = name.to_lowercase();
    ENDS.iter().any(|end| name.ends_with(end))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(text: &str) -> String {
        let document = Document::parse(text, "map.toml").expect("TOML");
        let entries = entries(&document);
        let error = document.finish(entries).expect_err("wrong");
        error.to_string()
    }

    #[test]
    fn what_is_wrong_with_a_map_is_named_by_line_and_key() {
        assert!(told("x = 1\n").contains("motors"));
        let told = told(
            "[[motors]]\nrecordings = \"a/***\"\nmotor = \"m.toml\"\n\n[[motors]]\nrecording = \"*\"\nmotor = 3\n",
        );
        assert!(
            told.contains("map.toml:2: motors[1].recordings: is no pattern"),
            "{told}"
        );
        assert!(told.contains("map.toml:7: motors[2].motor"), "{told}");
    }

    #[test]
    fn a_star_stays_in_its_folder() {
        let fits = |pattern: &str, name: &str| {
            let pattern = Pattern::new(pattern).expect("a pattern");
            pattern.matches_with(name, WITHIN)
        };
        assert!(fits("*.csv", "a.csv") && !fits("*.csv", "p/a.csv"));
        assert!(fits("**/*.csv", "a.csv") && fits("**/*.csv", "p/q/a.csv"));
        assert!(fits("p/**/a.csv", "p/a.csv") && fits("p/**/a.csv", "p/q/a.csv"));
    }

    #[test]
    fn recordings_are_told_by_their_ends() {
        let names = [
            "a.csv",
            "A.CSV.gz",
            "a.toml",
            "a.dat",
            "a.parquet.parts",
            "a.json",
        ];
        let kept: Vec<&str> = names
            .into_iter()
            .filter(|name| is_recording(name))
            .collect();
        assert_eq!(kept, ["a.csv", "A.CSV.gz"]);
    }
}
