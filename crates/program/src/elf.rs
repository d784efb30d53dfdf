//! From the ELF file of a firmware to its bytes as they lie in flash.

use std::path::Path;

use object::Endianness;
use object::elf::{FileHeader32, PT_LOAD};
use object::read::elf::{FileHeader, ProgramHeader};
use update::layout::{FLASH_BASE, PAGE_BYTES, PROGRAM, PROGRAM_PAGES};
use update::{BOARD_TYPE, Refusal, SEAL_MAGIC, SEAL_OFFSET, Seal};

use crate::error::{self, Error};

/// The file that a build of the firmware makes.
const BUILT: &str = "target/thumbv7em-none-eabihf/release/drive-monitor";
/// Where the program begins.
const FIRST: u32 = FLASH_BASE + PROGRAM;
const END: u32 = FIRST + PROGRAM_PAGES * PAGE_BYTES;
/// All of flash; what is loaded elsewhere is no part of the program.
const FLASH: core::ops::Range<u32> = FLASH_BASE..FLASH_BASE + 512 * 1024;
/// What flash holds where nothing was written.
const ERASED: u8 = 0xFF;

/// Bytes of the program in an ELF file as they lie in flash, gaps erased, and its seal, which holds.
///
/// # Errors
/// The file is no ELF file, no program of this firmware, linked for another place, or not sealed.
pub fn read_elf(file: &Path) -> Result<(Vec<u8>, Seal), Error> {
    let elf = error::read(file, &format!("name the ELF file of the firmware, {BUILT}"))?;
    let segments = segments(&elf).map_err(|error| {
        let what = format!("is no ELF file of a 32-bit program ({error})");
        Error::new(file, what, format!("name the firmware's, {BUILT}"))
    })?;
    check_place(file, &segments)?;
    let bytes = in_flash(&segments);
    let seal = check_seal(file, &bytes)?;
    Ok((bytes, seal))
}

/// Address and bytes of everything that is written to flash.
fn segments(elf: &[u8]) -> Result<Vec<(u32, &[u8])>, String> {
    let told = |error: object::Error| error.to_string();
    let header = FileHeader32::<Endianness>::parse(elf).map_err(told)?;
    let endian = header.endian().map_err(told)?;
    let headers = header.program_headers(endian, elf).map_err(told)?;
    let mut found = Vec::new();
    for header in headers {
        let address = header.p_paddr(endian);
        let loaded = header.p_type(endian) == PT_LOAD && header.p_filesz(endian) > 0;
        if loaded && FLASH.contains(&address) {
            let bytes = header.data(endian, elf);
            let bytes = bytes.map_err(|()| "it is cut off")?;
            found.push((address, bytes));
        }
    }
    Ok(found)
}

fn check_place(file: &Path, segments: &[(u32, &[u8])]) -> Result<(), Error> {
    let remedy = format!("name the firmware's, {BUILT}, of a build of this version");
    let first = segments.iter().map(|(address, _)| *address).min();
    let Some(first) = first else {
        let what = "holds nothing for the board's flash";
        return Err(Error::new(file, what, remedy));
    };
    if first != FIRST {
        let whose = match first {
            FLASH_BASE => ", where the loader lies: it is the loader, or firmware from before it",
            _ => "",
        };
        let what = format!("begins at {first:#010x}, a program at {FIRST:#010x}{whose}");
        return Err(Error::new(file, what, remedy));
    }
    let end = |(address, bytes): &(u32, &[u8])| u64::from(*address) + bytes.len() as u64;
    let beyond = segments.iter().any(|part| end(part) > u64::from(END));
    let most = PROGRAM_PAGES * PAGE_BYTES;
    let too_long = || Error::new(file, format!("is longer than {most} bytes"), remedy);
    (!beyond).then_some(()).ok_or_else(too_long)
}

fn in_flash(segments: &[(u32, &[u8])]) -> Vec<u8> {
    let mut program = Vec::new();
    for (address, bytes) in segments {
        let from = (address - FIRST) as usize;
        let end = from + bytes.len();
        program.resize(end.max(program.len()), ERASED);
        program[from..end].copy_from_slice(bytes);
    }
    program
}

fn check_seal(file: &Path, program: &[u8]) -> Result<Seal, Error> {
    let magic = program.get(SEAL_OFFSET..SEAL_OFFSET + 4);
    if magic != Some(&SEAL_MAGIC.to_le_bytes()) {
        let remedy = format!("name the firmware's, {BUILT}");
        return Err(Error::new(file, "is no program of this firmware", remedy));
    }
    let again = "build it with `tools/thumb build --release -p drive-monitor`, which seals it";
    let seal = Seal::read(program).map_err(|_| Error::new(file, "is not sealed", again))?;
    let held = match seal.length as usize == program.len() {
        true => seal.check(program),
        false => Err(Refusal::Checksum),
    };
    held.map_err(|_| Error::new(file, "was changed after it was sealed", again))?;
    if seal.board != BOARD_TYPE {
        let remedy = "use the drivemon of that firmware's version";
        return Err(Error::new(file, "is for another board", remedy));
    }
    Ok(seal)
}

#[cfg(test)]
mod tests;
