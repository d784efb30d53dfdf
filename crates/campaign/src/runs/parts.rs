//! Running a campaign on all cores, in parts that survive a crash.

use std::ops::Range;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use crate::planned::plan::Plan;
use crate::runs::file::{About, Results, StoreError, beside};
use crate::runs::row::Row;
use crate::runs::run::Run;

/// Runs in one part: what a crash can cost each core.
const PART: u64 = 16;

/// A finished range.
#[derive(Clone, Debug)]
pub struct Done {
    /// Its rows.
    pub results: Results,
    /// How many of them an earlier call had made.
    pub there_already: u64,
}

/// Makes the runs of `range` and writes them to `output`; parts that are there already are not made again. `done` hears
/// of every finished run, by how many.
///
/// Parts stand in a folder beside `output` until all are there. A part is written under another name and renamed, so
/// that it is whole or absent.
///
/// # Errors
/// Files that cannot be written, or results of another campaign in the way.
pub fn run(
    plan: &Plan,
    range: Range<u64>,
    output: &Path,
    done: &(impl Fn(u64) + Sync),
) -> Result<Done, StoreError> {
    let about = About::of(plan);
    if let Some(results) = finished(plan, &range, output)? {
        let there_already = range.end - range.start;
        done(there_already);
        return Ok(Done {
            results,
            there_already,
        });
    }
    let folder = beside(output, "parts");
    std::fs::create_dir_all(&folder)
        .map_err(|error| StoreError::System(folder.display().to_string(), error))?;
    let parts = parts(&range);
    refuse_strangers(&folder, &parts)?;
    let finished = parts.iter().filter(|part| folder.join(name(part)).exists());
    let there_already = finished.map(|part| part.end - part.start).sum();
    let results: Vec<(PathBuf, Results)> = parts
        .into_par_iter()
        .map(|part| {
            let path = folder.join(name(&part));
            let results = part_of(plan, &about, &part, &path, done)?;
            Ok((path, results))
        })
        .collect::<Result<_, StoreError>>()?;
    let all = Results::merge(results)?;
    all.write(output)?;
    // What is left over is no error: the results stand.
    let _ = std::fs::remove_dir_all(&folder);
    Ok(Done {
        results: all,
        there_already,
    })
}

/// The results of `range` that `output` holds already; `None` without that file.
///
/// # Errors
/// Anything else in the way: another campaign, or other runs of this one.
pub fn finished(
    plan: &Plan,
    range: &Range<u64>,
    output: &Path,
) -> Result<Option<Results>, StoreError> {
    if !output.exists() {
        return Ok(None);
    }
    let results = Results::read(output)?;
    results.expect(&About::of(plan), output)?;
    let indices = results.rows.iter().map(|row| row.index);
    if indices.eq(range.clone()) {
        return Ok(Some(results));
    }
    Err(StoreError::Conflict(format!(
        "{}: holds other runs of this campaign than {}..{}: give these another name, and `drivemon campaign merge` them",
        output.display(),
        range.start,
        range.end
    )))
}

/// Parts begin at multiples of their length.
fn parts(range: &Range<u64>) -> Vec<Range<u64>> {
    let (first, last) = (range.start / PART, range.end.div_ceil(PART));
    let part = |k: u64| (k * PART).max(range.start)..((k + 1) * PART).min(range.end);
    (first..last)
        .map(part)
        .filter(|part| !part.is_empty())
        .collect()
}

fn name(part: &Range<u64>) -> String {
    format!("{:09}-{:09}.parquet", part.start, part.end)
}

/// Parts of another range would be lost when this one is complete.
fn refuse_strangers(folder: &Path, parts: &[Range<u64>]) -> Result<(), StoreError> {
    let known: Vec<String> = parts.iter().map(name).collect();
    let entries = std::fs::read_dir(folder)
        .map_err(|error| StoreError::System(folder.display().to_string(), error))?;
    let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let stranger = names
        .filter(|name| name.ends_with(".parquet"))
        .find(|name| known.binary_search(name).is_err());
    match stranger {
        None => Ok(()),
        Some(name) => Err(StoreError::Conflict(format!(
            "{}: holds runs outside this range ({name}): finish that range first, remove the folder, or give these \
             results another name",
            folder.display()
        ))),
    }
}

fn part_of(
    plan: &Plan,
    about: &About,
    part: &Range<u64>,
    path: &Path,
    done: &(impl Fn(u64) + Sync),
) -> Result<Results, StoreError> {
    if path.exists() {
        let results = Results::read(path)?;
        results.expect(about, path)?;
        done(part.end - part.start);
        return Ok(results);
    }
    let results = share(plan, part.clone(), &mut || done(1));
    results.write(path)?;
    Ok(results)
}

/// Makes the runs of `range`, one after the other on this core. `done` is called after each.
pub fn share(plan: &Plan, range: Range<u64>, done: &mut dyn FnMut()) -> Results {
    let runs = range.filter_map(|index| Run::new(plan, index));
    let rows = runs.map(|run| {
        let row = Row::of(&run);
        done();
        row
    });
    Results {
        about: About::of(plan),
        rows: rows.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_cover_the_range_once_and_begin_at_multiples() {
        let parts = parts(&(5..50));
        assert_eq!(parts, [5..16, 16..32, 32..48, 48..50]);
        assert!(super::parts(&(7..7)).is_empty());
    }
}
