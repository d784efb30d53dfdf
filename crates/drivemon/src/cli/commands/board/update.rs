//! `drivemon board update`: a new program for a board, over its line.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::Args;
use program::sending::{self, Clock, Pace, Running, Stage};
use program::{Half, KeyFile, Package};
use report::json::Answer;
use schemars::JsonSchema;
use serde::Serialize;

use super::line::LineArgs;
use crate::cli::commands::ending::told_to_end;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::output::JsonArgs;
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
    #[command(flatten)]
    json: JsonArgs,
}

/// What became of a new program.
#[derive(Debug, Serialize, JsonSchema)]
pub struct UpdateJson {
    /// Version of the program that the board ran.
    board_version: String,
    /// Checksum of the program that the board ran, in hexadecimal digits.
    board_checksum: String,
    /// Version of the program in the package.
    package_version: String,
    /// Checksum of the program in the package, in hexadecimal digits.
    package_checksum: String,
    /// The package is signed with the demo key, which everybody has.
    demo_key: bool,
    /// It was sent; the board did not run it already.
    sent: bool,
    /// The board runs it for good; false where nobody waited for it (`--no-wait`).
    confirmed: bool,
}

impl Answer for UpdateJson {
    const FORMAT: &'static str = "board-update/1";
}

impl UpdateJson {
    fn new(package: &Package, runs: &Running) -> Self {
        let seal = package.seal();
        UpdateJson {
            board_version: runs.version.to_string(),
            board_checksum: format!("{:08x}", runs.checksum),
            package_version: seal.version.to_string(),
            package_checksum: format!("{:08x}", seal.checksum),
            demo_key: package.is_demo(),
            sent: runs.checksum != seal.checksum,
            confirmed: false,
        }
    }
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
        let mut told = UpdateJson::new(&package, &runs);
        self.json.show(|| print(&told));
        let mut pace = Clock::new(stop_signal()?);
        match told.sent {
            true => self.send(&mut line, &package, &runs, &mut pace)?,
            false => self.say("The board runs this program already."),
        }
        if !self.no_wait {
            self.wait(&mut line, &package, &mut pace)?;
            told.confirmed = true;
        }
        self.json.give(&told, || self.print_end(&told))?;
        Ok(Finding::Nothing)
    }

    fn say(&self, words: &str) {
        self.json.show(|| say!("{words}"));
    }

    fn print_end(&self, told: &UpdateJson) {
        if told.confirmed {
            let version = &told.package_version;
            let words = format!("version {version} runs and has confirmed itself");
            say!("{}", paint::good(words));
        } else {
            say!("`drivemon board read` shows Update, and what was refused.");
        }
    }

    fn send(
        &self,
        line: &mut live::ModbusLine,
        package: &Package,
        runs: &Running,
        pace: &mut dyn Pace,
    ) -> Result<(), Failure> {
        runs.may_be_followed_by(package)?;
        let bar = progress::bar("sending", package.bytes().len() as u64);
        let mut follow = |bytes: usize| bar.set_position(bytes as u64);
        let sent = sending::send(line, package, pace, &mut follow);
        bar.finish_and_clear();
        sent?;
        sending::install(line, pace)?;
        self.say("Sent; the board checks it and starts again.");
        Ok(())
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
    ) -> Result<(), Failure> {
        let bar = progress::spinner();
        let mut tell = |stage: Stage| bar.set_message(stage.to_string());
        let done = sending::wait(line, package, pace, &mut tell);
        bar.finish_and_clear();
        Ok(done?)
    }
}

fn print(told: &UpdateJson) {
    let row = |name: &str, version: &str, checksum: &str| {
        let name = paint::strong(format!("{name:11}"));
        say!("{name}  version {version}, checksum {checksum}");
    };
    row("board runs", &told.board_version, &told.board_checksum);
    row("package", &told.package_version, &told.package_checksum);
    if told.demo_key {
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
