//! The debugger's memory channels: what the firmware wrote to them.

use crate::processor::cpu::{Cpu, RAM, RAM_SIZE};

const ID: &[u8; 10] = b"SEGGER RTT";
/// Bytes before the first channel description, and bytes of each.
const HEADER: u32 = 24;
const DESCRIPTION: u32 = 24;

/// Takes what channel `index` holds, as a debugger does: it moves the read pointer.
pub(crate) fn drain(cpu: &mut Cpu, index: u32) -> Option<Vec<u8>> {
    let ram = cpu
        .core
        .mem_read_as_vec(u64::from(RAM), RAM_SIZE as usize)
        .ok()?;
    let block = RAM + ram.windows(ID.len()).position(|bytes| bytes == ID)? as u32;
    let channels = cpu.word(block + 16).ok()?;
    if index >= channels {
        return None;
    }
    let channel = block + HEADER + DESCRIPTION * index;
    let [buffer, size, write, read] =
        [4, 8, 12, 16].map(|offset| cpu.word(channel + offset).unwrap_or(0));
    if size == 0 || write >= size || read >= size {
        return None;
    }
    let length = (write + size - read) % size;
    let byte = |k: u32| {
        ram.get((buffer - RAM + (read + k) % size) as usize)
            .copied()
    };
    let taken: Option<Vec<u8>> = (0..length).map(byte).collect();
    let moved = cpu
        .core
        .mem_write(u64::from(channel + 16), &write.to_le_bytes());
    moved.ok().and(taken)
}
