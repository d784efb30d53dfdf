//! The numbers of one column: owned, or lent by the program that measured them.

use std::fmt;
use std::ops::{Deref, Range};
use std::sync::Arc;

/// Numbers that somebody else keeps in memory, and does not change.
pub type Lent = Arc<dyn AsRef<[f64]> + Send + Sync>;

/// The numbers of one column.
///
/// A column read from a file owns its numbers. One that comes from a table of another library (Arrow, numpy) may be lent:
/// the numbers stay where they are, and their owner lives as long as the column.
#[derive(Clone)]
pub enum Column {
    /// Numbers of its own.
    Own(Vec<f64>),
    /// Numbers that somebody else keeps.
    Lent(Lent),
}

impl Column {
    /// Whether the numbers are somebody else's.
    pub fn is_lent(&self) -> bool {
        matches!(self, Column::Lent(_))
    }

    /// The same numbers, lent: clones share them.
    pub fn lent(self) -> Column {
        match self {
            Column::Own(values) => Column::Lent(Arc::new(values)),
            lent @ Column::Lent(_) => lent,
        }
    }

    /// The memory of numbers of its own.
    pub(crate) fn into_buffer(self) -> Option<Vec<f64>> {
        match self {
            Column::Own(values) => Some(values),
            Column::Lent(_) => None,
        }
    }

    /// Keeps the numbers of a range that lies inside; lent ones, and few of many, are copied.
    pub(crate) fn cut(&mut self, range: &Range<usize>) {
        match self {
            Column::Own(values) if 2 * range.len() < values.len() => {
                *values = values[range.clone()].to_vec();
            }
            Column::Own(values) => {
                values.truncate(range.end);
                values.drain(..range.start);
            }
            Column::Lent(lent) => {
                *self = Column::Own((**lent).as_ref()[range.clone()].to_vec());
            }
        }
    }

    /// The numbers to change; lent ones are copied first.
    pub fn to_mut(&mut self) -> &mut [f64] {
        if let Column::Lent(lent) = self {
            *self = Column::Own((**lent).as_ref().to_vec());
        }
        match self {
            Column::Own(values) => values,
            // Replaced above.
            Column::Lent(_) => &mut [],
        }
    }
}

impl Deref for Column {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        match self {
            Column::Own(values) => values,
            Column::Lent(lent) => (**lent).as_ref(),
        }
    }
}

impl From<Vec<f64>> for Column {
    fn from(values: Vec<f64>) -> Column {
        Column::Own(values)
    }
}

impl PartialEq for Column {
    fn eq(&self, other: &Column) -> bool {
        **self == **other
    }
}

impl fmt::Debug for Column {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lent_numbers_are_not_copied_until_they_change() {
        let kept: Lent = Arc::new(vec![1.0, 2.0]);
        let mut column = Column::Lent(Arc::clone(&kept));
        assert_eq!(column.as_ptr(), (*kept).as_ref().as_ptr());
        assert_eq!(column.clone().as_ptr(), column.as_ptr());
        column.to_mut()[0] = 3.0;
        assert!(!column.is_lent());
        assert_eq!(
            (&column[..], (*kept).as_ref()),
            (&[3.0, 2.0][..], &[1.0, 2.0][..])
        );
    }

    #[test]
    fn columns_are_equal_by_their_numbers() {
        let kept: Lent = Arc::new(vec![1.0]);
        assert_eq!(Column::Lent(kept), Column::from(vec![1.0]));
    }
}
