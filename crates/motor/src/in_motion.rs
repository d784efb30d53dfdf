//! How a motor in good order moved, beside how its file says.

/// How a motor in good order moved while current, speed or supply changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InMotion {
    /// It was seen at rest alone: whether its file lacks an effect that shows in motion is not known.
    #[default]
    Unseen,
    /// As its file says.
    Fits,
    /// Otherwise: its file lacks an effect.
    Differs,
}

impl InMotion {
    /// The words of a motor file.
    pub const CHOICE: [(&'static str, InMotion); 3] = [
        ("unseen", InMotion::Unseen),
        ("fits", InMotion::Fits),
        ("differs", InMotion::Differs),
    ];

    /// Its word.
    pub fn word(self) -> &'static str {
        let mut all = InMotion::CHOICE.into_iter();
        all.find(|(_, one)| *one == self)
            .map_or("", |(word, _)| word)
    }
}
