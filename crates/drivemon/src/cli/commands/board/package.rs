//! `drivemon board package`: a program that was built, signed, as it goes over the line.

use std::path::PathBuf;

use clap::Args;
use program::{Half, KeyFile, Package, read_elf};

use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::output::write_bytes;
use crate::cli::printing::paint;
use crate::cli::printing::terminal::say;

/// Sign a program, so that boards take it over their line: an ELF file of the firmware becomes a package.
///
/// The package is the program as it lies in flash, and behind it 64 bytes of signature. Boards take it whose loader has the
/// public half of the key. It is for one motor: the motor file that it was built with.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct MakePackage {
    /// What the firmware's build made: target/thumbv7em-none-eabihf/release/drive-monitor
    #[arg(value_name = "ELF")]
    elf: PathBuf,
    /// Secret half of the key, from `drivemon board key new`
    #[arg(long, value_name = "FILE", required_unless_present = "demo_key")]
    key: Option<PathBuf>,
    /// Sign with the demo key, which everybody has: for trying only
    #[arg(long)]
    demo_key: bool,
    /// The package
    #[arg(short, long, value_name = "FILE.dmu")]
    output: PathBuf,
}

const EXAMPLES: &str = "\
Examples:
  DRIVE_MONITOR_MOTOR=motors/mine.toml tools/thumb build --release -p drive-monitor
  drivemon board package target/thumbv7em-none-eabihf/release/drive-monitor --key plant-7.key -o new.dmu
  drivemon board update new.dmu --serial /dev/ttyUSB0
Exit codes: 0 done, 2 bad usage, no program, or no key.";

impl MakePackage {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        let (program, seal) = read_elf(&self.elf)?;
        let key = self.key()?;
        let secret = key
            .secret()
            .ok_or_else(|| Failure::Usage("--key: holds no secret half".into()))?;
        let package = Package::sign(program, &secret)
            .map_err(|refusal| Failure::Usage(format!("{}: {refusal}", self.elf.display())))?;
        write_bytes(&self.output, package.bytes())?;
        let row =
            |name: &str, value: String| say!("{}  {value}", paint::strong(format!("{name:9}")));
        row("version", seal.version.to_string());
        row("board", format!("STM32G474RE ({:#010x})", seal.board));
        row(
            "bytes",
            format!(
                "{} of program, {} in all",
                seal.length,
                package.bytes().len()
            ),
        );
        row("checksum", format!("{:08x}", seal.checksum));
        row("key", key.name().to_owned());
        if key.is_demo() {
            say!(
                "{}",
                paint::caution("Signed with the demo key, which everybody has: for trying only.")
            );
        }
        Ok(Finding::Nothing)
    }

    fn key(&self) -> Result<KeyFile, Failure> {
        let Some(file) = &self.key else {
            return Ok(KeyFile::demo(Half::Secret));
        };
        let key = KeyFile::read(file, Half::Secret)?;
        if key.is_demo() && !self.demo_key {
            return Err(Failure::Usage(format!(
                "{}: is a demo key, which everybody has; make your own with `drivemon board key new NAME`, or say --demo-key \
                 to try",
                file.display()
            )));
        }
        Ok(key)
    }
}
