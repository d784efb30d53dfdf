//! `drivemon board update`: a new program for a board, over its line.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::Args;
use program::sending::{self, Clock, Pace, Running, Stage};
use program::{Half, KeyFile, Package};

use super::line::LineArgs;
use crate::cli::commands::ending::told_to_end;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::terminal::say;
use crate::cli::printing::{paint, progress};

/// Give a board another program over its line: send a package, let the board install it, and wait until it has proved itself.
///
/// The board judges its motor on while the program is sent. Then it checks what it received and starts again, and its loader
/// checks the signature and exchanges the programs: some seconds without lamps. The new program is on trial. It confirms
/// itself after a minute without a crash or a doubt; otherwise the board brings the program before back by itself. Power may
/// fail at any moment. The event log stays; what the board has learnt and its configuration hold on where the new program was
/// built for the same motor.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Update {
    /// The package, from `drivemon board package`
    #[arg(value_name = "FILE.dmu")]
    package: PathBuf,
    #[command(flatten)]
    line: LineArgs,
    /// Refuse a package before it is sent whose signature this public half of a key does not confirm
    #[arg(long, value_name = "FILE")]
    public_key: Option<PathBuf>,
    /// End as soon as the board has been told to install it
    #[arg(long)]
    no_wait: bool,
}

const EXAMPLES: &str = "\
Examples:
  drivemon board update new.dmu --serial /dev/ttyUSB0
  drivemon board update new.dmu --serial /dev/ttyUSB0 --unit 7 --public-key plant-7.pub
Ctrl-C while it is sent: the board runs its program on, and the next transfer begins at its beginning.
Ctrl-C while it waits: the board goes on by itself; the same command waits on.
Exit codes: 0 the new program has confirmed itself, 2 bad usage, no answer, a refusal, or the program before is back.";

impl Update {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        // A wrong file is told before the line is asked.
        let package = self.package()?;
        let mut line = self.line.open()?;
        let runs = sending::running(&mut line)?;
        print(&package, &runs);
        let mut pace = Clock::new(stop_signal()?);
        if runs.checksum == package.seal().checksum {
            say!("The board runs this program already.");
        } else {
            runs.may_be_followed_by(&package)?;
            let bar = progress::bar("sending", package.bytes().len() as u64);
            let mut follow = |bytes: usize| bar.set_position(bytes as u64);
            let sent = sending::send(&mut line, &package, &mut pace, &mut follow);
            bar.finish_and_clear();
            sent?;
            sending::install(&mut line, &mut pace)?;
            say!("Sent; the board checks it and starts again.");
        }
        if self.no_wait {
            say!(
                "`drivemon board read` shows Update: 4 on trial, 5 confirmed, 6 brought back, 7 refused."
            );
            return Ok(Finding::Nothing);
        }
        self.wait(&mut line, &package, &mut pace)
    }

    fn package(&self) -> Result<Package, Failure> {
        let package = Package::read(&self.package)?;
        let Some(file) = &self.public_key else {
            return Ok(package);
        };
        let key = KeyFile::read(file, Half::Public)?;
        if package.is_signed_with(&key.public()) {
            return Ok(package);
        }
        Err(Failure::Usage(format!(
            "{}: is not signed with the key {}; sign it with its secret half: `drivemon board package --key`",
            self.package.display(),
            key.name()
        )))
    }

    fn wait(
        &self,
        line: &mut live::ModbusLine,
        package: &Package,
        pace: &mut dyn Pace,
    ) -> Result<Finding, Failure> {
        let bar = progress::spinner();
        let mut tell = |stage: Stage| bar.set_message(stage.to_string());
        let done = sending::wait(line, package, pace, &mut tell);
        bar.finish_and_clear();
        done?;
        let version = package.seal().version;
        say!(
            "{}",
            paint::good(format!("version {version} runs and has confirmed itself"))
        );
        Ok(Finding::Nothing)
    }
}

fn print(package: &Package, runs: &Running) {
    let seal = package.seal();
    let row = |name: &str, version: program::Version, checksum: u32| {
        say!(
            "{}  version {version}, checksum {checksum:08x}",
            paint::strong(format!("{name:11}"))
        );
    };
    row("board runs", runs.version, runs.checksum);
    row("package", seal.version, seal.checksum);
    if package.is_demo() {
        say!(
            "{}",
            paint::caution(
                "The package is signed with the demo key, which everybody has: for trying only."
            )
        );
    }
}

/// Whether Ctrl-C was pressed, or the system asks for an end.
fn stop_signal() -> Result<impl Fn() -> bool, Failure> {
    let stopped = Arc::new(AtomicBool::new(false));
    let told = Arc::clone(&stopped);
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build();
    let runtime = runtime.map_err(|error| Failure::Usage(error.to_string()))?;
    std::thread::spawn(move || {
        runtime.block_on(told_to_end());
        told.store(true, Ordering::Relaxed);
    });
    Ok(move || stopped.load(Ordering::Relaxed))
}
