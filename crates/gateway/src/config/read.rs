//! The whole file.

use std::path::{Path, PathBuf};

use document::{Bounds, Document, FileError, Section, read_text};
use fleet::Limits;

use super::{Config, Patience, alarms, links, motors};

const LOST_AFTER_S: Bounds = Bounds::between(2.0, 3_600.0, "s");
const RETRY_MOST_S: Bounds = Bounds::between(1.0, 3_600.0, "s");
const SIZE_GB: Bounds = Bounds::between(0.016, 100_000.0, "GB");
const DAYS: Bounds = Bounds::between(1.0, 36_500.0, "days");
const QUEUE_SECONDS: Bounds = Bounds::between(10_000.0, 4e9, "seconds of all motors");

impl Config {
    /// Reads a file. `outputs` reads from its top level what is handed on, and to whom: that is known to those who do it.
    ///
    /// # Errors
    /// Everything that is wrong with the file, with line, key and remedy.
    pub fn read<T>(
        path: &Path,
        outputs: impl FnOnce(&Section<'_>) -> Option<T>,
    ) -> Result<(Config, T), FileError> {
        let text = read_text(path)?;
        Config::parse(&text, path, outputs)
    }

    /// As [`Config::read`], from text; `path` is what errors name, and where relative paths begin.
    ///
    /// # Errors
    /// As [`Config::read`].
    pub fn parse<T>(
        text: &str,
        path: &Path,
        outputs: impl FnOnce(&Section<'_>) -> Option<T>,
    ) -> Result<(Config, T), FileError> {
        let document = Document::parse(text, &path.display().to_string())?;
        let root = document.root();
        let config = of_root(&root, path);
        let outputs = outputs(&root);
        root.finish();
        document.finish(config.zip(outputs))
    }

    /// The store that a path means: the path itself, or the one of a configuration (a file `*.toml`). Nothing else of the
    /// configuration is checked.
    ///
    /// # Errors
    /// The configuration cannot be read, or names no store.
    pub fn store_of(path: &Path) -> Result<PathBuf, FileError> {
        if path.extension().is_none_or(|extension| extension != "toml") {
            return Ok(path.to_owned());
        }
        let document = Document::parse(&read_text(path)?, &path.display().to_string())?;
        let file = stored_at(&document.root());
        let folder = folder_of(path);
        document.finish(file.map(|file| folder.join(file)))
    }

    /// For a gateway that hands nothing on.
    pub fn no_outputs(_: &Section<'_>) -> Option<()> {
        Some(())
    }
}

/// The file of `[store]`; the other sections are not read, so that what is missing must be told here.
fn stored_at(root: &Section<'_>) -> Option<String> {
    const MEANING: &str = "the file in which everything is kept";
    let section = root.optional_section("store")?;
    let Some(section) = section.filter(|section| section.has("path")) else {
        root.report(
            "store.path",
            format!("is missing, {MEANING}: give the configuration that drivemon gateway takes"),
        );
        return None;
    };
    section.text("path", MEANING)
}

fn of_root(root: &Section<'_>, path: &Path) -> Option<Config> {
    let patience = patience(root);
    let store = store(root, path);
    let alarms = alarms::read(root);
    let links = links::read(root);
    let motors = motors::read(root, links.as_deref().unwrap_or_default(), folder_of(path));
    let (store, limits) = store?;
    Some(Config {
        patience: patience?,
        store,
        limits,
        alarms: alarms?,
        links: links?,
        motors: motors?,
    })
}

fn patience(root: &Section<'_>) -> Option<Patience> {
    let section = root.optional_section("gateway")?;
    let number = |key, bounds, default| match &section {
        Some(section) => section.number_or(key, bounds, default),
        None => Some(default),
    };
    let lost_after = number("lost_after_s", &LOST_AFTER_S, 10.0);
    let retry_most = number("retry_most_s", &RETRY_MOST_S, 30.0);
    if let Some(section) = section {
        section.finish();
    }
    Some(Patience {
        lost_after: links::duration(lost_after?),
        retry_most: links::duration(retry_most?),
    })
}

fn store(root: &Section<'_>, path: &Path) -> Option<(PathBuf, Limits)> {
    let section = root.section("store", "which says where everything is kept")?;
    let file = section.text("path", "the file in which everything is kept");
    let limits = limits(&section);
    let checked = limits.and_then(|limits| match limits.check() {
        Ok(()) => Some(limits),
        Err(error) => {
            section.report("", error.to_string());
            None
        }
    });
    section.finish();
    let folder = folder_of(path);
    Some((folder.join(file?), checked?))
}

/// Where relative paths begin.
fn folder_of(config: &Path) -> &Path {
    config.parent().unwrap_or(Path::new(""))
}

fn limits(section: &Section<'_>) -> Option<Limits> {
    let usual = Limits::default();
    let size = section.number_or("size_gb", &SIZE_GB, usual.bytes as f64 / 1e9);
    let days = |key, default| section.integer_or(key, &DAYS, default);
    let seconds = days("seconds_days", usual.seconds_days);
    let minutes = days("minutes_days", usual.minutes_days);
    let hours = days("hours_days", usual.hours_days);
    let recordings = days("recordings_days", usual.recordings_days);
    let queue = section.number_or("queue_seconds", &QUEUE_SECONDS, usual.queue_seconds as f64);
    Some(Limits {
        bytes: (size? * 1e9) as u64,
        seconds_days: seconds?,
        minutes_days: minutes?,
        hours_days: hours?,
        recordings_days: recordings?,
        queue_seconds: queue? as u64,
    })
}
