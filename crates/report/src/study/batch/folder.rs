//! The recordings of a folder in their order, judged in ranges.

use std::fs::File;
use std::hash::Hasher;
use std::io::Read;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use rayon::prelude::*;
use recording::{Flags, Mapping, companions};
use twox_hash::XxHash64;

use super::row::Row;
use super::store::{self, Store, StoreError, part_name, write_rows};
use crate::study::{Job, MapError, MappedMotor, MotorMap};

/// A recording is hashed in pieces of this size, bytes.
const PIECE_BYTES: usize = 1 << 18;

/// Why a folder cannot be judged.
#[derive(Debug, thiserror::Error)]
pub enum BatchError {
    /// Flags that say how recordings are read.
    #[error(transparent)]
    Flags(#[from] recording::Error),
    /// The map, a motor file or the folder.
    #[error(transparent)]
    Map(#[from] MapError),
    /// Rows that cannot be read or kept.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// The recordings of a folder that a map names, sorted by name, each with its motor. A place in this list is a recording's index.
pub struct Batch {
    /// The motors.
    pub map: MotorMap,
    /// The recordings.
    pub jobs: Vec<Job>,
    out: PathBuf,
    mapping: Mapping,
    flags: String,
    /// Fingerprints of rows that were asked for, by index.
    known: Mutex<Vec<Option<String>>>,
}

impl Batch {
    /// Reads a map with its motor files, and lists the recordings in `folder`; `flags` say how recordings are read, `out` is the table.
    ///
    /// # Errors
    /// Everything that is wrong with flags, map or motor files, and an entry of the map that fits no recording.
    pub fn read(folder: &Path, map: &Path, out: &Path, flags: &Flags) -> Result<Batch, BatchError> {
        let mapping = flags.mapping()?;
        let map = MotorMap::read(map)?;
        let jobs = map.jobs(folder, &[out, &store::folder(out)])?;
        Ok(Batch {
            known: Mutex::new(vec![None; jobs.len()]),
            map,
            jobs,
            out: out.to_owned(),
            mapping,
            flags: flags.typed(),
        })
    }

    /// The hash of the list, of motor files, flags and version: the same index is the same recording where it is the same.
    pub fn fingerprint(&self) -> String {
        let mut hash = Fingerprint::new();
        hash.add_texts([&self.flags]);
        for job in &self.jobs {
            let motor = self.motor(job);
            hash.add_texts([&job.name, &motor.name, &motor.text]);
        }
        hash.told()
    }

    /// The rows of `range`, on all cores: from the store, or judged now and kept in it. `done` hears of every row, and whether it was
    /// there already.
    ///
    /// # Errors
    /// Rows that cannot be read or kept.
    pub fn judge(
        &self,
        range: Range<usize>,
        store: &Store,
        done: &(dyn Fn(bool) + Sync),
    ) -> Result<Vec<Row>, StoreError> {
        let one = |k: usize| {
            let (fingerprint, kept) = self.kept(k, store)?;
            if let Some(row) = kept {
                done(true);
                return Ok(row);
            }
            let row = self.row(k, &fingerprint);
            store.keep(&row)?;
            done(false);
            Ok(row)
        };
        range.into_par_iter().map(one).collect()
    }

    /// Writes the table out of `store`: of what it does not hold, rows are judged now. `done` as in [`Batch::judge`].
    ///
    /// # Errors
    /// Rows that cannot be read or kept.
    pub fn finish(
        &self,
        store: &Store,
        done: &(dyn Fn(bool) + Sync),
    ) -> Result<Vec<Row>, StoreError> {
        let rows = self.judge(0..self.jobs.len(), store, done)?;
        store.finish(&rows)?;
        Ok(rows)
    }

    /// Writes one part with the rows of `range` into the folder of rows; a part that holds them already is left as it is. `done` as in
    /// [`Batch::judge`].
    ///
    /// # Errors
    /// Rows that cannot be read or kept.
    pub fn finish_part(
        &self,
        range: Range<usize>,
        done: &(dyn Fn(bool) + Sync),
    ) -> Result<Vec<Row>, StoreError> {
        let name = part_name(&self.fingerprint(), &range);
        let store = self.store()?.with_part(&name)?;
        let rows = self.judge(range, &store, done)?;
        if !store.holds(&name, &rows) {
            store.keep_part(&name, &rows)?;
        }
        Ok(rows)
    }

    /// Judges the recordings of `range`, one after the other on this core, and writes their rows to `path`, whole or not at all.
    /// `done` is called after each.
    ///
    /// # Errors
    /// A path that cannot be written.
    pub fn share(
        &self,
        range: Range<usize>,
        path: &Path,
        done: &mut dyn FnMut(),
    ) -> Result<(), StoreError> {
        let rows = range.map(|k| {
            let row = self.row(k, &self.row_fingerprint(k));
            done();
            row
        });
        let rows: Vec<Row> = rows.collect();
        write_rows(path, &rows)
            .map_err(|error| StoreError::System(path.display().to_string(), error))
    }

    /// Judges one recording and keeps nothing: what it costs can be measured.
    pub fn try_one(&self, k: usize) {
        let fingerprint = self.row_fingerprint(k);
        drop(self.row(k, &fingerprint));
    }

    /// The ranges of recordings that `store` holds no row of; a recording that changed is one of them.
    ///
    /// # Errors
    /// Rows that cannot be read.
    pub fn open(&self, store: &Store) -> Result<Vec<Range<usize>>, StoreError> {
        let all = (0..self.jobs.len()).into_par_iter();
        let kept = all.map(|k| Ok(self.kept(k, store)?.1.is_some()));
        let kept = kept.collect::<Result<Vec<bool>, StoreError>>()?;
        let mut open: Vec<Range<usize>> = Vec::new();
        for k in (0..kept.len()).filter(|k| !kept[*k]) {
            match open.last_mut().filter(|last| last.end == k) {
                Some(last) => last.end = k + 1,
                None => open.push(k..k + 1),
            }
        }
        Ok(open)
    }

    /// A store beside the table.
    ///
    /// # Errors
    /// What [`Store::new`] refuses.
    pub fn store(&self) -> Result<Store, StoreError> {
        Store::new(&self.out)
    }

    fn motor(&self, job: &Job) -> &MappedMotor {
        &self.map.motors[job.motor]
    }

    /// The fingerprint of a row, and the row of an earlier run. What was hashed before is hashed again only where no row fits it.
    fn kept(&self, k: usize, store: &Store) -> Result<(String, Option<Row>), StoreError> {
        if let Some(fingerprint) = self.known(k)
            && let Some(row) = store.kept(&fingerprint)?
        {
            return Ok((fingerprint, Some(row)));
        }
        let fingerprint = self.row_fingerprint(k);
        let row = store.kept(&fingerprint)?;
        if let Ok(mut known) = self.known.lock() {
            known[k] = Some(fingerprint.clone());
        }
        Ok((fingerprint, row))
    }

    fn known(&self, k: usize) -> Option<String> {
        self.known.lock().ok()?[k].clone()
    }

    fn row(&self, k: usize, fingerprint: &str) -> Row {
        let job = &self.jobs[k];
        Row::judged(job, self.motor(job), &self.mapping, fingerprint)
    }

    /// The hash of everything that a row depends on: texts, and files, which count as empty where they are absent.
    fn row_fingerprint(&self, k: usize) -> String {
        let job = &self.jobs[k];
        let motor = self.motor(job);
        let mut hash = Fingerprint::new();
        hash.add_texts([&job.name, &motor.name, &motor.text, &self.flags]);
        let beside = companions(&job.path);
        let read = std::iter::once(&job.path).chain(&beside);
        read.chain(&self.mapping.sidecar)
            .for_each(|path| hash.add_file(path));
        hash.told()
    }
}

/// A hash of texts and files, each with its length, and of the program's version.
struct Fingerprint {
    hash: XxHash64,
}

impl Fingerprint {
    fn new() -> Fingerprint {
        let mut print = Fingerprint {
            hash: XxHash64::with_seed(0),
        };
        print.add(env!("CARGO_PKG_VERSION").as_bytes());
        print
    }

    fn add(&mut self, bytes: &[u8]) {
        self.hash.write_u64(bytes.len() as u64);
        self.hash.write(bytes);
    }

    fn add_texts<const N: usize>(&mut self, texts: [&str; N]) {
        texts.iter().for_each(|text| self.add(text.as_bytes()));
    }

    /// A file that cannot be read counts as empty: its row says so.
    fn add_file(&mut self, path: &Path) {
        let Ok(mut file) = File::open(path) else {
            return self.add(&[]);
        };
        let length = file.metadata().map_or(0, |about| about.len());
        self.hash.write_u64(length);
        let mut piece = vec![0; PIECE_BYTES];
        while let Ok(read @ 1..) = file.read(&mut piece) {
            self.hash.write(&piece[..read]);
        }
    }

    fn told(&self) -> String {
        format!("{:016x}", self.hash.finish())
    }
}
