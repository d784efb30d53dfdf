//! Modbus TCP: one connection, one question at a time, as the line behind a converter wants it.

use std::io;
use std::time::Duration;

use tokio::net::TcpStream;
use tokio::time::timeout;

use super::error::BusError;
use crate::wire::mbap::{self, Frame};
use crate::wire::question::Question;

/// A connection.
pub(crate) struct TcpBus {
    address: String,
    within: Duration,
    stream: Option<TcpStream>,
    transaction: u16,
}

impl TcpBus {
    /// Not connected yet.
    pub fn new(address: String, within: Duration) -> Self {
        TcpBus {
            address,
            within,
            stream: None,
            transaction: 0,
        }
    }

    /// Asks a board. Whatever goes wrong but a refusal ends the connection: a late answer must not be taken for that of the
    /// next question.
    pub async fn ask(&mut self, unit: u8, question: &Question) -> Result<Vec<u8>, BusError> {
        let mut stream = match self.stream.take() {
            Some(stream) => stream,
            None => self.connect().await?,
        };
        self.transaction = self.transaction.wrapping_add(1);
        let mut content = vec![question.function];
        content.extend_from_slice(&question.data);
        let asked = Frame {
            transaction: self.transaction,
            unit,
            content,
        };
        let within = self.within;
        let answer = timeout(within, exchange(&mut stream, &asked)).await;
        let answer = answer
            .map_err(|_| BusError::Silent { unit, within })?
            .map_err(|error| self.lost(&error))?;
        let answered = unwrap(&asked, &answer);
        if !matches!(answered, Err(BusError::Damaged(_))) {
            self.stream = Some(stream);
        }
        answered
    }

    async fn connect(&self) -> Result<TcpStream, BusError> {
        let connected = timeout(self.within, TcpStream::connect(&self.address)).await;
        let stream = connected
            .map_err(|_| self.lost(&io::ErrorKind::TimedOut.into()))?
            .map_err(|error| self.lost(&error))?;
        // A question is one small packet.
        let _ = stream.set_nodelay(true);
        Ok(stream)
    }

    fn lost(&self, error: &io::Error) -> BusError {
        let remedy = match error.kind() {
            io::ErrorKind::ConnectionRefused => "; does something listen there?",
            io::ErrorKind::TimedOut => "; is the address right, and no firewall between?",
            io::ErrorKind::InvalidData => "; is there another service at this port?",
            _ => "",
        };
        BusError::Link(format!("{}: {error}{remedy}", self.address))
    }
}

async fn exchange(stream: &mut TcpStream, asked: &Frame) -> io::Result<Frame> {
    mbap::write(stream, asked).await?;
    let answer = mbap::read(stream).await?;
    answer.ok_or_else(|| io::ErrorKind::ConnectionAborted.into())
}

/// The data of an answer to this question.
fn unwrap(asked: &Frame, answer: &Frame) -> Result<Vec<u8>, BusError> {
    let (unit, function) = (asked.unit, asked.content.first().copied().unwrap_or(0));
    let ours = (answer.transaction, answer.unit) == (asked.transaction, unit);
    match &answer.content[..] {
        [done, data @ ..] if ours && *done == function => Ok(data.to_vec()),
        [refused, code] if ours && *refused == function | 0x80 => Err(BusError::Refused {
            unit,
            function,
            code: *code,
        }),
        _ => Err(BusError::Damaged(unit)),
    }
}
