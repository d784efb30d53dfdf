//! The firmware file: what goes where in flash.

use object::{Object, ObjectSegment, ObjectSymbol};

use crate::error::BoardError;

/// Loadable bytes by physical address, and symbols.
pub struct Firmware {
    /// Physical address and content.
    pub segments: Vec<(u32, Vec<u8>)>,
    symbols: Vec<(String, u32)>,
}

impl Firmware {
    /// Reads an ELF file.
    pub fn parse(bytes: &[u8]) -> Result<Self, BoardError> {
        let file = object::read::elf::ElfFile32::<object::Endianness>::parse(bytes)
            .map_err(|error| BoardError::Elf(error.to_string()))?;
        let endian = file.endian();
        let mut segments = Vec::new();
        for segment in file.segments() {
            let header = segment.elf_program_header();
            let data = segment
                .data()
                .map_err(|error| BoardError::Elf(error.to_string()))?;
            if !data.is_empty() {
                segments.push((header.p_paddr.get(endian), data.to_vec()));
            }
        }
        let named = |symbol: object::read::elf::ElfSymbol<'_, '_, _>| {
            Some((
                symbol.name().ok()?.to_owned(),
                u32::try_from(symbol.address()).ok()?,
            ))
        };
        Ok(Firmware {
            segments,
            symbols: file.symbols().filter_map(named).collect(),
        })
    }

    /// Name of the function that an address lies in.
    pub fn function(&self, address: u32) -> &str {
        let before = self.symbols.iter().filter(|(name, at)| {
            !name.is_empty() && !name.starts_with('$') && (*at & !1) <= address
        });
        before
            .max_by_key(|(_, at)| *at & !1)
            .map_or("?", |(name, _)| name)
    }

    /// Instructions by the name of the function that they lie in, most first; of addresses with their instructions.
    pub fn by_function(
        &self,
        instructions: impl IntoIterator<Item = (u64, u64)>,
    ) -> Vec<(String, u64)> {
        let mut functions = std::collections::HashMap::<String, u64>::new();
        for (address, count) in instructions {
            let name = self.function(address as u32).to_owned();
            *functions.entry(name).or_default() += count;
        }
        let mut sorted: Vec<_> = functions.into_iter().collect();
        sorted.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        sorted
    }

    /// All symbols whose name contains `part`.
    pub fn symbols(&self, part: &str) -> Vec<(String, u32)> {
        let found = self.symbols.iter().filter(|(name, _)| name.contains(part));
        found.cloned().collect()
    }

    /// Address of the first symbol whose name contains `part`.
    pub fn symbol(&self, part: &str) -> Option<u32> {
        let found = self.symbols.iter().find(|(name, _)| name.contains(part));
        found.map(|(_, address)| *address)
    }
}
