//! Registers that only remember what was written, and the error of touching one that does not exist here.

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
    /// By word; looked up several times a conversion.
    values: Vec<Option<u32>>,
}

impl Registers {
    /// `reset` lists offset and reset value of every register that exists.
    pub fn new(block: &'static str, reset: &'static [(u32, u32)]) -> Self {
        Registers {
            block,
            reset,
            values: values_of(reset),
        }
    }

    /// Back to the reset values.
    pub fn reset(&mut self) {
        self.values = values_of(self.reset);
    }

    fn value(&self, offset: u32) -> Option<u32> {
        let value = self.values.get(offset as usize / 4).copied()?;
        value.filter(|_| offset.is_multiple_of(4))
    }

    /// Value of a register that is known to exist.
    pub fn get(&self, offset: u32) -> u32 {
        self.value(offset).unwrap_or(0)
    }

    /// Changes a register from the hardware's side.
    pub fn set(&mut self, offset: u32, value: u32) {
        let place = offset as usize / 4;
        if self.values.len() <= place {
            self.values.resize(place + 1, None);
        }
        self.values[place] = Some(value);
    }

    /// A bus read.
    pub fn read(&self, offset: u32) -> Result<u32, Unmodelled> {
        self.value(offset)
            .ok_or_else(|| self.unmodelled("read".into(), offset))
    }

    /// A bus write.
    pub fn write(&mut self, offset: u32, value: u32) -> Result<(), Unmodelled> {
        match self
            .values
            .get_mut(offset as usize / 4)
            .filter(|_| offset.is_multiple_of(4))
            .and_then(Option::as_mut)
        {
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

fn values_of(reset: &[(u32, u32)]) -> Vec<Option<u32>> {
    let words = reset.iter().map(|(offset, _)| *offset as usize / 4 + 1);
    let mut values = vec![None; words.max().unwrap_or(0)];
    for (offset, value) in reset {
        values[*offset as usize / 4] = Some(*value);
    }
    values
}
