//! For the board only: the memory map for the linker, and the public key as a constant.

use std::error::Error;
use std::path::{Path, PathBuf};

/// The key that is compiled in unless the environment names another. Everybody has its secret half.
const DEMO_KEY: &str = "keys/demo.pub";
const KEY_VARIABLE: &str = "DRIVE_MONITOR_UPDATE_KEY";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed={KEY_VARIABLE}");
    if std::env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    if let Err(error) = prepare() {
        println!("cargo::error={error}");
    }
}

fn prepare() -> Result<(), Box<dyn Error>> {
    let here = PathBuf::from(std::env::var("CARGO_MANIFEST_DIR")?);
    let tree = here.join("../..");
    println!("cargo::rerun-if-changed=../../memory.x");
    println!("cargo::rerun-if-changed=regions.x");
    for folder in [&here, &tree] {
        println!("cargo::rustc-link-search={}", folder.display());
    }
    println!("cargo::rustc-link-arg-bins=-Tlink.x");
    println!("cargo::rustc-link-arg-bins=--nmagic");
    let path = key_path(&tree);
    println!("cargo::rerun-if-changed={}", path.display());
    let key = key(&path).map_err(|what| format!("{}: {what}", path.display()))?;
    let out = PathBuf::from(std::env::var("OUT_DIR")?);
    let constant = format!(
        "/// What programs are signed with, its public half.\npub const KEY: update::PublicKey = update::PublicKey({key:?});\n"
    );
    Ok(std::fs::write(out.join("key.rs"), constant)?)
}

/// A relative path means the same whatever folder cargo was called in.
fn key_path(tree: &Path) -> PathBuf {
    let chosen = std::env::var(KEY_VARIABLE)
        .ok()
        .filter(|path| !path.is_empty());
    tree.join(chosen.as_deref().unwrap_or(DEMO_KEY))
}

/// The 32 bytes that a file has as hexadecimal digits, behind a line that says what it is (`drivemon board key new`).
fn key(path: &Path) -> Result<[u8; 32], String> {
    let text = std::fs::read_to_string(path).map_err(|error| error.to_string())?;
    if text.starts_with("# drive-monitor, secret") {
        return Err(
            "is the secret half of a key, which no board needs; name its public half, NAME.pub"
                .into(),
        );
    }
    let digits: String = text.lines().filter(|line| !line.starts_with('#')).collect();
    let digits = digits.trim().as_bytes();
    let (pairs, rest) = digits.as_chunks::<2>();
    let byte = |pair: &[u8; 2]| u8::from_str_radix(str::from_utf8(pair).ok()?, 16).ok();
    let bytes: Option<Vec<u8>> = pairs.iter().map(byte).collect();
    let key = bytes.and_then(|bytes| bytes.try_into().ok());
    key.filter(|_| rest.is_empty()).ok_or_else(|| {
        format!("no public key: it has 64 hexadecimal digits; {KEY_VARIABLE} names the file")
    })
}
