//! Registers of every motor for a master on Modbus TCP (MODBUS Messaging on TCP/IP, V1.0b). Nothing can be written.

mod config;
mod frame;
mod map;
mod server;

pub use config::ModbusConfig;
pub use frame::{Frame, LARGEST_FRAME, Request, answer, split};
pub use map::{
    BLOCK, Entry, Field, IN_A_UNIT, Kind, LAST_UNIT, Layout, MAP, MAP_VERSION, Plant, WORDS,
    address,
};
pub use server::{ModbusError, ModbusState, ModbusStatus, run};
