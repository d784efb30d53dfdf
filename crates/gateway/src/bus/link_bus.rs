//! A way on which boards are asked, whatever carries it.

use super::error::BusError;
use super::rtu::RtuBus;
use super::tcp::TcpBus;
use crate::config::{LinkConfig, LinkKind};
use crate::wire::question::Question;

/// A link that is asked.
pub(crate) enum Bus {
    /// Over a network.
    Tcp(TcpBus),
    /// On a serial line.
    Rtu(RtuBus),
}

impl Bus {
    /// Not connected yet; `None` of a link that tells on its own.
    pub fn new(link: &LinkConfig) -> Option<Self> {
        match &link.kind {
            LinkKind::ModbusTcp { address } => {
                Some(Bus::Tcp(TcpBus::new(address.clone(), link.timeout)))
            }
            LinkKind::ModbusRtu { port, baud, parity } => {
                Some(Bus::Rtu(RtuBus::new(port, *baud, *parity, link.timeout)))
            }
            LinkKind::FramesSerial { .. } | LinkKind::FramesTcp { .. } => None,
        }
    }

    /// Asks; connects where that is needed.
    pub async fn ask(&mut self, unit: u8, question: &Question) -> Result<Vec<u8>, BusError> {
        let answer = match self {
            Bus::Tcp(bus) => bus.ask(unit, question).await?,
            Bus::Rtu(bus) => bus.ask(unit, question).await?,
        };
        match answer.len() == question.answer_bytes {
            true => Ok(answer),
            false => Err(BusError::Damaged(unit)),
        }
    }
}
