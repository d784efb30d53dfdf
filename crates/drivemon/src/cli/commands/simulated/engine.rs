//! Campaigns on more than one machine: Ray through the Python package, and a script for Slurm.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use clap::{Args, ValueEnum};

use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::terminal::say;
use campaign::{Plan, share};

/// What makes the runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Engine {
    /// All cores of this machine
    Here,
    /// Tasks of Ray (pip install drivemon ray); a lost task is made again
    Ray,
    /// Makes nothing, but prints a script that hands the runs to Slurm as an array job
    Slurm,
}

/// Where runs are made.
#[derive(Debug, Args)]
pub struct EngineArgs {
    /// What makes the runs; the result has the same bytes
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
/// Runs that tell how long one takes, spread over all.
const TRIALS: u64 = 16;
/// Slurm's own limit of an array, where nobody raised it, is 1001.
const MOST_TASKS: u64 = 1000;

fn task_seconds(text: &str) -> Result<f64, String> {
    let number: Option<f64> = text.parse().ok();
    number
        .filter(|s| (SHORTEST_TASK_S..=86_400.0).contains(s))
        .ok_or_else(|| format!("write a time of {SHORTEST_TASK_S} to 86400 s"))
}

impl EngineArgs {
    /// Makes the runs with Ray.
    ///
    /// # Errors
    /// Python or one of the packages is missing, or the runs could not be made.
    pub fn ray(&self, plan: &Path, range: &Range<u64>, output: &Path) -> Result<Finding, Failure> {
        let python = std::env::var_os("DRIVEMON_PYTHON").unwrap_or_else(|| "python3".into());
        let imports = ["-c", "import drivemon.campaign, ray"];
        let has = Command::new(&python).args(imports).output();
        if !has.as_ref().is_ok_and(|has| has.status.success()) {
            return Err(Failure::Usage(format!(
                "--engine ray: {} does not have the packages drivemon and ray: install them (docs/python.md), or name another \
                 Python in DRIVEMON_PYTHON",
                python.display()
            )));
        }
        let mut command = Command::new(&python);
        command.args(["-m", "drivemon.campaign"]).arg(plan);
        command.arg("-o").arg(output);
        command.args(["--from", &range.start.to_string()]);
        command.args(["--to", &range.end.to_string()]);
        command.args(["--task-seconds", &self.task_seconds.to_string()]);
        if let Some(address) = &self.address {
            command.args(["--address", address]);
        }
        let ended = command.status();
        match ended.as_ref().map(|status| status.code()) {
            Ok(Some(0)) => Ok(Finding::Nothing),
            Ok(Some(1)) => Ok(Finding::Something),
            _ => Err(Failure::Usage(
                "--engine ray: the runs were not all made; the same command goes on where it was"
                    .to_owned(),
            )),
        }
    }

    /// Prints the script for Slurm.
    ///
    /// # Errors
    /// A path that cannot be told from everywhere.
    pub fn slurm(
        &self,
        plan: &Plan,
        path: &Path,
        range: &Range<u64>,
        output: &Path,
    ) -> Result<Finding, Failure> {
        let total = range.end - range.start;
        let wanted = (self.task_seconds / seconds_per_run(plan, range)).ceil() as u64;
        let runs = wanted.max(total.div_ceil(MOST_TASKS)).clamp(1, total);
        let array = Array {
            program: std::env::current_exe().map_err(|error| Failure::Usage(error.to_string()))?,
            plan: absolute(path)?,
            output: absolute(output)?,
            range: range.clone(),
            runs,
        };
        say!("{}", array.script());
        Ok(Finding::Nothing)
    }
}

fn absolute(path: &Path) -> Result<PathBuf, Failure> {
    std::path::absolute(path)
        .map_err(|error| Failure::Usage(format!("{}: {error}", path.display())))
}

/// Time of a run on one core, s.
fn seconds_per_run(plan: &Plan, range: &Range<u64>) -> f64 {
    let total = range.end - range.start;
    let trials = TRIALS.min(total);
    let begin = Instant::now();
    for k in 0..trials {
        let index = range.start + k * total / trials;
        share(plan, index..index + 1, &mut || ());
    }
    begin.elapsed().as_secs_f64().max(1e-6) / trials as f64
}

/// An array job.
struct Array {
    program: PathBuf,
    plan: PathBuf,
    output: PathBuf,
    range: Range<u64>,
    /// Runs in a task.
    runs: u64,
}

impl Array {
    fn script(&self) -> String {
        let Range { start, end } = self.range;
        let last = (end - start).div_ceil(self.runs) - 1;
        let (program, plan, output) = (
            quoted(&self.program),
            quoted(&self.plan),
            quoted(&self.output),
        );
        let runs = self.runs;
        format!(
            "\
#!/usr/bin/env bash
# Runs {start}..{end} of a campaign as an array job of Slurm, {runs} runs to a task: bash SCRIPT hands it in. Each machine sees program, plan
# and result at the same path. A task that is started again goes on where it was; one that ran twice changes nothing.
set -euo pipefail
shares={output}.shares
mkdir -p \"$shares\"
array=$(sbatch --parsable --job-name=drivemon --array=0-{last} --cpus-per-task=1 --requeue --output=\"$shares/%a.log\" <<'TASK'
#!/usr/bin/env bash
export RAYON_NUM_THREADS=1
from=$(({start} + SLURM_ARRAY_TASK_ID * {runs}))
to=$((from + {runs} < {end} ? from + {runs} : {end}))
share=$(printf '%09d.parquet' $from)
# 1 says that FAULT was lit on a healthy motor: a finding, no failure.
{program} campaign run {plan} --from $from --to $to -o {output}.shares/$share || [ $? -eq 1 ]
TASK
)
sbatch --job-name=drivemon-merge --dependency=afterok:$array --kill-on-invalid-dep=yes --output=\"$shares/merge.log\" <<'MERGE'
#!/usr/bin/env bash
{program} campaign merge {output}.shares/*.parquet -o {output} || [ $? -eq 1 ]
MERGE"
        )
    }
}

/// A path as a shell takes it.
fn quoted(path: &Path) -> String {
    format!("'{}'", path.display().to_string().replace('\'', "'\\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shell_takes_any_path_back() {
        let path = Path::new("/a b/it's $HOME.toml");
        let told = Command::new("sh")
            .arg("-c")
            .arg(format!("printf %s {}", quoted(path)))
            .output();
        assert_eq!(
            told.expect("a shell").stdout,
            path.display().to_string().into_bytes()
        );
    }
}
