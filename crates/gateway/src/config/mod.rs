//! The configuration of a gateway: which motors there are, on which links, and where everything is kept.

mod advice;
mod alarms;
mod links;
mod motors;
mod read;
#[cfg(test)]
mod tests;

pub use advice::{Advice, advice};

use std::path::PathBuf;
use std::time::Duration;

use board::LineParity;
use fleet::alarm::Rules;
use fleet::{Limits, MotorInfo};

/// A gateway.
#[derive(Clone, Debug)]
pub struct Config {
    /// When a motor counts as lost, and how long one that does not answer is left alone.
    pub patience: Patience,
    /// File of the store.
    pub store: PathBuf,
    /// How much is kept, and for how long.
    pub limits: Limits,
    /// Delays, latch and flood limit of alarms.
    pub alarms: Rules,
    /// Ways to boards.
    pub links: Vec<LinkConfig>,
    /// Motors, in the order of the file.
    pub motors: Vec<MotorConfig>,
}

/// How the gateway deals with silence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patience {
    /// A motor that has not answered for so long is lost, and that is stored.
    pub lost_after: Duration,
    /// A motor that does not answer is asked again after 1, 2, 4 ... s, and after this time at the latest.
    pub retry_most: Duration,
}

/// A way to one or more boards.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LinkConfig {
    /// Its name in this file.
    pub name: String,
    /// Line of the file, from 1.
    pub line: usize,
    /// What it is.
    pub kind: LinkKind,
    /// Between two visits of a board.
    pub poll: Duration,
    /// How long an answer may take.
    pub timeout: Duration,
}

/// Kinds of links.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LinkKind {
    /// Modbus TCP, to a board's converter or to a gateway with a line of boards behind it.
    ModbusTcp {
        /// Host and port.
        address: String,
    },
    /// A serial line with one or more boards.
    ModbusRtu {
        /// Name of the port.
        port: String,
        /// Bit/s.
        baud: u32,
        /// Parity.
        parity: LineParity,
    },
    /// The board's own frames, from a serial port.
    FramesSerial {
        /// Name of the port.
        port: String,
        /// Bit/s.
        baud: u32,
    },
    /// The board's own frames, from a serial port that somebody serves over TCP.
    FramesTcp {
        /// Host and port.
        address: String,
    },
}

/// A motor and the board that watches it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MotorConfig {
    /// What people wrote about it.
    pub info: MotorInfo,
    /// Its link, as place in [`Config::links`].
    pub link: usize,
    /// Address of its board, 1 to 247; 0 on a link for frames.
    pub unit: u8,
    /// The board's serial number, 24 hexadecimal digits; `None`: any board.
    pub serial: Option<String>,
    /// Which event log of that board it is, from 1: a log that was erased is a new one.
    pub log: u32,
}

impl Config {
    /// The motors of a link.
    pub fn motors_of(&self, link: usize) -> impl Iterator<Item = &MotorConfig> {
        self.motors.iter().filter(move |motor| motor.link == link)
    }
}

impl LinkKind {
    /// Whether boards are asked, instead of telling on their own.
    pub fn is_asked(&self) -> bool {
        matches!(
            self,
            LinkKind::ModbusTcp { .. } | LinkKind::ModbusRtu { .. }
        )
    }

    /// The host and port, or the name of the serial port.
    pub fn place(&self) -> &str {
        match self {
            LinkKind::ModbusTcp { address } | LinkKind::FramesTcp { address } => address,
            LinkKind::ModbusRtu { port, .. } | LinkKind::FramesSerial { port, .. } => port,
        }
    }
}

impl std::fmt::Display for LinkKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            LinkKind::ModbusTcp { address } => write!(f, "modbus-tcp {address}"),
            LinkKind::ModbusRtu { port, baud, parity } => {
                let parity = match parity {
                    LineParity::None => "no",
                    LineParity::Odd => "odd",
                    LineParity::Even => "even",
                };
                write!(f, "modbus-rtu {port} {baud} bit/s, {parity} parity")
            }
            LinkKind::FramesSerial { port, baud } => write!(f, "frames-serial {port} {baud} bit/s"),
            LinkKind::FramesTcp { address } => write!(f, "frames-tcp {address}"),
        }
    }
}
