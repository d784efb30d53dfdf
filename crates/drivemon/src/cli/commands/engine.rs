//! Work on more than one machine: Ray through the Python package, and a script for Slurm.

use std::ffi::OsStr;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use clap::{Args, ValueEnum};

use crate::cli::printing::failure::Failure;

/// What does the work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Engine {
    /// All cores of this machine
    Here,
    /// Tasks of Ray (pip install drivemon ray); a lost task is made again
    Ray,
    /// Does nothing, but prints a script that hands the work to Slurm as an array job
    Slurm,
}

/// Where the work is done.
#[derive(Debug, Args)]
pub struct EngineArgs {
    /// What does the work; the result has the same bytes
    #[arg(long, value_enum, default_value = "here")]
    pub engine: Engine,
    /// With --engine ray: a Ray cluster, or `auto` for the one that this machine belongs to; without it Ray starts here
    #[arg(long, value_name = "ADDRESS")]
    address: Option<String>,
    /// Time that a task of Ray or Slurm takes, s
    #[arg(long, value_name = "S", default_value_t = 60.0, value_parser = task_seconds)]
    task_seconds: f64,
}

/// Below it the start of a task counts.
const SHORTEST_TASK_S: f64 = 10.0;
/// Items that tell how long one takes, spread over all.
const TRIALS: u64 = 16;
/// No more trials are made after it, s.
const LONGEST_TRIALS_S: f64 = 20.0;
/// Slurm's own limit of an array, where nobody raised it, is 1001.
const MOST_TASKS: u64 = 1000;

fn task_seconds(text: &str) -> Result<f64, String> {
    let number: Option<f64> = text.parse().ok();
    number
        .filter(|s| (SHORTEST_TASK_S..=86_400.0).contains(s))
        .ok_or_else(|| format!("write a time of {SHORTEST_TASK_S} to 86400 s"))
}

impl EngineArgs {
    /// Does the work with Ray, by a module of the Python package; the exit code that it ends with, 0 or 1, comes back.
    ///
    /// # Errors
    /// Python or one of the packages is missing, or the work could not be done.
    pub fn ray<W: AsRef<OsStr>>(&self, module: &str, words: &[W]) -> Result<i32, Failure> {
        let python = std::env::var_os("DRIVEMON_PYTHON").unwrap_or_else(|| "python3".into());
        // Whether Ray is there; its import takes more than half a second.
        let asks = format!(
            "import {module}, importlib.util, sys; sys.exit(importlib.util.find_spec('ray') is None)"
        );
        let has = Command::new(&python).args(["-c", &asks]).output();
        if !has.as_ref().is_ok_and(|has| has.status.success()) {
            return Err(Failure::Usage(format!(
                "--engine ray: {} does not have the packages drivemon and ray: install them (docs/python.md), or name another \
                 Python in DRIVEMON_PYTHON",
                python.display()
            )));
        }
        let mut command = Command::new(&python);
        command.args(["-m", module]).args(words);
        command.args(["--task-seconds", &self.task_seconds.to_string()]);
        if let Some(address) = &self.address {
            command.args(["--address", address]);
        }
        let ended = command.status().ok().and_then(|status| status.code());
        ended.filter(|code| [0, 1].contains(code)).ok_or_else(|| {
            Failure::Usage(
                "--engine ray: the work was not all done; the same command goes on where it was"
                    .to_owned(),
            )
        })
    }

    /// How many items of `range` a task of Slurm gets: what `trial` does with one tells how long it takes.
    pub fn items_a_task(&self, range: &Range<u64>, trial: impl FnMut(u64)) -> u64 {
        let total = range.end - range.start;
        let wanted = (self.task_seconds / seconds_per_item(range, trial)).ceil() as u64;
        wanted.max(total.div_ceil(MOST_TASKS)).clamp(1, total)
    }
}

/// Time of an item on one core, s.
fn seconds_per_item(range: &Range<u64>, mut trial: impl FnMut(u64)) -> f64 {
    let total = range.end - range.start;
    let trials = TRIALS.min(total);
    let begin = Instant::now();
    let mut made = 0;
    while made < trials && begin.elapsed().as_secs_f64() < LONGEST_TRIALS_S {
        trial(range.start + made * total / trials);
        made += 1;
    }
    begin.elapsed().as_secs_f64().max(1e-6) / made.max(1) as f64
}

/// An array job of Slurm, and the job that puts together what its tasks made.
pub struct Array {
    /// What the items are: "Runs 0..40 of a campaign".
    pub title: String,
    /// The items.
    pub range: Range<u64>,
    /// Items in a task.
    pub items: u64,
    /// Where tasks write, as a shell takes it.
    pub folder: String,
    /// Lines of a task; `$from` and `$to` are its first item and the one after its last.
    pub task: String,
    /// Lines of the job that runs when all tasks are done.
    pub merge: String,
}

impl Array {
    /// The script that hands it in.
    pub fn script(&self) -> String {
        let Range { start, end } = self.range;
        let last = (end - start).div_ceil(self.items) - 1;
        let Array {
            title,
            items,
            folder,
            task,
            merge,
            ..
        } = self;
        format!(
            "\
#!/usr/bin/env bash
# {title} as an array job of Slurm, {items} to a task: bash SCRIPT hands it in. Each machine sees program, inputs
# and result at the same path. A task that is started again goes on where it was; one that ran twice changes nothing.
set -euo pipefail
folder={folder}
mkdir -p \"$folder\"
array=$(sbatch --parsable --job-name=drivemon --array=0-{last} --cpus-per-task=1 --requeue --output=\"$folder/%a.log\" <<'TASK'
#!/usr/bin/env bash
export RAYON_NUM_THREADS=1
from=$(({start} + SLURM_ARRAY_TASK_ID * {items}))
to=$((from + {items} < {end} ? from + {items} : {end}))
{task}
TASK
)
sbatch --job-name=drivemon-merge --dependency=afterok:$array --kill-on-invalid-dep=yes --output=\"$folder/merge.log\" <<'MERGE'
#!/usr/bin/env bash
{merge}
MERGE"
        )
    }
}

/// This program, as a shell takes it.
///
/// # Errors
/// A program that does not know where it is.
pub fn program() -> Result<String, Failure> {
    let path = std::env::current_exe().map_err(|error| Failure::Usage(error.to_string()))?;
    Ok(in_shell(&path))
}

/// A path that is the same from everywhere.
///
/// # Errors
/// An empty path.
pub fn absolute(path: &Path) -> Result<PathBuf, Failure> {
    std::path::absolute(path)
        .map_err(|error| Failure::Usage(format!("{}: {error}", path.display())))
}

/// A word as a shell takes it.
pub fn in_shell(word: impl AsRef<Path>) -> String {
    let word = word.as_ref().display().to_string();
    format!("'{}'", word.replace('\'', "'\\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shell_takes_any_path_back() {
        let path = Path::new("/a b/it's $HOME.toml");
        let told = Command::new("sh")
            .arg("-c")
            .arg(format!("printf %s {}", in_shell(path)))
            .output();
        assert_eq!(
            told.expect("a shell").stdout,
            path.display().to_string().into_bytes()
        );
    }

    #[test]
    fn the_tasks_of_an_array_cover_the_range_once() {
        let array = Array {
            title: String::new(),
            range: 5..50,
            items: 16,
            folder: "/x".to_owned(),
            task: "echo $from $to".to_owned(),
            merge: String::new(),
        };
        let script = array.script();
        assert!(script.contains("--array=0-2 "), "{script}");
        let task = script.split("<<'TASK'\n").nth(1).expect("a task");
        let task = task.split("\nTASK").next().expect("its end");
        let told = |id: u32| {
            let ran = Command::new("bash")
                .args(["-c", task])
                .env("SLURM_ARRAY_TASK_ID", id.to_string())
                .output();
            String::from_utf8(ran.expect("bash").stdout).expect("text")
        };
        assert_eq!([0, 1, 2].map(told), ["5 21\n", "21 37\n", "37 50\n"]);
    }
}
