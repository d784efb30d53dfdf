//! What a question is asked about.

use crate::data::stretches::Excerpt;
use recording::Source;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What was read: all of it, or stretches of a recording that does not fit into memory.
#[derive(Clone, Debug)]
pub enum Given {
    /// All of it.
    Source(Source),
    /// Stretches.
    Excerpt(Excerpt),
}

/// One of several that a question is asked about.
#[derive(Clone, Copy, Debug)]
pub enum One<'a> {
    /// All of it.
    Source(&'a Source),
    /// Stretches of a long recording.
    Excerpt(&'a Excerpt),
}

/// All that a question is asked about.
#[derive(Clone, Copy, Debug)]
pub enum Sources<'a> {
    /// In memory as a whole.
    Whole(&'a [Source]),
    /// As read.
    Given(&'a [Given]),
    /// In an order of their own.
    Listed(&'a [One<'a>]),
}

/// Which recordings are fitted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Fitted {
    /// The first one, of more the first, third, ...; the others prove.
    #[default]
    AsGiven,
    /// The first of three or more, and all others prove: fitted together they leave something.
    First,
    /// The second of two, and the first one proves: in the given order something is left over.
    Second,
    /// All together, by folds: alone they show too little of the parameters to explain each other.
    All,
}

impl Fitted {
    /// What is fitted of so many recordings where as they are given something is left.
    pub fn another_of(recordings: usize) -> Self {
        match recordings {
            2 => Fitted::Second,
            _ => Fitted::First,
        }
    }

    /// Whether the recordings are used in the order in which they were given.
    pub fn is_as_given(&self) -> bool {
        *self == Fitted::AsGiven
    }

    /// Which proof (from 1) a recording is, counted from 0 in the order in which they were asked about; `None` if it is fitted.
    pub fn proof_of(self, recording: usize) -> Option<usize> {
        match self {
            Fitted::All => None,
            Fitted::First => (recording > 0).then_some(recording),
            Fitted::AsGiven | Fitted::Second => {
                (recording % 2 == 1).then_some(recording.div_ceil(2))
            }
        }
    }

    /// In words, where it is not as given.
    pub fn told(self) -> &'static str {
        match self {
            Fitted::AsGiven => "",
            Fitted::First => {
                " The recording named first is fitted alone, and the others prove: fitted together they leave something."
            }
            Fitted::Second => {
                " The recording named second is fitted, and the first one proves: in the given order something is left over."
            }
            Fitted::All => {
                " All recordings are fitted together: alone they show too little of the parameters to explain each other."
            }
        }
    }
}

impl<'a> Sources<'a> {
    /// One after the other.
    pub fn iter(self) -> impl DoubleEndedIterator<Item = One<'a>> + ExactSizeIterator + Clone {
        let number = match self {
            Sources::Whole(all) => all.len(),
            Sources::Given(all) => all.len(),
            Sources::Listed(all) => all.len(),
        };
        (0..number).map(move |k| match self {
            Sources::Whole(all) => One::Source(&all[k]),
            Sources::Given(all) => One::from(&all[k]),
            Sources::Listed(all) => all[k],
        })
    }

    /// The first alone.
    #[must_use]
    pub fn first(self) -> Self {
        match self {
            Sources::Whole(all) => Sources::Whole(&all[..all.len().min(1)]),
            Sources::Given(all) => Sources::Given(&all[..all.len().min(1)]),
            Sources::Listed(all) => Sources::Listed(&all[..all.len().min(1)]),
        }
    }
}

impl<'a, T: AsRef<[Source]> + ?Sized> From<&'a T> for Sources<'a> {
    fn from(all: &'a T) -> Self {
        Sources::Whole(all.as_ref())
    }
}

impl<'a> From<&'a Source> for One<'a> {
    fn from(source: &'a Source) -> Self {
        One::Source(source)
    }
}

impl<'a> From<&'a Given> for One<'a> {
    fn from(given: &'a Given) -> Self {
        match given {
            Given::Source(source) => One::Source(source),
            Given::Excerpt(excerpt) => One::Excerpt(excerpt),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_second_recording_proves_unless_the_first_alone_is_fitted() {
        let proofs = |fitted: Fitted| [0, 1, 2, 3].map(|k| fitted.proof_of(k));
        let every_second = [None, Some(1), None, Some(2)];
        assert_eq!(proofs(Fitted::AsGiven), every_second);
        assert_eq!(proofs(Fitted::Second), every_second);
        assert_eq!(proofs(Fitted::First), [None, Some(1), Some(2), Some(3)]);
        assert_eq!(proofs(Fitted::All), [None; 4]);
    }
}
