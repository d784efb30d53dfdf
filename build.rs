//! Firmware only: the memory map for the linker, and the motor file as constants.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;

use board::MotorImage;
use monitor::{Monitor, MonitorConfig};
use motor::effect::SteadyEffect;
use motor::motor_file::MotorFile;
use motor::{effect, effects};

/// The motor file that is compiled in unless the environment names another.
const DEFAULT_MOTOR: &str = "motors/assumed-300w.toml";
const MOTOR_VARIABLE: &str = "DRIVE_MONITOR_MOTOR";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed={MOTOR_VARIABLE}");
    if std::env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    if let Err(error) = prepare() {
        for line in error.to_string().lines() {
            println!("cargo::error={line}");
        }
    }
}

fn prepare() -> Result<(), Box<dyn Error>> {
    let here = PathBuf::from(std::env::var("CARGO_MANIFEST_DIR")?);
    let out = PathBuf::from(std::env::var("OUT_DIR")?);
    link(&here);
    let motor = motor_path(&here);
    println!("cargo::rerun-if-changed={}", motor.display());
    let revision = format!(
        "/// Revision of the source; empty where it was not built from a repository.\n\
         pub const REVISION: &str = \"{}\";\n",
        revision(&here).unwrap_or_default()
    );
    std::fs::write(out.join("motor.rs"), constants(&motor)? + &revision)?;
    Ok(())
}

fn link(here: &Path) {
    println!("cargo::rerun-if-changed=memory.x");
    println!("cargo::rerun-if-changed=src/regions.x");
    println!("cargo::rustc-link-search={}", here.display());
    println!("cargo::rustc-link-search={}", here.join("src").display());
    for script in ["link.x", "defmt.x"] {
        println!("cargo::rustc-link-arg-bins=-T{script}");
    }
    println!("cargo::rustc-link-arg-bins=--nmagic");
}

/// The commit that is checked out. What was changed since is told by the program's checksum.
fn revision(here: &Path) -> Option<String> {
    let log = here.join(".git/logs/HEAD");
    if log.exists() {
        println!("cargo::rerun-if-changed={}", log.display());
    }
    let git = ["rev-parse", "--short=12", "HEAD"];
    let output = Command::new("git").args(git).current_dir(here).output();
    let output = output.ok().filter(|output| output.status.success())?;
    let text = String::from_utf8(output.stdout).ok()?;
    let is_hash = |text: &&str| text.bytes().all(|byte| byte.is_ascii_hexdigit());
    Some(text.trim()).filter(is_hash).map(str::to_owned)
}

/// A relative path means the same whatever folder cargo was called in.
fn motor_path(here: &Path) -> PathBuf {
    let chosen = std::env::var(MOTOR_VARIABLE)
        .ok()
        .filter(|path| !path.is_empty());
    here.join(chosen.as_deref().unwrap_or(DEFAULT_MOTOR))
}

fn constants(path: &Path) -> Result<String, Box<dyn Error>> {
    let file = MotorFile::read(path)?;
    let config = MonitorConfig::of_board(&file)?;
    Monitor::new(config).map_err(|error| format!("{}: {error}", path.display()))?;
    check_effects(&file).map_err(|error| format!("{}: {error}", path.display()))?;
    let words = MotorImage::new(&config).0;
    let name: String = file.name.chars().flat_map(char::escape_default).collect();
    Ok(format!(
        "/// Name of the motor in the motor file.\npub const NAME: &str = \"{name}\";\n\
         /// Its constants, checked at power-up.\npub static IMAGE: board::MotorImage = board::MotorImage({words:?});\n"
    ))
}

/// A formula is compiled by nobody.
fn check_effects(file: &MotorFile) -> Result<(), Box<dyn Error>> {
    let configs = effect::from_motor_file(file, &file.name)?;
    // Laws are numbers of the image, not terms of the program.
    let terms = configs
        .iter()
        .filter(|config| config.effect.law().is_none());
    for config in terms {
        let wanted = config.effect.descriptor();
        let known = |steady: &&&dyn SteadyEffect| core::ptr::eq(steady.descriptor(), wanted);
        if !effects::STEADY.iter().any(|steady| known(&steady)) {
            let name = wanted.name;
            return Err(format!(
                "effects.{name}: a formula runs on a host only; remove it to flash the board"
            )
            .into());
        }
    }
    Ok(())
}
