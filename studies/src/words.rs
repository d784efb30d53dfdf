//! What a study is asked: two numbers, then words.

/// The arguments of the program.
pub struct Words(Vec<String>);

impl Words {
    /// Those that were given.
    pub fn given() -> Self {
        Words(std::env::args().skip(1).collect())
    }

    /// The number at a place, or `default` where there is none.
    pub fn number(&self, place: usize, default: u64) -> u64 {
        let word = self.0.get(place).and_then(|word| word.parse().ok());
        word.unwrap_or(default)
    }

    /// Whether a word is among them.
    pub fn has(&self, word: &str) -> bool {
        self.0.iter().any(|given| given == word)
    }
}
