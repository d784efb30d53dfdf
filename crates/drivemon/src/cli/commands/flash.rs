//! `drivemon flash`: a motor file onto the board.

use std::path::{Path, PathBuf};

use clap::Args;
use program::flashing::{BUILD_SCRIPT, build, restart, write};
use program::{Half, KeyFile};

use super::board::motor;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::paint;
use crate::cli::printing::terminal::say;

/// Build loader and firmware for one motor and write them to a board.
///
/// The motor file is checked first, as every command checks it; then `tools/thumb` builds the loader with the public key of
/// DRIVE_MONITOR_UPDATE_KEY and the firmware with the motor's constants, and probe-rs writes both through the debugger of the
/// NUCLEO. From then on the board takes programs over its line that were signed with that key. What the board has learnt stays
/// in its flash, but holds only for the motor constants that it was learnt with.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Flash {
    /// Motor file
    #[arg(long, value_name = "M")]
    motor: PathBuf,
    /// Let the board take programs that were signed with the demo key, which everybody has
    #[arg(long)]
    demo_key: bool,
    /// Check the motor file and say what would be done; build and write nothing
    #[arg(long)]
    dry_run: bool,
    /// Folder of the drive-monitor source tree; without it the current folder and those above it are searched
    #[arg(long, value_name = "FOLDER")]
    source: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  drivemon flash --motor motors/mine.toml --dry-run      is the file fit for the board, and what would be run?
  drivemon flash --motor motors/mine.toml                build, write, start
  drivemon flash --motor motors/mine.toml --demo-key     the same for a board on a desk
DRIVE_MONITOR_UPDATE_KEY names the file of the public key, 64 hexadecimal digits; `drivemon board key new` makes one.
Needs: the source tree; a compiler for the board (tools/thumb says which); probe-rs (cargo install probe-rs-tools);
the NUCLEO-G474RE on USB. Afterwards: docs/firmware.md, first power-up; `drivemon monitor --serial PORT` shows its lamps.
Exit codes: 0 done, 2 the motor file, the key, the build, probe-rs or the board.";

const TARGET: &str = "thumbv7em-none-eabihf";
const FIRMWARE: &str = "drive-monitor";
const KEY_VARIABLE: &str = "DRIVE_MONITOR_UPDATE_KEY";

impl Flash {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        // Everything that the firmware's build would refuse, before it takes minutes.
        let (name, _) = motor::read(&self.motor)?;
        let tree = self.source_tree()?;
        let motor = absolute(&self.motor)?;
        let key = self.key()?;
        say!(
            "{}  {name}",
            paint::strong(&self.motor.display().to_string())
        );
        say!("{}", told(key.as_deref()));
        let built = target_folder(&tree).join(TARGET).join("release");
        let steps = [
            build(&tree, "loader", (KEY_VARIABLE, key.as_deref())),
            build(&tree, FIRMWARE, ("DRIVE_MONITOR_MOTOR", Some(&motor))),
            write(&built.join("loader")),
            write(&built.join(FIRMWARE)),
            restart(),
        ];
        if self.dry_run {
            for step in &steps {
                say!("would run: {}", step.shown());
            }
            return Ok(Finding::Nothing);
        }
        for step in steps {
            say!("{} {}", paint::faint("running"), step.shown());
            step.run()?;
        }
        say!("{}", paint::good("written and started"));
        Ok(Finding::Nothing)
    }

    /// The file of the public key that goes into the loader; `None` for the demo key.
    fn key(&self) -> Result<Option<PathBuf>, Failure> {
        if self.demo_key {
            return Ok(None);
        }
        let named = std::env::var_os(KEY_VARIABLE).filter(|path| !path.is_empty());
        let path = named.map(|path| absolute(Path::new(&path))).transpose()?;
        let key = path
            .as_deref()
            .map(|path| KeyFile::read(path, Half::Public));
        match key.transpose()? {
            Some(key) if !key.is_demo() => Ok(path),
            _ => Err(Failure::Usage(format!(
                "{KEY_VARIABLE} names no key of your own, so the board would take programs from everybody who has the demo key; \
                 make one with `drivemon board key new` and name its public half there, or say --demo-key"
            ))),
        }
    }

    fn source_tree(&self) -> Result<PathBuf, Failure> {
        let is_tree = |folder: &Path| folder.join(BUILD_SCRIPT).is_file();
        if let Some(folder) = &self.source {
            return is_tree(folder).then(|| folder.clone()).ok_or_else(|| {
                let folder = folder.display();
                Failure::Usage(format!(
                    "{folder}: holds no {BUILD_SCRIPT}; name the folder that README.md lies in"
                ))
            });
        }
        let here = std::env::current_dir().map_err(|error| Failure::Usage(error.to_string()))?;
        let found = here.ancestors().find(|folder| is_tree(folder));
        found.map(Path::to_path_buf).ok_or_else(|| {
            Failure::Usage(format!(
                "{}: is not within the drive-monitor source tree; go there, or name it with --source FOLDER",
                here.display()
            ))
        })
    }
}

/// The build runs in another folder.
fn absolute(path: &Path) -> Result<PathBuf, Failure> {
    std::path::absolute(path)
        .map_err(|error| Failure::Usage(format!("{}: {error}", path.display())))
}

fn target_folder(tree: &Path) -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| tree.join("target"), |folder| tree.join(folder))
}

/// Which key goes in.
fn told(key: Option<&Path>) -> String {
    match key {
        Some(path) => format!("key of updates: {}", path.display()),
        None => "key of updates: demo; everybody has its secret half, so anybody on the line can give this board a program".into(),
    }
}
