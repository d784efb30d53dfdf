//! What has to be known of a block of Thumb code before it runs.

const SEV: u16 = 0xBF40;

/// A stretch of code that the emulator executes in one go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Block {
    pub instructions: u32,
    /// Whether SEV is among them.
    pub sends: bool,
    /// Instructions after its end that its last IT still makes conditional.
    conditional_after: u32,
}

impl Block {
    pub fn of(code: &[u8]) -> Self {
        let (halves, _) = code.as_chunks::<2>();
        let mut halves = halves.iter().map(|half| u16::from_le_bytes(*half));
        let mut block = Block {
            instructions: 0,
            sends: false,
            conditional_after: 0,
        };
        while let Some(half) = halves.next() {
            block.instructions += 1;
            block.sends |= half == SEV;
            block.conditional_after = match made_conditional(half) {
                0 => block.conditional_after.saturating_sub(1),
                number => number,
            };
            if half >= 0xE800 {
                halves.next();
            }
        }
        block
    }
}

/// Instructions that this one makes conditional if it is IT (ARMv7-M Architecture Reference Manual, A7.7.38), else none.
fn made_conditional(half: u16) -> u32 {
    let mask = half & 0xF;
    if half & 0xFF00 == 0xBF00 && mask != 0 {
        4 - mask.trailing_zeros()
    } else {
        0
    }
}

/// Conditions of an IT that reach over the end of a block, as they do where it ends at the end of a page.
///
/// The emulator forgets them when it is stopped there, and what should have been left out would be executed.
#[derive(Default)]
pub(crate) struct Conditions {
    left: u32,
    next: u64,
}

impl Conditions {
    /// Whether the block at this address begins with conditional instructions.
    pub fn reach_into(&self, address: u64) -> bool {
        self.left > 0 && self.next == address
    }

    /// The block runs; `next` is the address behind it.
    pub fn pass(&mut self, block: &Block, next: u64) {
        let before = self.left.saturating_sub(block.instructions);
        self.left = before.max(block.conditional_after);
        self.next = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(halves: &[u16]) -> Block {
        let code: Vec<u8> = halves.iter().flat_map(|half| half.to_le_bytes()).collect();
        Block::of(&code)
    }

    const ADDS: u16 = 0x1C40;
    const IT_EQ: u16 = 0xBF08;
    const ITTT_EQ: u16 = 0xBF02;
    const ITTTT_EQ: u16 = 0xBF01;
    const VMOV: [u16; 2] = [0xEEF0, 0x0A40];

    #[test]
    fn wide_instructions_count_once() {
        let block = of(&[ADDS, VMOV[0], VMOV[1], SEV]);
        assert_eq!(block.instructions, 3);
        assert!(block.sends && !of(&[ADDS]).sends);
        // The second half of a wide instruction is no instruction.
        assert!(!of(&[VMOV[0], SEV]).sends);
    }

    #[test]
    fn conditions_reach_as_far_as_it_says() {
        assert_eq!(of(&[IT_EQ]).conditional_after, 1);
        assert_eq!(of(&[IT_EQ, ADDS]).conditional_after, 0);
        assert_eq!(of(&[ITTTT_EQ, ADDS]).conditional_after, 3);
        assert_eq!(of(&[ITTT_EQ, VMOV[0], VMOV[1], ADDS]).conditional_after, 1);
        assert_eq!(of(&[ADDS, SEV]).conditional_after, 0);
    }

    #[test]
    fn a_block_within_conditions_is_told_until_they_end() {
        let mut conditions = Conditions::default();
        conditions.pass(&of(&[ITTTT_EQ, ADDS]), 0x1000);
        assert!(conditions.reach_into(0x1000));
        assert!(!conditions.reach_into(0x2000), "somewhere else");
        conditions.pass(&of(&[ADDS, ADDS]), 0x1004);
        assert!(conditions.reach_into(0x1004));
        conditions.pass(&of(&[ADDS, ADDS]), 0x1008);
        assert!(!conditions.reach_into(0x1008));
    }
}
