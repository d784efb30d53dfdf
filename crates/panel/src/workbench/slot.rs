//! One recording on the desk: its file, how it is read, what became of it.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use audit::Audit;
use formats::{Preview, preview, read_any, with_most_numbers};
use recording::{Mapping, Source, TableColumn};
use replay::check::BlindSpot;
use serde::Serialize;

use super::mapping::Columns;
use super::upload::Stored;

/// Rows of a preview.
const ROWS: usize = 6;

/// A file on the desk.
#[derive(Clone, Debug)]
pub(super) struct Slot {
    /// Another number for each file that is put on the desk.
    pub id: u64,
    /// Where it lies.
    pub file: Arc<Stored>,
    /// Where its sidecar lies.
    pub sidecar: Option<PathBuf>,
    /// How its columns are read.
    pub columns: Columns,
    /// What it holds; `None` where it cannot be read.
    pub source: Option<Arc<Source>>,
    /// What the page shows.
    pub view: SlotView,
}

/// What the page shows of a file.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct SlotView {
    /// The number of the file: what is asked about it must say which one is meant.
    pub id: u64,
    /// Name of the file.
    pub name: String,
    /// Name of its sidecar.
    pub sidecar: Option<String>,
    /// Its first rows.
    pub preview: Option<Preview>,
    /// How its columns are read, beyond what they and the sidecar say themselves.
    pub columns: Columns,
    /// What the reader objects to: file, line, column, remedy.
    pub problem: Option<String>,
    /// What it holds.
    pub summary: Option<Summary>,
    /// What the audit found.
    pub audit: Option<Audit>,
    /// What the channels that are missing leave dark.
    pub blind: Option<Vec<BlindSpot>>,
    /// Time that reading took, s.
    pub read_s: f64,
}

/// What a file holds.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub(super) enum Summary {
    /// Samples over time.
    Recording {
        /// Samples of each channel.
        samples: usize,
        /// Their rate, Hz.
        sample_rate_hz: f64,
        /// Length, s.
        duration_s: f64,
        /// Names of the channels.
        channels: Vec<String>,
        /// What had to be assumed.
        notes: Vec<String>,
    },
    /// Operating points.
    LoadTable {
        /// Their number.
        points: usize,
        /// Names of the columns.
        columns: Vec<String>,
    },
}

impl Slot {
    /// A file that has not been read yet.
    pub fn new(id: u64, file: Stored) -> Slot {
        let name = file_name(&file.path);
        Slot {
            id,
            file: Arc::new(file),
            sidecar: None,
            columns: Columns::default(),
            source: None,
            view: SlotView {
                id,
                name,
                ..SlotView::default()
            },
        }
    }

    /// Numbers that it holds in memory.
    pub fn numbers(&self) -> u64 {
        match self.source.as_deref() {
            Some(Source::Recording(recording)) => {
                (recording.len() * (1 + recording.channels().count())) as u64
            }
            Some(Source::LoadTable(_)) | None => 0,
        }
    }

    /// Reads the file as it now is to be read, if it holds at most so many numbers; it is audited on the desk.
    pub fn read(mut self, most_numbers: u64) -> Slot {
        let begin = Instant::now();
        let mapping = self.columns.mapping().map(|mapping| Mapping {
            sidecar: self.sidecar.clone(),
            ..mapping
        });
        let read = mapping.clone().and_then(|mapping| {
            with_most_numbers(most_numbers, || {
                read_any(&self.file.path, &mapping, &mut |_| {})
            })
        });
        let shown = preview(&self.file.path, &mapping.unwrap_or_default(), ROWS).ok();
        let folders = [Some(&self.file.path), self.sidecar.as_ref()];
        let plainly = |error: recording::Error| without_folders(&error.to_string(), folders);
        let (source, problem) = match read {
            Ok(source) => (Some(source), None),
            Err(error) => (None, Some(plainly(error))),
        };
        self.view = SlotView {
            id: self.id,
            name: file_name(&self.file.path),
            sidecar: self.sidecar.as_deref().map(file_name),
            preview: shown,
            columns: self.columns.clone(),
            problem,
            summary: source.as_ref().map(Summary::of),
            audit: None,
            blind: None,
            read_s: begin.elapsed().as_secs_f64(),
        };
        self.source = source.map(Arc::new);
        self
    }
}

fn file_name(path: &Path) -> String {
    path.file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

/// A message without the folder in which uploaded files happen to lie.
fn without_folders(text: &str, paths: [Option<&PathBuf>; 2]) -> String {
    let folders = paths.into_iter().flatten().filter_map(|path| path.parent());
    folders.fold(text.to_owned(), |text, folder| {
        text.replace(&format!("{}/", folder.display()), "")
    })
}

impl Summary {
    fn of(source: &Source) -> Summary {
        match source {
            Source::Recording(recording) => Summary::Recording {
                samples: recording.len(),
                sample_rate_hz: 1.0 / recording.t_sample(),
                duration_s: recording.duration(),
                channels: recording
                    .channels()
                    .map(|(channel, _)| channel.to_string())
                    .collect(),
                notes: recording.assumptions.clone(),
            },
            Source::LoadTable(table) => Summary::LoadTable {
                points: table.len(),
                columns: TableColumn::ALL
                    .into_iter()
                    .filter(|column| table.column(*column).is_some())
                    .map(|column| column.name().to_owned())
                    .collect(),
            },
        }
    }
}
