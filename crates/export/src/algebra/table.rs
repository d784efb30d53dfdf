//! Curves as values at equal distances.

/// A curve: straight lines between values at equal distances; beyond its ends it stays.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Its name.
    pub name: String,
    /// What it is.
    pub meaning: String,
    /// Where it begins, in the unit of the quantity that it is drawn over.
    pub first: f64,
    /// Intervals per unit of that quantity.
    pub per_unit: f64,
    /// Values; at least two.
    pub values: Vec<f64>,
}
