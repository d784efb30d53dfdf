use std::process::Command;

use super::*;
use crate::crafted::{LOAD, elf, program, set};

fn read(elf: &[u8]) -> Result<(Vec<u8>, Seal), String> {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("drive-monitor");
    std::fs::write(&file, elf).expect("written");
    read_elf(&file).map_err(|error| error.to_string())
}

fn told(elf: &[u8]) -> String {
    read(elf).expect_err("refused")
}

/// As the linker lays a program out: code, what becomes variables in RAM, and what is not loaded.
fn laid_out(program: &[u8]) -> Vec<u8> {
    let (code, data) = program.split_at(4_000);
    elf(&[
        (LOAD, 0x2000_0000, 0x2000_0000, &[]),
        (LOAD, 0x2000_0000, FIRST + 4_000, data),
        (LOAD, FIRST, FIRST, code),
        (4, 0, 0, b"a note"),
        (LOAD, 0x2000_0100, 0x2000_0100, b"RAM"),
    ])
}

#[test]
fn parts_lie_where_flash_has_them_not_where_they_run() {
    let program = program(4_777);
    let (bytes, seal) = read(&laid_out(&program)).expect("a program");
    assert_eq!(bytes, program);
    assert_eq!(
        (seal.length, seal.version.to_string()),
        (4_777, "1.2.3".into())
    );
}

#[test]
fn gaps_are_erased_flash() {
    let mut program = program(4_777);
    program[3_000..3_100].fill(0xFF);
    let sealed = resealed(program);
    let parts = [
        (LOAD, FIRST, FIRST, &sealed[..3_000]),
        (LOAD, FIRST + 3_100, FIRST + 3_100, &sealed[3_100..]),
    ];
    assert_eq!(read(&elf(&parts)).expect("a program").0, sealed);
}

/// With the checksum that tools/seal writes: another program, which knows nothing of this one.
fn resealed(mut program: Vec<u8>) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("elf");
    set(&mut program, SEAL_OFFSET + 4, &[u32::MAX, u32::MAX]);
    std::fs::write(&file, elf(&[(LOAD, FIRST, FIRST, &program)])).expect("written");
    let tool = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tools/seal");
    let done = Command::new("python3")
        .arg(tool)
        .arg(&file)
        .output()
        .expect("python3");
    assert!(done.status.success(), "{done:?}");
    let sealed = std::fs::read(file).expect("there");
    sealed[sealed.len() - program.len()..].to_vec()
}

#[test]
fn what_tools_seal_writes_holds_here() {
    assert_eq!(resealed(program(4_096)), program(4_096));
}

#[test]
fn each_wrong_file_is_told_by_what_it_is() {
    let whole = program(4_777);
    let at = |place: u32| elf(&[(LOAD, place, place, &whole)]);
    assert!(told(b"MZ").contains("drive-monitor: is no ELF file of a 32-bit program"));
    let mut of_64_bits = at(FIRST);
    of_64_bits[4] = 2;
    assert!(told(&of_64_bits).contains("is no ELF file of a 32-bit program"));
    let cut_off = laid_out(&whole);
    assert!(told(&cut_off[..4_500]).contains("cut off"));
    assert!(told(&elf(&[])).contains("holds nothing for the board's flash"));
    let loader = told(&at(0x0800_0000));
    assert!(
        loader.contains("begins at 0x08000000") && loader.contains("it is the loader"),
        "{loader}"
    );
    assert!(told(&at(0x0801_0000)).contains("begins at 0x08010000, a program at 0x08008000"));
    let long = vec![0; (PROGRAM_PAGES * PAGE_BYTES) as usize + 1];
    assert!(told(&elf(&[(LOAD, FIRST, FIRST, &long)])).contains("is longer than 221184 bytes"));
}

#[test]
fn a_seal_that_is_missing_blank_or_broken_is_told() {
    let changed = |at: usize, words: &[u32]| {
        let mut program = program(4_777);
        set(&mut program, at, words);
        told(&laid_out(&program))
    };
    assert!(changed(SEAL_OFFSET, &[0]).contains("is no program of this firmware"));
    let blank = changed(SEAL_OFFSET + 4, &[u32::MAX, u32::MAX]);
    assert!(
        blank.contains("is not sealed") && blank.contains("tools/thumb"),
        "{blank}"
    );
    assert!(changed(1_000, &[0]).contains("was changed after it was sealed"));
    assert!(changed(SEAL_OFFSET + 4, &[4_776]).contains("was changed after it was sealed"));
    let short = elf(&[(LOAD, FIRST, FIRST, &[0; 100])]);
    assert!(told(&short).contains("is no program of this firmware"));
}

/// The firmware itself, where it was built (`tools/thumb build --release -p drive-monitor`).
#[test]
fn the_firmware_is_read_where_it_was_built() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .join(BUILT);
    if !file.exists() {
        return;
    }
    let (bytes, seal) = read_elf(&file).expect("the firmware");
    assert_eq!(bytes.len(), seal.length as usize);
    assert_eq!(
        seal.version,
        update::Version::parse(env!("CARGO_PKG_VERSION"))
    );
}
