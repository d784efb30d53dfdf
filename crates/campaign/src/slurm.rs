//! Work handed to Slurm: ranges of items as an array job.

use std::ops::Range;
use std::path::Path;
use std::time::Instant;

/// Items that tell how long one takes, spread over all.
const TRIALS: u64 = 16;
/// No more trials are made after it, s.
const LONGEST_TRIALS_S: f64 = 20.0;
/// Slurm's own limit of an array, where nobody raised it, is 1001.
const MOST_TASKS: u64 = 1000;

/// How many items of `range` a task of about `task_seconds` gets: what `trial` does with one tells how long it takes.
pub fn items_a_task(task_seconds: f64, range: &Range<u64>, trial: impl FnMut(u64)) -> u64 {
    let total = range.end - range.start;
    let wanted = (task_seconds / seconds_per_item(range, trial)).ceil() as u64;
    wanted.max(total.div_ceil(MOST_TASKS)).clamp(1, total)
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

/// A word as a shell takes it.
pub fn in_shell(word: impl AsRef<Path>) -> String {
    let word = word.as_ref().display().to_string();
    format!("'{}'", word.replace('\'', "'\\''"))
}

#[cfg(test)]
mod tests {
    use std::process::Command;

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
