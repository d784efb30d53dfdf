//! `drivemon fleet simulate`.

use std::future::Future;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};

use clap::Args;
use tokio::runtime::Builder;

use super::error::CommandError;
use super::terminal::Terminal;
use crate::simulate::{MOTOR_FILE, MOTOR_FILE_NAME, Plan, Plant, Truth, serve};

/// What is simulated.
#[derive(Debug, Args)]
pub struct Simulate {
    /// How many boards
    boards: u32,
    /// Address of the first listener
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1:15020")]
    listen: SocketAddr,
    /// Boards behind one port, 1 to 247
    #[arg(long, value_name = "N", default_value_t = 200)]
    per_port: u32,
    /// All chances follow from it
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Motors that begin to fail
    #[arg(long, value_name = "K", default_value_t = 0)]
    faulty: u32,
    /// They begin within this time, s
    #[arg(long, value_name = "S", default_value_t = 600)]
    faults_within: u32,
    /// Mean time between two losses of a board's power, s; without it none loses it
    #[arg(long, value_name = "S")]
    restart_every: Option<u32>,
    /// Time passes for so many seconds; behind that boards only answer
    #[arg(long, value_name = "S")]
    seconds: Option<u64>,
    /// Write a configuration for `drivemon gateway` that reads all of them, and the motor file of their recordings beside it
    #[arg(long, value_name = "FILE")]
    config_out: Option<PathBuf>,
    /// Write down every second and event that a board produces
    #[arg(long, value_name = "FILE")]
    truth: Option<PathBuf>,
}

impl Simulate {
    /// Runs the command until `end`.
    ///
    /// # Errors
    /// A plan that contradicts itself, an address that is taken, a file that cannot be written.
    pub fn run(
        &self,
        terminal: Terminal,
        end: impl Future<Output = ()>,
    ) -> Result<(), CommandError> {
        let plan = self.plan();
        let truth = self.truth.as_deref();
        let truth = truth
            .map(|path| Truth::create(path).map_err(|error| file("--truth", path, error)))
            .transpose()?;
        let plant = Plant::new(&plan, truth)?;
        if let Some(path) = &self.config_out {
            spare_the_work_of_people(path)?;
            std::fs::write(path, plan.configuration("plant.db"))
                .map_err(|error| file("--config-out", path, error))?;
            let motor = path.with_file_name(MOTOR_FILE_NAME);
            std::fs::write(&motor, MOTOR_FILE)
                .map_err(|error| file("--config-out", &motor, error))?;
        }
        (terminal.complain)(&format!(
            "{} boards at {} ports from {} on, {} behind each   (Ctrl-C ends it)",
            plan.boards,
            plan.listeners(),
            plan.listen,
            plan.per_port
        ));
        let runtime = Builder::new_current_thread().enable_all().build()?;
        runtime.block_on(async {
            tokio::select! {
                served = serve(plant, &plan, self.seconds) => served,
                () = end => Ok(()),
            }
        })?;
        Ok(())
    }

    fn plan(&self) -> Plan {
        Plan {
            boards: self.boards,
            listen: self.listen,
            per_port: self.per_port,
            seed: self.seed,
            faulty: self.faulty,
            faults_within_s: self.faults_within,
            restart_s: self.restart_every,
        }
    }
}

fn file(option: &'static str, path: &Path, error: std::io::Error) -> CommandError {
    let path = path.display().to_string();
    CommandError::File {
        option,
        path,
        error,
    }
}

/// A configuration that somebody wrote is not replaced; one that this command wrote may be.
fn spare_the_work_of_people(path: &Path) -> Result<(), CommandError> {
    match std::fs::read_to_string(path) {
        Ok(text) if !is_written_here(&text) => Err(CommandError::Output(format!(
            "--config-out would overwrite {}, which this command did not write; name another file",
            path.display()
        ))),
        _ => Ok(()),
    }
}

/// By its first line: "# 20 simulated boards".
fn is_written_here(text: &str) -> bool {
    let first = text.lines().next().unwrap_or_default();
    first.starts_with("# ") && first.ends_with(" simulated boards")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_configuration_that_somebody_wrote_is_kept() {
        let folder = std::env::temp_dir().join(format!("drivemon-simulate-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let path = folder.join("plant.toml");
        assert!(
            spare_the_work_of_people(&path).is_ok(),
            "nothing is there yet"
        );
        std::fs::write(&path, "# 20 simulated boards\n[store]\n").expect("written");
        assert!(spare_the_work_of_people(&path).is_ok());
        std::fs::write(&path, "# My plant\n[store]\n").expect("written");
        let refused = spare_the_work_of_people(&path).expect_err("kept");
        assert!(refused.to_string().contains("did not write"), "{refused}");
        std::fs::remove_dir_all(&folder).expect("removed");
    }
}
