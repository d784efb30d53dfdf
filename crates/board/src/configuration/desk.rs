//! What a master writes: two configurations as registers, the one that holds and the one that is being written, and the tray
//! for the pieces of a program.

use update::Tray;

use super::{CONFIGURATION_REGISTERS, Configuration};

/// Holding register of the first word that a master writes.
pub const STAGED: u16 = 1_000;
/// Holding register of the first word that holds; these are only read.
pub const ACTIVE: u16 = 2_000;

/// What holds, what is being written, and the piece of a program that came last.
#[derive(Clone, Debug)]
pub struct Desk {
    staged: Configuration,
    active: Configuration,
    tray: Tray,
}

impl Desk {
    /// Before the board knows its configuration.
    pub const fn blank() -> Self {
        Desk {
            staged: Configuration::BLANK,
            active: Configuration::BLANK,
            tray: Tray::closed(),
        }
    }

    /// This one holds from now on; what was being written is dropped.
    pub fn show(&mut self, holds: &Configuration) {
        self.staged.clone_from(holds);
        self.active.clone_from(holds);
    }

    /// What a master has written.
    pub fn staged(&self) -> &Configuration {
        &self.staged
    }

    /// What holds.
    pub fn active(&self) -> &Configuration {
        &self.active
    }

    /// Where pieces of a program are laid down.
    pub fn tray(&mut self) -> &mut Tray {
        &mut self.tray
    }

    /// The holding register at `address`; `None` where there is none.
    pub fn register(&self, address: u16) -> Option<u16> {
        match address.checked_sub(ACTIVE) {
            Some(at) => self.active.register(at),
            None => self.staged.register(address.checked_sub(STAGED)?),
        }
    }

    /// Whether all of these registers can be written.
    pub fn is_writable(first: u16, count: u16) -> bool {
        let end = u32::from(first) + u32::from(count);
        first >= STAGED && end <= u32::from(STAGED + CONFIGURATION_REGISTERS)
    }

    /// Writes a register; `false` where it cannot be written.
    pub fn write(&mut self, address: u16, value: u16) -> bool {
        let at = address.checked_sub(STAGED);
        at.is_some_and(|at| self.staged.set_register(at, value))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_blocks_do_not_overlap() {
        const { assert!(STAGED + CONFIGURATION_REGISTERS <= ACTIVE) };
    }

    #[test]
    fn what_is_written_is_read_back_and_changes_nothing_that_holds() {
        let mut desk = Desk::blank();
        let mut holds = Configuration::BLANK;
        *holds.words_mut() = core::array::from_fn(|k| 0x0001_0000 * k as u32 + 7);
        desk.show(&holds);
        for at in 0..CONFIGURATION_REGISTERS {
            assert_eq!(desk.register(STAGED + at), desk.register(ACTIVE + at));
            assert!(desk.write(STAGED + at, at ^ 0x5A5A));
        }
        assert_eq!(desk.active(), &holds);
        for at in 0..CONFIGURATION_REGISTERS {
            assert_eq!(desk.register(STAGED + at), Some(at ^ 0x5A5A));
        }
        assert_eq!(
            desk.staged().words()[1],
            u32::from(2 ^ 0x5A5A_u16) << 16 | (3 ^ 0x5A5A)
        );
    }

    #[test]
    fn only_the_staged_block_can_be_written() {
        let mut desk = Desk::blank();
        let beyond = STAGED + CONFIGURATION_REGISTERS;
        for address in [0, STAGED - 1, beyond, ACTIVE, u16::MAX] {
            assert!(!desk.write(address, 1), "{address}");
        }
        assert_eq!(desk.register(beyond), None);
        assert_eq!(desk.register(ACTIVE + CONFIGURATION_REGISTERS), None);
        assert!(Desk::is_writable(STAGED, CONFIGURATION_REGISTERS));
        assert!(!Desk::is_writable(STAGED, CONFIGURATION_REGISTERS + 1));
        assert!(!Desk::is_writable(STAGED - 1, 2) && !Desk::is_writable(u16::MAX, u16::MAX));
    }
}
