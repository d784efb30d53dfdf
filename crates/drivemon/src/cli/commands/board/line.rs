//! The line that a board hangs on.

use board::{Line, LineParity};
use clap::{Args, ValueEnum};
use live::{ModbusError, ModbusLine};

/// How to reach the board.
#[derive(Debug, Args)]
#[command(next_help_heading = "The line")]
pub struct LineArgs {
    /// Serial port of the RS-485 adapter, e.g. /dev/ttyUSB0 or COM4
    #[arg(long, value_name = "PORT")]
    serial: String,
    /// Speed of the line, bit/s
    #[arg(long, value_name = "BAUD", default_value_t = 19_200, value_parser = clap::value_parser!(u32).range(1_200..=921_600))]
    baud: u32,
    /// Parity of the line; without parity there are two stop bits
    #[arg(long, value_enum, default_value_t = Parity::Even)]
    parity: Parity,
    /// Address of the board
    #[arg(long, value_name = "UNIT", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=247))]
    unit: u8,
}

/// Parity by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Parity {
    /// The protocol's default.
    Even,
    /// Odd.
    Odd,
    /// None, two stop bits.
    None,
}

impl From<Parity> for LineParity {
    fn from(parity: Parity) -> Self {
        match parity {
            Parity::Even => LineParity::Even,
            Parity::Odd => LineParity::Odd,
            Parity::None => LineParity::None,
        }
    }
}

impl LineArgs {
    /// How the line is set.
    pub fn settings(&self) -> Line {
        Line {
            baud: self.baud,
            parity: self.parity.into(),
            unit: self.unit,
        }
    }

    /// Opens the port.
    pub fn open(&self) -> Result<ModbusLine, ModbusError> {
        self.open_at(self.settings())
    }

    /// Opens the port with other settings.
    pub fn open_at(&self, settings: Line) -> Result<ModbusLine, ModbusError> {
        ModbusLine::open(&self.serial, settings)
    }
}
