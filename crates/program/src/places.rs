//! Addresses of a program put into words: function, file and line, from the ELF file that was flashed.

use std::path::Path;

use addr2line::Loader;
use object::{Object, ObjectSegment};

use update::SEAL_OFFSET;
use update::layout::{FLASH_BASE, PROGRAM};

use crate::error::{self, Error};

/// What lies where in a program's file.
pub struct Places {
    loader: Loader,
    bytes: Vec<u8>,
}

impl Places {
    /// Reads an ELF file.
    ///
    /// # Errors
    /// It cannot be read, or is no program with line tables.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let unreadable = |error: &dyn std::fmt::Display| Error::new(path, error, REMEDY);
        let bytes = error::read(path, REMEDY)?;
        object::File::parse(&bytes[..]).map_err(|error| unreadable(&error))?;
        let loader = Loader::new(path).map_err(|error| unreadable(&error))?;
        Ok(Places { loader, bytes })
    }

    /// Function, file and line of an address; inlined functions innermost first.
    pub fn place(&self, address: u32) -> Vec<String> {
        let address = u64::from(address & !1);
        let mut found = Vec::new();
        if let Ok(mut frames) = self.loader.find_frames(address) {
            while let Ok(Some(frame)) = frames.next() {
                let name = frame
                    .function
                    .as_ref()
                    .and_then(|name| name.demangle().ok());
                let place = frame.location.map_or(String::new(), |at| {
                    format!("{}:{}", at.file.unwrap_or("?"), at.line.unwrap_or(0))
                });
                let name = name.map_or("?".into(), |name| name.into_owned());
                found.push(format!("{name}  {place}"));
            }
        }
        if found.is_empty() {
            let symbol = self.loader.find_symbol(address);
            found.extend(
                symbol.map(|name| addr2line::demangle_auto(name.into(), None).into_owned()),
            );
        }
        found
    }

    /// Text of the program, as the file name of a panic.
    pub fn text(&self, address: u32, length: u32) -> Option<String> {
        let file = object::File::parse(&self.bytes[..]).ok()?;
        let found = file.segments().find_map(|segment| {
            let inside = segment.data_range(u64::from(address), u64::from(length));
            inside.ok().flatten().map(<[u8]>::to_vec)
        });
        String::from_utf8(found?).ok()
    }

    /// Length and CRC-32 that the file was sealed with.
    pub fn seal(&self) -> Option<(u32, u32)> {
        let file = object::File::parse(&self.bytes[..]).ok()?;
        let word = |address: u64| {
            let found = file.segments().find_map(|segment| {
                let inside = segment.data_range(address, 4);
                inside.ok().flatten().map(<[u8]>::to_vec)
            });
            Some(u32::from_le_bytes(found?.try_into().ok()?))
        };
        let sealed = (word(SEAL + 4)?, word(SEAL + 8)?);
        (sealed.0 != u32::MAX).then_some(sealed)
    }
}

const REMEDY: &str =
    "name the ELF file that was flashed, target/thumbv7em-none-eabihf/release/drive-monitor";
/// Where the seal lies in flash (src/regions.x).
const SEAL: u64 = FLASH_BASE as u64 + PROGRAM as u64 + SEAL_OFFSET as u64;
