//! The table that a technician fills in: one row per test point.

mod check;
mod columns;
mod read;

pub use columns::{COLUMNS, Column};
pub use read::{Line, read, read_csv};

/// A table to fill in, with an example of every test.
pub const TEMPLATE: &str = include_str!("template.csv");

pub(crate) use check::check;

/// One of the standard tests, in the order in which they are done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Test {
    /// Resistance between two terminals with direct current.
    DcResistance,
    /// Running without load at one or several voltages.
    NoLoad,
    /// Rotor held at about rated current, at one or two frequencies.
    LockedRotor,
    /// Running with a load.
    Load,
    /// Running out without a supply.
    CoastDown,
}

impl Test {
    /// All tests, in the order of IEEE 112 and IEC 60034-28.
    pub const ALL: [Test; 5] = [
        Test::DcResistance,
        Test::NoLoad,
        Test::LockedRotor,
        Test::Load,
        Test::CoastDown,
    ];

    /// As the column `test` has it.
    pub const fn name(self) -> &'static str {
        match self {
            Test::DcResistance => "dc-resistance",
            Test::NoLoad => "no-load",
            Test::LockedRotor => "locked-rotor",
            Test::Load => "load",
            Test::CoastDown => "coast-down",
        }
    }
}

/// A row of a table: SI units, watts and rpm as measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Name of the table.
    pub table: String,
    /// Line of the table, from 1.
    pub line: usize,
    /// The test.
    pub test: Test,
    /// What the columns hold, in the order of [`Column`].
    pub values: [Option<f64>; COLUMNS],
}

impl Row {
    /// What a column holds.
    pub fn get(&self, column: Column) -> Option<f64> {
        self.values[column as usize]
    }

    /// The row as messages name it.
    pub fn place(&self) -> String {
        format!("{}:{}", self.table, self.line)
    }
}
