//! Mutations without an engine: for the short run, the same on every machine.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Changes bytes at random, the same way for the same seed.
pub struct Mutator {
    random: Pcg64Mcg,
    pool: Vec<Vec<u8>>,
}

/// What makes parsers stumble.
const WORDS: [&[u8]; 18] = [
    b"nan",
    b"inf",
    b"-1",
    b"0",
    b"1e999",
    b"-1e308",
    b"1e-320",
    b"18446744073709551616",
    b"\n",
    b",",
    b"\"",
    b"[[",
    b"=",
    b"\xFF\xFF\xFF\xFF",
    b"\x00\x00\x00\x00",
    b"\x00\x00\x00\x80",
    b"\xFF\xFF\xFF\x7F",
    b"\xC3",
];
/// Changes of one input.
const MOST_CHANGES: usize = 4;

impl Mutator {
    /// A mutator of these inputs.
    pub fn new(seed: u64, pool: Vec<Vec<u8>>) -> Mutator {
        Mutator {
            random: Pcg64Mcg::seed_from_u64(seed),
            pool,
        }
    }

    /// The next input.
    pub fn next_input(&mut self) -> Vec<u8> {
        let mut bytes = self.pick();
        for _ in 0..self.random.random_range(1..=MOST_CHANGES) {
            self.change(&mut bytes);
        }
        bytes
    }

    fn pick(&mut self) -> Vec<u8> {
        match self.pool.len() {
            0 => Vec::new(),
            n => self.pool[self.random.random_range(0..n)].clone(),
        }
    }

    fn change(&mut self, bytes: &mut Vec<u8>) {
        let at = self.random.random_range(0..=bytes.len());
        let length = self.random.random_range(0..=16.min(bytes.len() - at));
        match self.random.random_range(0..7) {
            0 => drop(bytes.drain(at..at + length)),
            1 => bytes.truncate(at),
            2 => {
                let again = bytes[at..at + length].to_vec();
                bytes.splice(at..at, again);
            }
            3 => {
                let word = WORDS[self.random.random_range(0..WORDS.len())];
                bytes.splice(at..at + length, word.iter().copied());
            }
            4 => {
                let other = self.pick();
                let from = self.random.random_range(0..=other.len());
                bytes.truncate(at);
                bytes.extend_from_slice(&other[from..]);
            }
            _ => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << self.random.random_range(0..8);
                }
            }
        }
    }
}
