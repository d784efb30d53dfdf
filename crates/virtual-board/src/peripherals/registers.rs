//! Registers that only remember what was written, and the error of touching one that does not exist here.

use std::collections::BTreeMap;

/// An access that no model covers.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{block} has no model for {access} at offset {offset:#x}")]
pub struct Unmodelled {
    /// Peripheral.
    pub block: &'static str,
    /// `read` or `write of 0x..`.
    pub access: String,
    /// Byte offset in it.
    pub offset: u32,
}

/// A block of plain read-write registers with their reset values.
#[derive(Clone, Debug)]
pub struct Registers {
    block: &'static str,
    reset: &'static [(u32, u32)],
    values: BTreeMap<u32, u32>,
}

impl Registers {
    /// `reset` lists offset and reset value of every register that exists.
    pub fn new(block: &'static str, reset: &'static [(u32, u32)]) -> Self {
        Registers {
            block,
            reset,
            values: reset.iter().copied().collect(),
        }
    }

    /// Back to the reset values.
    pub fn reset(&mut self) {
        self.values = self.reset.iter().copied().collect();
    }

    /// Value of a register that is known to exist.
    pub fn get(&self, offset: u32) -> u32 {
        self.values.get(&offset).copied().unwrap_or(0)
    }

    /// Changes a register from the hardware's side.
    pub fn set(&mut self, offset: u32, value: u32) {
        self.values.insert(offset, value);
    }

    /// A bus read.
    pub fn read(&self, offset: u32) -> Result<u32, Unmodelled> {
        self.values
            .get(&offset)
            .copied()
            .ok_or_else(|| self.unmodelled("read".into(), offset))
    }

    /// A bus write.
    pub fn write(&mut self, offset: u32, value: u32) -> Result<(), Unmodelled> {
        match self.values.get_mut(&offset) {
            Some(register) => {
                *register = value;
                Ok(())
            }
            None => Err(self.unmodelled(format!("write of {value:#x}"), offset)),
        }
    }

    /// The error for this block.
    pub fn unmodelled(&self, access: String, offset: u32) -> Unmodelled {
        Unmodelled {
            block: self.block,
            access,
            offset,
        }
    }
}
